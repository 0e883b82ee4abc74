//! Clouds of a hundred thousand samples give the same bits however they are asked, in double precision and in single.
#![allow(clippy::unwrap_used)]

use crate::common::{
    Columns, FIELDS, Variant, add, first_order, in_cube, length, near_samples, scale, shuffled, sub,
};
use footpoint::samples::{self, Random, Samples};
use footpoint::{
    Definition, Evaluations, Instructions, Precision, Project, Projections, Queries, Run, Surface,
};
use std::time::Instant;

const SAMPLES: usize = 100_000;
/// Distinct samples; the others repeat them.
const DISTINCT: usize = SAMPLES - SAMPLES / 10;
/// Queries beside the samples themselves.
const BESIDE: usize = 10_000;

/// The bits of one column, `width` of them a query.
struct Column {
    name: &'static str,
    width: usize,
    bits: Vec<u64>,
}

impl Column {
    fn of(name: &'static str, width: usize, numbers: impl Iterator<Item = f64>) -> Self {
        Self { name, width, bits: numbers.map(f64::to_bits).collect() }
    }

    fn row(&self, i: usize) -> &[u64] {
        &self.bits[i * self.width..(i + 1) * self.width]
    }

    /// Locations move with the cloud.
    fn is_location(&self) -> bool {
        matches!(self.name, "average" | "point")
    }
}

fn evaluation_columns<const D: usize>(e: &Evaluations<D>) -> Vec<Column> {
    let scalars = |name, v: &[f64]| Column::of(name, 1, v.iter().copied());
    let vectors = |name, v: &[[f64; D]]| Column::of(name, D, v.iter().flatten().copied());
    vec![
        Column { name: "status", width: 1, bits: e.status.iter().map(|&s| s as u64).collect() },
        scalars("value", &e.value),
        vectors("average", &e.average),
        vectors("frame normal", &e.frame_normal),
        vectors("gradient", &e.gradient),
        vectors("surface normal", &e.surface_normal),
        scalars("gap", &e.gap),
        scalars("effective neighbours", &e.effective_neighbours),
        scalars("weight sum", &e.weight_sum),
        vectors("eigenvalues", &e.eigenvalues),
        scalars("squared sensitivity", &e.squared_sensitivity),
        scalars("support", &e.support),
        scalars("eccentricity", &e.eccentricity),
        Column { name: "neighbours", width: 1, bits: e.neighbours.iter().map(|&n| n.into()).collect() },
    ]
}

fn projection_columns<const D: usize>(p: &Projections<D>) -> Vec<Column> {
    let scalars = |name, v: &[f64]| Column::of(name, 1, v.iter().copied());
    let vectors = |name, v: &[[f64; D]]| Column::of(name, D, v.iter().flatten().copied());
    vec![
        Column { name: "projected status", width: 1, bits: p.status.iter().map(|&s| s as u64).collect() },
        vectors("point", &p.point),
        vectors("projected surface normal", &p.surface_normal),
        vectors("projected frame normal", &p.frame_normal),
        scalars("distance", &p.distance),
        scalars("residual", &p.residual),
        Column { name: "evaluations", width: 1, bits: p.evaluations.iter().map(|&n| n.into()).collect() },
    ]
}

/// Every column of the evaluation and of the orthogonal projection.
fn answers<'q, const D: usize>(
    surface: &Surface<D>,
    queries: impl Into<Queries<'q, D>>,
    run: Run<'_>,
) -> Vec<Column> {
    let queries = queries.into();
    let running = surface.with(&run);
    let mut columns = evaluation_columns(&running.evaluate(queries, first_order()).unwrap());
    columns.extend(projection_columns(&running.project(queries, &Project::new()).unwrap()));
    columns
}

/// Differences that were found: all are reported, for one kind says little about the others.
#[derive(Default)]
struct Differences(Vec<String>);

impl Differences {
    /// Row j of `found` is to be row `places[j]` of `expected`, bit by bit.
    fn note(&mut self, found: &[&Column], expected: &[&Column], places: &[usize], what: &str) {
        assert_eq!(found.len(), expected.len(), "{what}");
        for (f, e) in found.iter().zip(expected) {
            assert_eq!(f.bits.len(), places.len() * f.width, "{what}: {}", f.name);
            let unlike = || places.iter().enumerate().filter(|&(j, &i)| f.row(j) != e.row(i));
            if let Some((j, &i)) = unlike().next() {
                let numbers = |bits: &[u64]| bits.iter().map(|&b| f64::from_bits(b)).collect::<Vec<_>>();
                self.0.push(format!(
                    "{what}: {} differs in {} of {} rows; row {i} is {:?}, expected {:?}",
                    f.name,
                    unlike().count(),
                    places.len(),
                    numbers(f.row(j)),
                    numbers(e.row(i))
                ));
            }
        }
    }

