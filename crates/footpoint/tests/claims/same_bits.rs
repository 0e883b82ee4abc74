//! Answers have the same bits for any number of threads, any batch, and any order or cut-out of the samples.
#![allow(clippy::unwrap_used)]

use crate::common::{
    self, Columns, FIELDS, OPERATORS, Row, VARIANTS, Variant, WEIGHTS, add, definitions, evaluation_rows,
    length, near_samples, projection_rows, same_rows, scale, shuffled, sub,
};
use footpoint::samples::{self, Random, Samples};
use footpoint::{Definition, Project, Queries, Run, Surface, Want};

/// Evaluations, and projections by all operators, of the same queries: one list of rows.
fn answers<'q, const D: usize>(
    surface: &Surface<D>,
    queries: impl Into<Queries<'q, D>>,
    run: &Run<'_>,
) -> Vec<Row> {
    let queries = queries.into();
    let running = surface.with(run);
    let mut rows = evaluation_rows(&running.evaluate(queries, Want::ALL).unwrap());
    for (k, operator) in OPERATORS.into_iter().enumerate() {
        let how = Project::new().with_operator(operator).with_tolerance([1e-6, 1e-12, 1e-9][k]);
        let projected = projection_rows(&running.project(queries, &how).unwrap());
        rows.iter_mut().zip(projected).for_each(|(row, more)| row.extend(more));
    }
    rows
}

fn pick(rows: &[Row], places: &[usize]) -> Vec<Row> {
    places.iter().map(|&i| rows[i].clone()).collect()
}

/// Queries near and far, in no order, with some that have no answer.
fn queries<const D: usize>(columns: &Columns<D>) -> Vec<[f64; D]> {
    let mut queries = near_samples(&columns.points, 300, 0.4 * columns.radius, 3);
    queries.extend(near_samples(&columns.points, 60, 1.5 * columns.radius, 4));
    queries.extend(columns.points.iter().step_by(23));
    queries.extend([[f64::NAN; D], [1e300; D], [f64::INFINITY; D]]);
    shuffled(queries.len(), 5).into_iter().map(|i| queries[i]).collect()
}

fn check<const D: usize>(columns: &Columns<D>, definition: Definition, label: &str) {
    let surface = columns.surface(definition);
    let queries = queries(columns);
    let run = Run::new();
    let expected = answers(&surface, &queries, &run);
    // The comparison must be of numbers, not of NaN.
    let ok = expected.iter().filter(|row| row[0].1 == 0).count();
    assert!(ok * 2 > expected.len(), "{label}: {ok} of {} ok", expected.len());

    for threads in [1, 2, 4] {
        let found = answers(&surface, &queries, &Run::new().threads(threads));
        same_rows(&found, &expected, &format!("{label}, {threads} threads"));
    }

    let one = Run::new().threads(1);
    for i in (0..queries.len()).step_by(9) {
        let single = answers(&surface, &[queries[i]], &one);
        same_rows(&single, &expected[i..=i], &format!("{label}, query {i} alone"));
    }
    let mut random = Random::new(6);
    for _ in 0..4 {
        let share = random.uniform();
        let places: Vec<usize> = (0..queries.len()).filter(|_| random.uniform() < share).collect();
        let places: Vec<usize> = shuffled(places.len(), random.bits()).iter().map(|&i| places[i]).collect();
        let batch: Vec<[f64; D]> = places.iter().map(|&i| queries[i]).collect();
        let found = answers(&surface, &batch, &one);
        same_rows(&found, &pick(&expected, &places), &format!("{label}, a batch of {}", places.len()));
    }

    let own = answers(&surface, Queries::Samples, &run);
    let foreign = answers(&surface, &columns.points, &run);
    same_rows(&own, &foreign, &format!("{label}, samples as points"));

    let order = shuffled(columns.points.len(), 7);
    let mixed = columns.select(&order).surface(definition);
    same_rows(&answers(&mixed, &queries, &run), &expected, &format!("{label}, shuffled samples"));
    let mixed = answers(&mixed, Queries::Samples, &run);
    same_rows(&mixed, &pick(&own, &order), &format!("{label}, shuffled samples at themselves"));

    // All supports of queries near one place, with room for projections to move.
    let reach = 1.25 * columns.radius * definition.weight().reach();
    let middle = columns.points[columns.points.len() / 2];
    let near = |p: [f64; D], r: f64| length(sub(p, middle)) < r;
    let places: Vec<usize> =
        (0..columns.points.len()).filter(|&i| near(columns.points[i], 3.0 * reach)).collect();
    assert!(places.len() < columns.points.len(), "{label}: nothing was cut off");
    let cut = columns.select(&places).surface(definition);
    // An iterate may jump far before it comes back: such queries need more than the cut-out holds.
    let stays = |q: &[f64; D]| {
        OPERATORS.iter().all(|&operator| {
            let how = Project::new().with_operator(operator).with_tolerance(1e-12);
            let trace = surface.trace(*q, &how);
            // Few evaluations: no second attempt has strayed.
            let projected = surface.project(&[*q], &how);
            trace.status.is_ok()
                && trace.iterates.iter().all(|&y| near(y, 1.9 * reach))
                && projected.status[0].is_ok()
                && projected.evaluations[0] <= 25
        })
    };
    let inner: Vec<[f64; D]> = (0..60)
        .map(|_| add(middle, scale(common::in_cube(&mut random), 0.5 * reach)))
        .filter(stays)
        .collect();
    assert!(inner.len() > 20, "{label}: {}", inner.len());
    let found = answers(&cut, &inner, &run);
    same_rows(&found, &answers(&surface, &inner, &run), &format!("{label}, a cut-out"));
}

