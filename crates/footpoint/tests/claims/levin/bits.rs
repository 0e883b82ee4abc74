//! Levin's projection has the same bits for any number of threads, any batch, any order of the samples, and moved.
#![allow(clippy::unwrap_used)]

use crate::common::{
    Columns, Row, Variant, add, near_samples, projection_rows, same_rows, shuffled, without_locations,
};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, Operator, Precision, Project, Queries, Run, Surface};

const DEGREES: [Option<u8>; 3] = [None, Some(0), Some(3)];

/// Coordinates are multiples of this, so that moved ones are exact.
const GRAIN: f64 = 1.0 / (1 << 20) as f64;

fn answers<'q, const D: usize>(
    surface: &Surface<D>,
    queries: impl Into<Queries<'q, D>>,
    run: &Run<'_>,
) -> Vec<Row> {
    let queries = queries.into();
    let project = |degree| {
        let how = Project::new().with_operator(Operator::Levin { degree }).with_tolerance(1e-9);
        projection_rows(&surface.with(run).project(queries, &how).unwrap())
    };
    let [mut rows, value, cubic] = DEGREES.map(project);
    for (row, more) in rows.iter_mut().zip(value.into_iter().zip(cubic)) {
        row.extend(more.0);
        row.extend(more.1);
    }
    rows
}

fn check<const D: usize>(shape: &Samples<D>, radius: f64, variant: Variant, definition: Definition) {
    let label = format!("D = {D} {variant:?} {:?}", definition.precision());
    let grained = |p: [f64; D]| p.map(|c| (c / GRAIN).round() * GRAIN);
    let mut columns = Columns::new(shape, radius, variant);
    columns.points.iter_mut().for_each(|p| *p = grained(*p));
    // One sample in ten twice.
    let count = columns.points.len();
    let columns = columns.select(&(0..count).chain((0..count).step_by(10)).collect::<Vec<_>>());
    let surface = columns.surface(definition);
    let mut queries = near_samples(&columns.points, 150, 0.4 * radius, 3);
    queries.iter_mut().for_each(|q| *q = grained(*q));
    queries.extend([[f64::NAN; D], [1e300; D], [9.0; D]]);
    let queries: Vec<[f64; D]> = shuffled(queries.len(), 5).into_iter().map(|i| queries[i]).collect();
    let expected = answers(&surface, &queries, &Run::new());
    let ok = expected.iter().filter(|row| row[0].1 == 0).count();
    assert!(ok * 3 > expected.len() * 2, "{label}: {ok} of {} ok", expected.len());
    for threads in [1, 2, 4] {
        let found = answers(&surface, &queries, &Run::new().threads(threads));
        same_rows(&found, &expected, &format!("{label}, {threads} threads"));
    }
    for i in (0..queries.len()).step_by(7) {
        let alone = answers(&surface, &[queries[i]], &Run::new().threads(1));
        same_rows(&alone, &expected[i..=i], &format!("{label}, query {i} alone"));
    }
    let order = shuffled(columns.points.len(), 7);
    let mixed = columns.select(&order).surface(definition);
    same_rows(&answers(&mixed, &queries, &Run::new()), &expected, &format!("{label}, shuffled samples"));
    let by: [f64; D] = std::array::from_fn(|k| [-3.0, 500.0, 77.0][k] * surface.cell_side());
    let moved = |points: &[[f64; D]]| points.iter().map(|&p| add(p, by)).collect::<Vec<_>>();
    let there = Columns { points: moved(&columns.points), ..columns.clone() }.surface(definition);
    let found = answers(&there, &moved(&queries), &Run::new());
    same_rows(&without_locations(found), &without_locations(expected), &format!("{label}, moved"));
}

#[test]
fn on_a_noisy_torus() {
    let torus = samples::torus(1.0, 0.4, 1200, 1).with_noise(0.01, 2);
    for variant in [Variant::Uniform, Variant::PerSampleAndFactors] {
        check(&torus, 0.3, variant, Definition::new());
    }
    check(&torus, 0.3, Variant::Uniform, Definition::new().with_precision(Precision::Single));
}

#[test]
fn on_a_noisy_ellipse() {
    let ellipse = samples::ellipse(1.0, 0.6, 300, 3).with_noise(0.005, 4);
    check(&ellipse, 0.2, Variant::PerSampleAndFactors, Definition::new());
}