    #[track_caller]
    fn report(&self) {
        // A few say where to look.
        let some: Vec<&str> = self.0.iter().take(40).map(String::as_str).collect();
        assert!(some.is_empty(), "{} differences:\n{}", self.0.len(), some.join("\n"));
    }
}

fn all(columns: &[Column]) -> Vec<&Column> {
    columns.iter().collect()
}

fn without_locations(columns: &[Column]) -> Vec<&Column> {
    columns.iter().filter(|column| !column.is_location()).collect()
}

fn pick<T: Copy>(column: &[T], places: &[usize]) -> Vec<T> {
    places.iter().map(|&i| column[i]).collect()
}

/// A cloud, the queries, and an exact move of both by whole cells.
struct Case<const D: usize> {
    columns: Columns<D>,
    queries: Vec<[f64; D]>,
    cells: [f64; 3],
    moves: bool,
    label: String,
}

impl<const D: usize> Case<D> {
    /// One sample in ten a repeat. Coordinates are multiples of `grain`, so that moved ones are exact.
    fn new(
        shape: &Samples<D>,
        radius: f64,
        variant: Variant,
        (offset, grain, cells): ([f64; 3], f64, [f64; 3]),
    ) -> Self {
        let mut columns = Columns::new(shape, radius, variant);
        let rounded = |c: f64| (c / grain).round() * grain;
        for p in &mut columns.points {
            *p = std::array::from_fn(|k| rounded(p[k] + offset[k]));
        }
        let repeats = (0..SAMPLES - DISTINCT).map(|i| (i * 7919) % DISTINCT);
        let columns = columns.select(&(0..DISTINCT).chain(repeats).collect::<Vec<_>>());
        let mut queries = columns.points.clone();
        queries.extend(near_samples(&columns.points, BESIDE, 0.7 * radius, 3));
        queries[SAMPLES..].iter_mut().for_each(|q| *q = q.map(rounded));
        let label = format!("D = {D} {variant:?} at {offset:?}");
        let moves = (variant == Variant::Uniform) == (offset == [0.0; 3]);
        Self { columns, queries, cells, moves, label }
    }

    fn check(&self, definition: Definition, unlike: &mut Differences) {
        let label = format!("{} {:?} {:?}", self.label, definition.field(), definition.precision());
        let Self { columns, queries, .. } = self;
        let started = Instant::now();
        let surface = columns.surface(definition);
        let every: Vec<usize> = (0..queries.len()).collect();
        let expected = answers(&surface, queries, Run::new().threads(2));
        let ok = |name| {
            let column = expected.iter().find(|column| column.name == name).unwrap();
            column.bits.iter().filter(|&&status| status == 0).count()
        };
        let (evaluated, projected) = (ok("status"), ok("projected status"));
        // The comparison must be of numbers, not of NaN.
        assert!(evaluated * 10 > queries.len() * 9 && projected * 10 > queries.len() * 8, "{label}");
        let expected = all(&expected);

        // Samples in another order, queries in another, other instructions and one thread.
        let order = shuffled(SAMPLES, 7);
        let mixed = columns.select(&order).surface(definition);
        let batch = shuffled(queries.len(), 8);
        let run = Run::new().threads(1).instructions(Instructions::Avx2);
        let found = answers(&mixed, &pick(queries, &batch), run);
        unlike.note(&all(&found), &expected, &batch, &format!("{label}, all shuffled, AVX2, 1 thread"));
        // Half of the cases take their samples as queries, the others move: both have all fields, supports and places.
        if self.moves {
            self.moved(definition, (&expected, &every), &label, unlike);
        } else {
            let own = answers(&mixed, Queries::Samples, Run::new().threads(4));
            let what = format!("{label}, shuffled samples as queries, 4 threads");
            unlike.note(&all(&own), &expected, &order, &what);
        }
        self.parts(&surface, &expected, &label, unlike);
        self.cut_out(&surface, definition, &label, unlike);
        println!(
            "{label}: {evaluated} evaluated, {projected} projected of {}; {:.1?}",
            queries.len(),
            started.elapsed()
        );
    }

