//! A cloud moved by whole cells keeps every bit of its answers; one scaled by a power of two scales them exactly.

use crate::common::{
    self, Columns, OPERATORS, Row, VARIANTS, Variant, WEIGHTS, add, definitions, evaluation_rows,
    near_samples, projection_rows, same_rows, without_locations,
};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, Project, Surface, Want, Weight};

/// Coordinates are multiples of this, so that moved ones are exact.
const GRAIN: f64 = 1.0 / (1 << 20) as f64;

fn grained<const D: usize>(mut shape: Samples<D>) -> Samples<D> {
    for p in &mut shape.points {
        *p = p.map(|c| (c / GRAIN).round() * GRAIN);
    }
    shape
}

fn answers<const D: usize>(surface: &Surface<D>, queries: &[[f64; D]]) -> Vec<Row> {
    let mut rows = evaluation_rows(&surface.evaluate(queries, Want::ALL));
    for operator in OPERATORS {
        let how = Project::new().with_operator(operator).with_tolerance(1e-12);
        let projected = projection_rows(&surface.project(queries, &how));
        rows.iter_mut().zip(projected).for_each(|(row, more)| row.extend(more));
    }
    rows
}

/// Queries among exact multiples of the grain.
fn queries<const D: usize>(columns: &Columns<D>) -> Vec<[f64; D]> {
    let mut queries = near_samples(&columns.points, 200, 0.5 * columns.radius, 3);
    queries.extend(&columns.points[..50]);
    queries.into_iter().map(|q| q.map(|c| (c / GRAIN).round() * GRAIN)).collect()
}

fn moved<const D: usize>(columns: &Columns<D>, definition: Definition, label: &str) {
    let queries = queries(columns);
    let surface = columns.surface(definition);
    let side = surface.cell_side();
    let expected = without_locations(answers(&surface, &queries));
    assert!(expected.iter().filter(|row| row[0].1 == 0).count() * 2 > expected.len(), "{label}");
    for cells in [[1.0, 0.0, 0.0], [-3.0, 2.0, 7.0], [1e5, -1.0, 3.0], [-123_456.0, 1_234_567.0, -77.0]] {
        let by: [f64; D] = std::array::from_fn(|k| cells[k] * side);
        let there =
            Columns { points: columns.points.iter().map(|&p| add(p, by)).collect(), ..columns.clone() };
        for (a, b) in there.points.iter().zip(&columns.points) {
            assert_eq!(common::sub(*a, by), *b, "the move itself must be exact");
        }
        let surface = there.surface(definition);
        assert_eq!(surface.cell_side(), side);
        let queries: Vec<[f64; D]> = queries.iter().map(|&q| add(q, by)).collect();
        let found = without_locations(answers(&surface, &queries));
        same_rows(&found, &expected, &format!("{label}, moved by {cells:?} cells"));
    }
}

#[test]
fn moved_by_whole_cells() {
    for definition in definitions() {
        for variant in VARIANTS {
            let field = definition.kind();
            let torus = grained(samples::torus(1.0, 0.4, 1500, 1).with_noise(0.01, 2));
            // 0.24 lies inside a power of two, 0.25 is one.
            for radius in [0.24, 0.25] {
                let columns = Columns::new(&torus, radius, variant);
                moved(&columns, definition, &format!("torus {field:?} {variant:?} {radius}"));
            }
            let ellipse = grained(samples::ellipse(1.0, 0.6, 400, 3).with_noise(0.005, 4));
            let columns = Columns::new(&ellipse, 0.15, variant);
            moved(&columns, definition, &format!("ellipse {field:?} {variant:?}"));
        }
    }
    for (weight, share) in WEIGHTS {
        let torus = grained(samples::torus(1.0, 0.4, 1500, 1));
        let columns = Columns::new(&torus, 0.22 * share, Variant::PerSampleAndFactors);
        moved(&columns, Definition::new().with_weight(weight), &format!("{weight:?}"));
    }
}

/// The power of the unit of length that a column carries.
fn power(name: &str, axes: bool) -> i32 {
    match name {
        "value" | "average" | "support" | "point" | "distance" | "residual" | "sigma" => 1,
        "second derivatives" | "mean curvature" | "principal curvatures" => -1,
        "Gaussian curvature" => -2,
        "eigenvalues" if !axes => 2,
        _ => 0,
    }
}

fn scaled<const D: usize>(columns: &Columns<D>, definition: Definition, label: &str) {
    let axes = definition.field() == footpoint::NormalField::AveragedAxes;
    let queries = queries(columns);
    let expected = answers(&columns.surface(definition), &queries);
    for exponent in [1, -1, 13, -40, 200, -200] {
        let factor = 2.0_f64.powi(exponent);
        let there = Columns {
            points: columns.points.iter().map(|p| p.map(|c| c * factor)).collect(),
            supports: columns.supports.as_ref().map(|s| s.iter().map(|h| h * factor).collect()),
            radius: columns.radius * factor,
            ..columns.clone()
        };
        let queries: Vec<[f64; D]> = queries.iter().map(|q| q.map(|c| c * factor)).collect();
        let back = |row: Row| {
            let unit = |(name, bits): (&'static str, u64)| match power(name, axes) {
                0 => (name, bits),
                p => (name, (f64::from_bits(bits) / factor.powi(p)).to_bits()),
            };
            row.into_iter().map(unit).collect::<Row>()
        };
        let found: Vec<Row> = answers(&there.surface(definition), &queries).into_iter().map(back).collect();
        same_rows(&found, &expected, &format!("{label}, scaled by 2^{exponent}"));
    }
}

#[test]
fn scaled_by_powers_of_two() {
    for definition in definitions() {
        for variant in VARIANTS {
            let field = definition.kind();
            let torus = Columns::new(&samples::torus(1.0, 0.4, 1500, 1).with_noise(0.01, 2), 0.24, variant);
            scaled(&torus, definition, &format!("torus {field:?} {variant:?}"));
            let ellipse = Columns::new(&samples::ellipse(1.0, 0.6, 400, 3), 0.15, variant);
            scaled(
                &ellipse,
                definition.with_weight(Weight::GAUSSIAN),
                &format!("ellipse {field:?} {variant:?}"),
            );
        }
    }
}

#[test]
fn an_automatic_support_scales_and_moves_along() {
    let torus = grained(samples::torus(1.0, 0.4, 1500, 1).with_noise(0.01, 2));
    let automatic =
        [footpoint::Support::default(), footpoint::Support::AutoPerSample { effective_neighbours: 12.0 }];
    for support in automatic {
        let definition = Definition::new().with_support(support);
        let at = |points: Vec<[f64; 3]>| Surface::new(footpoint::Cloud::new(points), definition).unwrap();
        let surface = at(torus.points.clone());
        let expected = answers(&surface, &torus.points);
        let factor = 2.0_f64.powi(30);
        let doubled = at(torus.points.iter().map(|p| p.map(|c| c * factor)).collect());
        assert_eq!(doubled.support().median, surface.support().median * factor);
        assert_eq!(doubled.support().largest, surface.support().largest * factor);
        let by = [-3.0, 5000.0, 7.0].map(|cells| cells * surface.cell_side());
        let points: Vec<[f64; 3]> = torus.points.iter().map(|&p| add(p, by)).collect();
        let found = answers(&at(points.clone()), &points);
        same_rows(&without_locations(found), &without_locations(expected), &format!("{support:?}"));
    }
}
