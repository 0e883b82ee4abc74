//! The study of degrees: errors of each, and the degree that the library chooses.

use super::shapes::Shape;
use super::{Plan, degrees as angle, rounded};
use footpoint::{Cloud, Definition, DegreeAim, Error, Project, Projections, Queries, Support, Surface};
use serde::Serialize;

/// Standard deviations in spacings: more small ones, because there the degrees change places.
const NOISES: [f64; 5] = [0.0, 0.05, 0.2, 0.5, 1.0];

/// About a(x) degree 1 is degree 0.
const DEGREES: [u8; 3] = [0, 2, 3];

/// Degrees 0, 2 and 3 on one cloud, about a(x).
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) shape: &'static str,
    noise_in_spacings: f64,
    effective_neighbours: f64,
    /// κ_H h, root mean square: what the bias grows with.
    curvature_times_support: f64,
    ok_share: [f64; 3],
    /// Root mean square distance to the true surface.
    position_in_spacings: [f64; 3],
    /// Mean angle of ∇f to the true normal.
    surface_normal_degrees: [f64; 3],
    /// The degrees chosen for positions and for normals, and how much worse their errors are than the best.
    pub(super) chosen: [u8; 2],
    pub(super) against_best: [f64; 2],
    /// The least position error in supports: below the projection's tolerance there is nothing to choose.
    pub(super) best_in_supports: f64,
}

pub(super) fn rows<const D: usize>(
    shape: &Shape<D>,
    count: usize,
    plan: Plan,
    rows: &mut Vec<Row>,
) -> Result<(), Error> {
    let spacing = shape.spacing(count);
    for noise in NOISES {
        eprintln!("{}, noise {noise}, degrees", shape.name);
        let cloud = Cloud::new(shape.samples(count, noise).points);
        for &effective_neighbours in plan.effective_neighbours {
            let definition = Definition::new().with_support(Support::Auto { effective_neighbours });
            let mut surface = Surface::new(cloud.clone(), definition)?;
            let mut found = [[0.0; 4]; 3];
            for (degree, found) in DEGREES.into_iter().zip(&mut found) {
                surface = surface.with_degree(degree)?;
                *found = errors(shape, &surface.project(Queries::Samples, &Project::new()));
            }
            let column = |k: usize| found.map(|errors| errors[k]);
            let (ok, position, normal) = (column(0), column(1), column(2));
            // Those that find the surface: the best among few points is not the best.
            let most = ok.iter().fold(0.0_f64, |most, &share| most.max(share));
            let best = |errors: [f64; 3]| {
                (0..3).filter(|&m| ok[m] >= most - 0.01).map(|m| errors[m]).fold(f64::INFINITY, f64::min)
            };
            let chosen =
                [DegreeAim::Position, DegreeAim::Normal].map(|aim| surface.choose_degree(aim).degree);
            let own = |errors: [f64; 3], degree: u8| {
                DEGREES.into_iter().zip(errors).find(|e| e.0 == degree).map_or(f64::NAN, |e| e.1)
            };
            let worse = |errors, degree| rounded(own(errors, degree) / best(errors).max(f64::MIN_POSITIVE));
            rows.push(Row {
                shape: shape.name,
                noise_in_spacings: noise,
                effective_neighbours,
                curvature_times_support: rounded(column(3)[0] * surface.support().median),
                ok_share: ok.map(rounded),
                position_in_spacings: position.map(|e| rounded(e / spacing)),
                surface_normal_degrees: normal.map(rounded),
                chosen,
                against_best: [worse(position, chosen[0]), worse(normal, chosen[1])],
                best_in_supports: rounded(best(position) / surface.support().median),
            });
        }
    }
    Ok(())
}

/// Share of *ok*, root mean square distance, mean angle; root mean square curvature of the true surface.
fn errors<const D: usize>(shape: &Shape<D>, p: &Projections<D>) -> [f64; 4] {
    let ok: Vec<usize> = (0..p.status.len()).filter(|&i| p.status[i].is_ok()).collect();
    let mean = |of: &dyn Fn(usize) -> f64| ok.iter().map(|&i| of(i)).sum::<f64>() / ok.len() as f64;
    let truth = |i: usize| (shape.truth)(p.point[i]);
    let off = |i: usize| (0..D).map(|k| (p.point[i][k] - truth(i).foot[k]).powi(2)).sum::<f64>();
    let turned = |i: usize| angle(p.surface_normal[i], truth(i).normal);
    let bent = |i: usize| truth(i).curvature.powi(2);
    [ok.len() as f64 / p.status.len() as f64, mean(&off).sqrt(), mean(&turned), mean(&bent).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{CURVES, SURFACES};
    use super::*;

    #[test]
    fn the_chosen_degree_is_at_most_a_quarter_worse_than_the_best() {
        let plan = Plan { samples: 3000, effective_neighbours: &[16.0, 64.0] };
        let mut found = Vec::new();
        rows(&SURFACES[1], 3000, plan, &mut found).unwrap();
        rows(&CURVES[0], 1500, plan, &mut found).unwrap();
        assert_eq!(found.len(), 20);
        for row in &found {
            let exact = row.best_in_supports < 2e-6;
            assert!(exact || row.against_best.iter().all(|&ratio| ratio <= 1.25), "{row:?}");
        }
        let chosen = |degree| found.iter().filter(|row| row.chosen[0] == degree).count();
        assert!(chosen(0) >= 3 && chosen(2) + chosen(3) >= 8, "{found:?}");
    }
}