    fn moved(
        &self,
        definition: Definition,
        (expected, every): (&[&Column], &[usize]),
        label: &str,
        unlike: &mut Differences,
    ) {
        let side = self.columns.surface(definition).cell_side();
        let by: [f64; D] = std::array::from_fn(|k| self.cells[k] * side);
        let moved = |points: &[[f64; D]]| -> Vec<[f64; D]> {
            let there: Vec<[f64; D]> = points.iter().map(|&p| add(p, by)).collect();
            assert!(there.iter().zip(points).all(|(&t, &p)| sub(t, by) == p), "the move must be exact");
            there
        };
        let there = Columns { points: moved(&self.columns.points), ..self.columns.clone() };
        let surface = there.surface(definition);
        assert_eq!(surface.cell_side(), side);
        let found = answers(&surface, &moved(&self.queries), Run::new().threads(4));
        let expected: Vec<&Column> =
            expected.iter().filter(|column| !column.is_location()).copied().collect();
        let what = format!("{label}, moved by {:?} cells", self.cells);
        unlike.note(&without_locations(&found), &expected, every, &what);
    }

    /// Single points and random parts of the batch.
    fn parts(&self, surface: &Surface<D>, expected: &[&Column], label: &str, unlike: &mut Differences) {
        let some = shuffled(self.queries.len(), 9);
        let one = Run::new().threads(1);
        for &i in &some[..200] {
            let found = answers(surface, &[self.queries[i]], one);
            unlike.note(&all(&found), expected, &[i], &format!("{label}, query {i} alone"));
        }
        let mut end = 200;
        for size in [7, 333, 10_007] {
            let places = &some[end..end + size];
            end += size;
            let found = answers(surface, &pick(&self.queries, places), one);
            unlike.note(&all(&found), expected, places, &format!("{label}, a batch of {size}"));
        }
    }

    /// All supports of queries near one place, with room for projections to move.
    fn cut_out(&self, surface: &Surface<D>, definition: Definition, label: &str, unlike: &mut Differences) {
        let reach = 1.25 * self.columns.radius;
        let middle = self.columns.points[SAMPLES / 2];
        let near = |p: [f64; D], r: f64| length(sub(p, middle)) < r;
        let places: Vec<usize> =
            (0..SAMPLES).filter(|&i| near(self.columns.points[i], 8.0 * reach)).collect();
        let cut = self.columns.select(&places).surface(definition);
        assert!(places.len() * 20 < SAMPLES && cut.cell_side() == surface.cell_side());
        // An iterate may jump far before it comes back: such queries need more than the cut-out holds. Few
        // evaluations: no second attempt has strayed.
        let stays = |q: &[f64; D]| {
            let trace = surface.trace(*q, &Project::new());
            let projected = surface.with(&Run::new().threads(1)).project(&[*q], &Project::new()).unwrap();
            trace.status.is_ok()
                && trace.iterates.iter().all(|&y| near(y, 6.5 * reach))
                && projected.status[0].is_ok()
                && projected.evaluations[0] <= 25
        };
        let mut random = Random::new(6);
        let around = near_samples(&pick(&self.columns.points, &places), 400, 0.3 * reach, 10);
        let inner: Vec<[f64; D]> = around
            .into_iter()
            .chain((0..100).map(|_| add(middle, scale(in_cube(&mut random), 0.5 * reach))))
            .filter(|&q| near(q, 5.0 * reach))
            .filter(stays)
            .collect();
        assert!(inner.len() > 100, "{label}: {}", inner.len());
        let every: Vec<usize> = (0..inner.len()).collect();
        let one = Run::new().threads(1);
        let (found, expected) = (answers(&cut, &inner, one), answers(surface, &inner, one));
        unlike.note(
            &all(&found),
            &all(&expected),
            &every,
            &format!("{label}, a cut-out of {}", places.len()),
        );
    }
}

/// Where a cloud lies, how finely its coordinates are rounded, and by how many cells it is moved.
const PLACES: [([f64; 3], f64, [f64; 3]); 2] = [
    // It straddles zero, and goes far.
    ([0.0; 3], 1.0 / (1_u64 << 36) as f64, [-3.0, 20_000.0, 7.0]),
    // At survey coordinates, and back to others.
    ([4.5e5, 5.3e6, 200.0], 1.0 / (1_u64 << 28) as f64, [-123_456.0, 7.0, 1000.0]),
];

fn everywhere<const D: usize>(shape: &Samples<D>, radius: f64, precision: Precision) {
    say_what_is_compared();
    let mut unlike = Differences::default();
    for place in PLACES {
        for variant in [Variant::Uniform, Variant::PerSample] {
            let case = Case::new(shape, radius, variant, place);
            for field in FIELDS {
                case.check(Definition::new().with_field(field).with_precision(precision), &mut unlike);
            }
        }
    }
    unlike.report();
}

