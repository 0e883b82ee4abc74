//! Projection ends at rims: beyond them points get the status *boundary*, no skirt grows, and the rim is where it should be.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{add, dot, in_cube, largest, length, rows_of_text, scale, shared, sub};
use footpoint::samples::{self, Random};
use footpoint::{
    Acceptance, Cloud, Definition, NormalField, Project, Projections, Status, Support, Surface, Want, Weight,
};

const H: f64 = 0.2;

/// A surface with a rim and how far beyond it a point lies; negative inside.
struct Rimmed {
    name: &'static str,
    points: Vec<[f64; 3]>,
    beyond: fn([f64; 3]) -> f64,
    /// Above the surface.
    height: fn([f64; 3]) -> f64,
}

fn cases() -> Vec<Rimmed> {
    let plane = samples::plane(1.0, 4000, 5).points;
    let disc = plane.iter().copied().filter(|p| p[0].hypot(p[1]) < 0.9).collect();
    let straight = plane.iter().copied().filter(|p| p[0] < 0.0).collect();
    let sphere = samples::sphere(1.0, 12_000, 6).points;
    vec![
        Rimmed { name: "disc", points: disc, beyond: |p| p[0].hypot(p[1]) - 0.9, height: |p| p[2] },
        Rimmed {
            name: "straight rim",
            points: straight, // The plane ends on the other sides too.
            beyond: |p| p[0].max(-1.0 - p[0]).max(p[1].abs() - 1.0),
            height: |p| p[2],
        },
        Rimmed {
            name: "half sphere",
            points: sphere.into_iter().filter(|p| p[2] > 0.0).collect(),
            beyond: |p| -p[2].atan2(p[0].hypot(p[1])),
            height: |p| length(p) - 1.0,
        },
    ]
}

/// Starts around the samples, pushed over the rim where that is near.
fn starts(points: &[[f64; 3]], count: usize) -> Vec<[f64; 3]> {
    let mut random = Random::new(7);
    (0..count)
        .map(|_| {
            let p = points[(random.uniform() * points.len() as f64) as usize];
            add(p, scale(in_cube(&mut random), H))
        })
        .collect()
}

fn accepted(found: &Projections<3>) -> impl Iterator<Item = [f64; 3]> + Clone + '_ {
    let pairs = found.point.iter().zip(&found.status);
    pairs.filter(|(_, status)| status.is_ok()).map(|(point, _)| *point)
}

#[test]
fn no_skirt_grows_and_the_rim_is_within_half_a_support() {
    for case in cases() {
        for (weight, field) in [
            (Weight::Poly2, NormalField::CentredCovariance),
            (Weight::Poly3, NormalField::CentredCovariance),
            (Weight::Poly4, NormalField::CentredCovariance),
            (Weight::Poly3, NormalField::Covariance),
        ] {
            let definition =
                Definition::new().with_weight(weight).with_field(field).with_support(Support::Uniform(H));
            let surface = Surface::new(Cloud::new(case.points.clone()), definition).unwrap();
            let starts = starts(&case.points, 20_000);
            let found = surface.project(&starts, &Project::new());
            let rim = largest(accepted(&found).map(case.beyond)) / H;
            // Every start near the surface and well inside has its foot.
            let inside = |x: [f64; 3]| (case.beyond)(x) < -0.5 * H && (case.height)(x).abs() < 0.2 * H;
            let lost = (0..starts.len()).filter(|&i| inside(starts[i]) && !found.status[i].is_ok()).count();
            let boundary = found.status.iter().filter(|&&s| s == Status::Boundary).count();
            let open = Surface::new(
                Cloud::new(case.points.clone()),
                definition.with_acceptance(Acceptance::EVERY_ZERO),
            )
            .unwrap();
            let skirt = largest(accepted(&open.project(&starts, &Project::new())).map(case.beyond)) / H;
            println!(
                "{} {weight:?} {field:?}: rim {rim:.2} h beyond, {skirt:.2} h without the rule; {boundary} boundary, {lost} lost",
                case.name
            );
            assert!((0.0..0.45).contains(&rim), "{}: {rim}", case.name);
            assert!(skirt > rim + 0.1, "the rule changes nothing: {skirt}");
            // Frames about x have turned sideways where many starts are: these end as *singular*.
            let least = if field == NormalField::Covariance { 1 } else { 50 };
            assert!(boundary >= least && lost == 0, "{}: {boundary} {lost}", case.name);
        }
    }
}