fn every_field<const D: usize>(shape: &Samples<D>, radius: f64) {
    for variant in VARIANTS {
        for definition in definitions() {
            let columns = Columns::new(shape, radius, variant);
            check(&columns, definition, &format!("D = {D} {variant:?} {:?}", definition.kind()));
        }
    }
}

#[test]
fn on_a_noisy_torus_that_straddles_zero() {
    every_field(&samples::torus(1.0, 0.4, 1500, 1).with_noise(0.01, 2), 0.24);
}

#[test]
fn on_a_noisy_ellipse_that_straddles_zero() {
    every_field(&samples::ellipse(1.0, 0.6, 400, 3).with_noise(0.005, 4), 0.15);
}

#[test]
fn for_every_weight() {
    for (weight, share) in WEIGHTS {
        let columns =
            Columns::new(&samples::torus(1.0, 0.4, 1500, 1), share * 0.2, Variant::PerSampleAndFactors);
        let definition = Definition::new().with_weight(weight);
        // The uncut Gaussian reaches 6 of its scales: here it ends at 3.
        let definition = match weight {
            footpoint::Weight::Gaussian { .. } => {
                definition.with_weight(footpoint::Weight::Gaussian { cut: 1e-4 })
            }
            _ => definition,
        };
        check(&columns, definition, &format!("{weight:?}"));
    }
}

/// With one sample in ten given twice or three times.
fn repeated<const D: usize>(columns: &Columns<D>) -> Columns<D> {
    let count = columns.points.len();
    let places = (0..count).chain((0..count).step_by(10)).chain((0..count).step_by(30));
    columns.select(&places.collect::<Vec<_>>())
}

#[test]
fn with_exact_repeats_at_survey_offsets() {
    for variant in VARIANTS {
        let mut columns = Columns::new(&samples::torus(1.0, 0.4, 1200, 1), 0.28, variant);
        for p in &mut columns.points {
            *p = add(*p, [4.5e5, 5.3e6, 100.0]);
        }
        let columns = repeated(&columns);
        check(&columns, Definition::new(), &format!("repeats {variant:?}"));
    }
    let mut columns = Columns::new(&samples::ellipse(1.0, 0.6, 400, 3), 0.15, Variant::Uniform);
    for p in &mut columns.points {
        *p = add(*p, [4.5e5, 5.3e6]);
    }
    check(&repeated(&columns), Definition::new(), "repeats of a curve");
}

#[test]
fn repeats_with_different_columns_keep_their_order_too() {
    // Equal points whose normals and factors differ: only the content can order them.
    let columns = Columns::new(&samples::torus(1.0, 0.4, 800, 1), 0.34, Variant::PerSampleAndFactors);
    let mut twice = repeated(&repeated(&columns));
    let mut random = Random::new(12);
    for normal in twice.normals.as_mut().unwrap() {
        *normal = add(*normal, scale(common::in_cube(&mut random), 0.1));
    }
    for factor in twice.factors.as_mut().unwrap() {
        *factor *= 1.0 + random.uniform();
    }
    for field in FIELDS {
        check(&twice, Definition::new().with_field(field), &format!("unlike repeats {field:?}"));
    }
}