/// Where the processor has no AVX-512, or not even AVX2, that comparison says nothing.
fn say_what_is_compared() {
    #[cfg(target_arch = "x86_64")]
    for (name, has) in
        [("AVX2", is_x86_feature_detected!("avx2")), ("AVX-512", is_x86_feature_detected!("avx512f"))]
    {
        if !has {
            eprintln!("skipped: AVX-512 against AVX2, for this processor has no {name}");
        }
    }
}

/// About twenty neighbours a support, noise of a twentieth of it.
fn torus() -> (Samples<3>, f64) {
    (samples::torus(1.0, 0.4, DISTINCT, 1).with_noise(0.0017, 2), 0.034)
}

fn ellipse() -> (Samples<2>, f64) {
    (samples::ellipse(100.0, 60.0, DISTINCT, 3).with_noise(0.003, 4), 0.055)
}

#[test]
fn a_torus_in_double_precision() {
    let (shape, radius) = torus();
    everywhere(&shape, radius, Precision::Double);
}

#[test]
fn a_torus_in_single_precision() {
    let (shape, radius) = torus();
    everywhere(&shape, radius, Precision::Single);
}

#[test]
fn an_ellipse_in_double_precision() {
    let (shape, radius) = ellipse();
    everywhere(&shape, radius, Precision::Double);
}

#[test]
fn an_ellipse_in_single_precision() {
    let (shape, radius) = ellipse();
    everywhere(&shape, radius, Precision::Single);
}

/// A wavy curve along the x axis with supports a little below two units of the grid, and queries near it.
fn wave(grain: f64) -> (Columns<2>, Vec<[f64; 2]>) {
    let mut random = Random::new(21);
    let rounded = |p: [f64; 2]| p.map(|c| (c / grain).round() * grain);
    let points = (0..400).map(|_| {
        let x = 16.0 * random.uniform();
        rounded([x, 0.3 * x.sin() + 0.05 * random.normal()])
    });
    let points: Vec<[f64; 2]> = points.collect();
    let columns = Columns { points, normals: None, supports: None, factors: None, radius: 1.9 };
    let queries = near_samples(&columns.points, 2000, 0.5, 22).into_iter().map(rounded).collect();
    (columns, queries)
}

/// A group's positions may lie some nine units apart: a sample's distance to its centre must stay exact even so.
#[test]
fn a_query_far_off_in_its_group() {
    let mut random = Random::new(23);
    // All samples lie at the upper ends of cells, and each query has those of one cell that begins more than eight units
    // from the group's centre.
    let samples =
        (0..400).map(|i| [f64::from(i % 3) * 4.0 - 0.25 * random.uniform(), 0.3 * random.uniform()]);
    let points: Vec<[f64; 2]> = samples.collect();
    let queries: Vec<[f64; 2]> =
        (0..50).map(|_| [1.63 + 0.01 * random.uniform(), 0.3 * random.uniform()]).collect();
    let columns = Columns { points, normals: None, supports: None, factors: None, radius: 1.9 };
    let mut unlike = Differences::default();
    for precision in [Precision::Double, Precision::Single] {
        let surface = columns.surface(Definition::new().with_precision(precision));
        for &x in &queries {
            let one = Run::new().threads(1);
            let alone = evaluation_columns(&surface.with(&one).evaluate(&[x], first_order()).unwrap());
            let pair = [x, [x[0] + 8.75, x[1]]];
            let both = evaluation_columns(&surface.with(&one).evaluate(&pair, first_order()).unwrap());
            let first: Vec<Column> = both.iter().map(|c| Column { bits: c.row(0).to_vec(), ..*c }).collect();
            unlike.note(&all(&first), &all(&alone), &[0], &format!("{precision:?} {x:?} beside another"));
        }
    }
    unlike.report();
}

/// Where doubles are hardly finer than the lattice of single precision, a move shows at once how iterates are rounded.
#[test]
fn a_move_as_far_as_single_precision_goes() {
    let grain = 1.0 / (1_u64 << 24) as f64;
    let (columns, queries) = wave(grain);
    let mut unlike = Differences::default();
    for precision in [Precision::Double, Precision::Single] {
        let definition = Definition::new().with_precision(precision);
        let case = Case {
            columns: columns.clone(),
            queries: queries.clone(),
            cells: [(1_u64 << 26) as f64, 1.0, 0.0],
            moves: true,
            label: format!("a wave, {precision:?}"),
        };
        let expected = answers(&columns.surface(definition), &queries, Run::new().threads(1));
        let every: Vec<usize> = (0..queries.len()).collect();
        case.moved(definition, (&all(&expected), &every), &case.label, &mut unlike);
    }
    unlike.report();
}