#[test]
fn the_eccentricity_tells_how_near_a_rim_is() {
    let case = &cases()[1];
    let definition = Definition::new().with_support(Support::Uniform(H));
    let surface = Surface::new(Cloud::new(case.points.clone()), definition).unwrap();
    let along = |x: f64| -> f64 {
        let at: Vec<[f64; 3]> = (0..40).map(|i| [x, 0.03 * f64::from(i) - 0.6, 0.0]).collect();
        surface.evaluate(&at, Want::ECCENTRICITY).eccentricity.iter().sum::<f64>() / 40.0
    };
    let found = [-0.5, -0.15, 0.0, 0.04, 0.08].map(along);
    println!("eccentricity inside, near, at and beyond a straight rim: {found:.3?}");
    assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
    // SPEC § 8: 0.26 h at a straight rim for Poly3.
    assert!(found[0] < 0.06 && (found[2] - 0.26).abs() < 0.02);
}

#[test]
fn a_strip_with_one_side_has_a_rim_like_any_other() {
    let strip = samples::moebius(1.0, 0.35, 20_000, 8);
    let definition = Definition::new().with_support(Support::Uniform(H));
    let surface = Surface::new(Cloud::new(strip.points.clone()), definition).unwrap();
    let starts = starts(&strip.points, 20_000);
    let found = surface.project(&starts, &Project::new());
    // Across the strip at the angle of a point.
    let beyond = |p: [f64; 3]| {
        let u = p[1].atan2(p[0]);
        let middle = [u.cos(), u.sin(), 0.0];
        let across = [(u / 2.0).cos() * u.cos(), (u / 2.0).cos() * u.sin(), (u / 2.0).sin()];
        dot(sub(p, middle), across).abs() - 0.35
    };
    let rim = largest(accepted(&found).map(beyond)) / H;
    let boundary = found.status.iter().filter(|&&s| s == Status::Boundary).count();
    println!("Möbius strip: rim {rim:.2} h beyond, {boundary} boundary");
    assert!(rim < 0.45 && boundary > 100);
}

#[test]
fn a_real_scan_keeps_its_rims() {
    let Some(file) = shared("data").map(|folder| folder.join("range/bun000.ply")) else { return };
    let points: Vec<[f64; 3]> = rows_of_text(&std::fs::read_to_string(file).unwrap(), 40_256)
        .iter()
        .map(|row| std::array::from_fn(|k| row[k]))
        .collect();
    let surface = Surface::new(Cloud::new(points.clone()), Definition::new()).unwrap();
    let h = surface.support().median;
    let mut random = Random::new(9);
    let starts: Vec<[f64; 3]> =
        points.iter().step_by(2).map(|&p| add(p, scale(in_cube(&mut random), h))).collect();
    let found = surface.project(&starts, &Project::new());
    // No accepted point stands where no sample is near: a skirt would.
    let feet: Vec<[f64; 3]> = accepted(&found).collect();
    let nearest =
        Surface::new(Cloud::new(points), Definition::new().with_support(Support::Uniform(0.6 * h))).unwrap();
    let alone = nearest.evaluate(&feet, Want::NEIGHBOURS).neighbours.iter().filter(|&&n| n == 0).count();
    let boundary = found.status.iter().filter(|&&s| s == Status::Boundary).count();
    println!(
        "bun000: {} of {} ok, {boundary} boundary, {alone} without a sample within 0.6 h",
        feet.len(),
        starts.len()
    );
    assert_eq!(alone, 0);
    assert!(boundary > 0);
}
