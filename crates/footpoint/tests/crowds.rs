//! Crowds and voids — far queries, outliers, dense blobs, repeats, uneven density — are answered right, and at the price
//! of their neighbours.
#![allow(clippy::unwrap_used)]

mod common;

use common::{add, first_order, in_cube, length, median, near_samples, scale, shuffled, sub};
use footpoint::samples::{self, Random};
use footpoint::{Cloud, Definition, Evaluations, Precision, Project, Run, Status, Support, Surface};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use std::f64::consts::TAU;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

type Point = [f64; 3];

/// A case may cost this many times what its neighbours cost in an easy cloud: machines are shared.
const DEARER: f64 = 20.0;
/// The same for a projection: where single precision cannot tell zeros apart, many points take all the second attempts.
const DEARER_PROJECTION: f64 = 80.0;
/// Queries that are compared with plain sums.
const COMPARED: usize = 300;
/// How far f may be from them, in h.
const DOUBLE: f64 = 1e-11;
/// How far f in single precision may be from double, in h.
const SINGLE: f64 = 2e-6;
/// What a case may add to the peak of memory, in kB.
const MOST_MEMORY: u64 = 500_000;

/// The usual sheet: twenty neighbours a support.
const SHEET: usize = 20_000;
const HALF: f64 = 10.0;
const H: f64 = 0.36;
const NOISE: f64 = 0.01;

/// Cases are timed: one at a time.
fn alone() -> MutexGuard<'static, ()> {
    static ONE: Mutex<()> = Mutex::new(());
    ONE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn one_thread() -> Run<'static> {
    Run::new().threads(1)
}

fn sheet() -> Vec<Point> {
    samples::plane(HALF, SHEET, 1).with_noise(NOISE, 2).points
}

fn built(points: &[Point], definition: Definition) -> Surface<3> {
    Surface::build(Cloud::new(points), definition, &one_thread()).unwrap()
}

fn uniform(points: &[Point], precision: Precision) -> Surface<3> {
    built(points, Definition::new().with_support(Support::Uniform(H)).with_precision(precision))
}

fn per_sample(points: &[Point], supports: &[f64]) -> Surface<3> {
    let cloud = Cloud::new(points).with_supports(supports).unwrap();
    Surface::build(cloud, Definition::new().with_support(Support::FromSamples), &one_thread()).unwrap()
}

fn evaluate(surface: &Surface<3>, queries: &[Point]) -> Evaluations<3> {
    surface.with(&one_thread()).evaluate(queries, first_order()).unwrap()
}

/// The same quantities by a sum over all samples.
struct Plain {
    neighbours: u32,
    average: Point,
    value: f64,
    gap: f64,
    support: f64,
}

fn plain(points: &[Point], h: impl Fn(usize) -> f64, x: Point) -> Plain {
    let near: Vec<(Vector3<f64>, f64, f64)> = (0..points.len())
        .filter_map(|i| {
            let d = Vector3::from(sub(points[i], x));
            let t = 1.0 - d.norm_squared() / (h(i) * h(i));
            (t > 0.0).then(|| (d, t * t * t, h(i)))
        })
        .collect();
    let weight: f64 = near.iter().map(|(_, theta, _)| theta).sum();
    let aside = near.iter().map(|(d, theta, _)| d * *theta).sum::<Vector3<f64>>() / weight;
    let covariance: Matrix3<f64> =
        near.iter().map(|(d, theta, _)| (d - aside) * (d - aside).transpose() * *theta).sum();
    let eigen = SymmetricEigen::new(covariance);
    let mut order = [0, 1, 2];
    order.sort_unstable_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let [low, middle, high] = order.map(|i| eigen.eigenvalues[i]);
    Plain {
        neighbours: near.len() as u32,
        average: add(x, aside.into()),
        value: -eigen.eigenvectors.column(order[0]).dot(&aside),
        gap: (middle - low) / high,
        support: near.iter().map(|(_, theta, h)| theta * h).sum::<f64>() / weight,
    }
}

/// What the error grows with (`Precision`): samples beyond a hundred, samples that crowd far from the query, and how much f
/// depends on single ones.
fn hardness(e: &Evaluations<3>, at: Point, i: usize) -> f64 {
    let away = sub(e.average[i], at);
    let size = e.eigenvalues[i][2] / e.weight_sum[i];
    let crowding = 1.0 + away.iter().map(|c| c * c).sum::<f64>() / size;
    let many = (f64::from(e.neighbours[i]) / 100.0).max(1.0);
    crowding * many * (2.0 * e.squared_sensitivity[i].sqrt()).max(1.0)
}

/// Some of the queries, in double precision, against the plain sums.
fn check_right(
    label: &str,
    (surface, queries): (&Surface<3>, &[Point]),
    h: impl Fn(usize) -> f64,
    faults: &mut Vec<String>,
) {
    let points = surface.cloud().points();
    let places = &shuffled(queries.len(), 11)[..queries.len().min(COMPARED)];
    let found = evaluate(surface, queries);
    let (mut worst, mut compared) = ((0.0_f64, String::new()), 0);
    for &i in places {
        let expected = plain(points, &h, queries[i]);
        let what = format!("{label}: query {i} at {:?} is {}", queries[i], found.status[i]);
        assert_eq!(found.neighbours[i], expected.neighbours, "{what}");
        assert_eq!(found.status[i] == Status::Outside, expected.neighbours == 0, "{what}");
        if expected.neighbours == 0 {
            continue;
        }
        // Averages are absolute: rounded to doubles there.
        let rounding = 4.0 * f64::EPSILON * length(queries[i]);
        let average = length(sub(found.average[i], expected.average));
        assert!(average <= DOUBLE * expected.support + rounding, "{what}: a is off by {average:e}");
        if expected.gap > 0.1 {
            let off = (found.value[i].abs() - expected.value.abs()).abs() / expected.support;
            let off = off / hardness(&found, queries[i], i);
            compared += 1;
            if off > worst.0 {
                worst = (off, format!("{what}: {} neighbours, gap {:.2}", expected.neighbours, expected.gap));
            }
        }
    }
    println!(
        "{label}: {compared} of {} with a frame, f off by at most {:.1e} h, for its hardness",
        places.len(),
        worst.0
    );
    if worst.0 > DOUBLE {
        faults.push(format!("{}: f is off by {:.1e} h", worst.1, worst.0));
    }
}

/// All queries in single precision against double.
fn check_single(label: &str, (points, queries): (&[Point], &[Point]), faults: &mut Vec<String>) {
    let [double, single] =
        [Precision::Double, Precision::Single].map(|p| evaluate(&uniform(points, p), queries));
    let off = |i: usize| {
        let clear = double.status[i].is_ok() && single.status[i].is_ok() && double.gap[i] > 0.1;
        let difference = (double.value[i].abs() - single.value[i].abs()).abs();
        clear.then(|| difference / H / hardness(&double, queries[i], i))
    };
    let off: Vec<(f64, usize)> = (0..queries.len()).filter_map(|i| Some((off(i)?, i))).collect();
    let (worst, at) = off.iter().copied().fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
    let wrong = off.iter().filter(|(off, _)| *off > SINGLE).count();
    println!(
        "{label}: {} in both precisions, f differs by at most {worst:.1e} h, for its hardness",
        off.len()
    );
    if wrong > 0 {
        faults.push(format!(
            "{label}: f differs by more than {SINGLE:e} h at {wrong} of {} queries; most, {worst:.1e} h, at {:?}: {} \
             neighbours, {:.1} effective, gap {:.2}, |∇f| {:.2}, √Σ|∂f/∂p|² {:.2}",
            off.len(),
            queries[at],
            double.neighbours[at],
            double.effective_neighbours[at],
            double.gap[at],
            length(double.gradient[at]),
            double.squared_sensitivity[at].sqrt()
        ));
    }
}

fn seconds(work: impl Fn()) -> f64 {
    median((0..3).map(|_| {
        let started = Instant::now();
        work();
        started.elapsed().as_secs_f64()
    }))
}

/// Seconds for evaluating and for projecting all queries.
fn times(surface: &Surface<3>, queries: &[Point]) -> [f64; 2] {
    let run = one_thread();
    let running = surface.with(&run);
    [
        seconds(|| drop(running.evaluate(queries, first_order()))),
        seconds(|| drop(running.project(queries, &Project::new()))),
    ]
}

/// What queries cost where nothing is uneven: each, and beyond that for each neighbour.
struct Prices {
    each: [f64; 2],
    neighbour: [f64; 2],
    /// Building, per sample.
    building: f64,
}

fn prices(precision: Precision) -> &'static Prices {
    static PRICES: [OnceLock<Prices>; 2] = [const { OnceLock::new() }; 2];
    PRICES[precision as usize].get_or_init(|| {
        let sheet = sheet();
        let near = near_samples(&sheet, 10_000, 0.3 * H, 3);
        let each = times(&uniform(&sheet, precision), &near).map(|t| t / near.len() as f64);
        let building = seconds(|| drop(uniform(&sheet, precision))) / sheet.len() as f64;
        // Ten thousand neighbours a support.
        let dense: Vec<Point> =
            samples::plane(1.6 * H, 33_000, 4).with_noise(NOISE, 5).points.into_iter().collect();
        let middle: Vec<Point> = dense.iter().copied().filter(|&p| length(p) < 0.5 * H).collect();
        let queries = near_samples(&middle, 400, 0.1 * H, 6);
        let neighbour = times(&uniform(&dense, precision), &queries).map(|t| t / (400.0 * 1e4));
        let prices = Prices { each, neighbour, building };
        let [ns, ps] = [each, neighbour].map(|p| p.map(|t| t * 1e9));
        println!(
            "{precision:?}: easy queries {ns:.0?} ns, neighbours {ps:.3?} ns, samples {:.0} ns",
            building * 1e9
        );
        prices
    })
}

/// Evaluating and projecting cost no more than the true neighbours would in an easy cloud, up to a factor.
fn check_price(label: &str, surface: &Surface<3>, queries: &[Point], faults: &mut Vec<String>) {
    let prices = prices(surface.definition().precision());
    let neighbours: f64 = evaluate(surface, queries).neighbours.iter().map(|&n| f64::from(n)).sum();
    let spent = times(surface, queries);
    let price: [f64; 2] =
        std::array::from_fn(|k| prices.each[k] * queries.len() as f64 + prices.neighbour[k] * neighbours);
    let dearer: [f64; 2] = std::array::from_fn(|k| spent[k] / price[k]);
    println!(
        "{label}: {} queries with {:.0} neighbours each, {:.0?} ms; evaluating and projecting cost {dearer:.2?} of the easy",
        queries.len(),
        neighbours / queries.len() as f64,
        spent.map(|t| t * 1e3)
    );
    if dearer[0] >= DEARER || dearer[1] >= DEARER_PROJECTION {
        faults.push(format!("{label}: {dearer:.1?} times the price of an easy case"));
    }
}

fn check_building(label: &str, samples: usize, build: impl Fn() -> Surface<3>) {
    let spent = seconds(|| drop(build()));
    let dearer = spent / (prices(Precision::Double).building * samples as f64);
    println!("{label}: building costs {dearer:.2} of the easy");
    assert!(dearer < DEARER, "{label}: building costs {dearer:.1} times that of an easy cloud");
}

#[track_caller]
fn report(faults: &[String]) {
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The highest memory use so far in kB, where the system tells; its counters are approximate, so it can seem to fall.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// Does `work` within bounded memory.
fn check_memory(label: &str, work: impl FnOnce()) {
    let before = peak_memory();
    work();
    match (before, peak_memory()) {
        (Some(before), Some(after)) => {
            println!("{label}: the peak of memory went from {before} to {after} kB");
            let rise = after.saturating_sub(before);
            assert!(rise < MOST_MEMORY, "{label}: {rise} kB");
        }
        _ => eprintln!("skipped: the system does not tell the peak of memory"),
    }
}

fn in_order(queries: &[Point], seed: u64) -> Vec<Point> {
    shuffled(queries.len(), seed).into_iter().map(|i| queries[i]).collect()
}

/// A random point of the unit ball.
fn in_ball(random: &mut Random) -> Point {
    loop {
        let p = in_cube(random);
        if length(p) < 1.0 {
            return p;
        }
    }
}

/// Prices of a cloud with one support, and that f is right: against plain sums, or in single precision against double.
fn check(
    label: &str,
    points: &[Point],
    queries: &[(&'static str, Vec<Point>)],
    precision: Precision,
    faults: &mut Vec<String>,
) {
    let label = format!("{label} ({precision:?})");
    check_building(&label, points.len(), || uniform(points, precision));
    let surface = uniform(points, precision);
    for (place, queries) in queries {
        let label = format!("{label}, {place}");
        check_price(&label, &surface, queries, faults);
        if precision == Precision::Double {
            check_right(&label, (&surface, queries), |_| H, faults);
        } else {
            check_single(&label, (points, queries), faults);
        }
    }
}

/// Queries in a box this many supports wide, and among near ones.
fn far_and_mixed(points: &[Point], wide: f64) -> [Vec<Point>; 2] {
    let mut random = Random::new(5);
    let far: Vec<Point> = (0..10_000).map(|_| scale(in_cube(&mut random), 0.5 * wide * H)).collect();
    let near = near_samples(points, 5000, 0.5 * H, 6);
    let mixed = in_order(&[far.clone(), near].concat(), 7);
    [far, mixed]
}

fn check_far_apart(precision: Precision) {
    let points = sheet();
    let mut faults = Vec::new();
    // A box of a million supports, and one in which some queries still meet the sheet.
    for wide in [1e6, 100.0] {
        let [far, mixed] = far_and_mixed(&points, wide);
        let label = format!("queries over {wide:e} supports");
        check(
            &label,
            &points,
            &[("far ones", far.clone()), ("mixed", mixed.clone())],
            precision,
            &mut faults,
        );
        let [double, own] = [Precision::Double, precision].map(|p| uniform(&points, p));
        let outside = evaluate(&own, &far).status.iter().filter(|&&s| s == Status::Outside).count();
        assert!(if wide > 1e3 { outside == far.len() } else { outside < far.len() }, "{label}: {outside}");
        let [double, own] = [double, own].map(|surface| evaluate(&surface, &mixed).status);
        let unlike = double.iter().zip(&own).filter(|(a, b)| a != b).count();
        assert!(unlike * 1000 < mixed.len(), "{label}: {unlike} statuses differ");
    }
    report(&faults);
}

#[test]
fn queries_far_apart() {
    let _alone = alone();
    check_far_apart(Precision::Double);
}

#[test]
fn queries_far_apart_in_single_precision() {
    let _alone = alone();
    check_far_apart(Precision::Single);
}

/// The sheet with a hundred outliers: sixty alone, and four little groups. Then queries elsewhere, and at outliers, the lone
/// ones themselves first.
fn with_outliers() -> (Vec<Point>, [(&'static str, Vec<Point>); 3]) {
    let mut random = Random::new(8);
    let mut direction = || {
        let p = in_ball(&mut random);
        scale(p, 1.0 / length(p))
    };
    let mut outliers: Vec<Point> =
        (0..60).map(|i| scale(direction(), H * 10.0_f64.powf(2.0 + f64::from(i) / 5.9))).collect();
    for distance in [1e3, 1e6, 1e9, 1e12] {
        let centre = scale(direction(), H * distance);
        outliers.extend((0..10).map(|_| add(centre, scale(direction(), 0.3 * H))));
    }
    let sheet = sheet();
    let points = in_order(&[sheet.clone(), outliers.clone()].concat(), 9);
    let mut at = outliers.clone();
    for (p, seed) in outliers.iter().zip(10..) {
        at.extend(near_samples(&[*p], 9, 0.3 * H, seed));
    }
    let near = near_samples(&sheet, 5000, 0.5 * H, 6);
    let mixed = in_order(&[near.clone(), at.clone()].concat(), 11);
    (points, [("elsewhere", near), ("at them", at), ("mixed", mixed)])
}

#[test]
fn far_outliers() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (points, queries) = with_outliers();
    check("outliers", &points, &queries, Precision::Double, &mut faults);
    let lone = evaluate(&uniform(&points, Precision::Double), &queries[1].1[..60]);
    assert!(lone.status.iter().all(|&status| status == Status::Degenerate));
    report(&faults);
}

#[test]
fn far_outliers_in_single_precision() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (points, queries) = with_outliers();
    check("outliers", &points, &queries, Precision::Single, &mut faults);
    let mixed = &queries[2].1;
    let [double, single] =
        [Precision::Double, Precision::Single].map(|p| evaluate(&uniform(&points, p), mixed));
    for (i, q) in mixed.iter().enumerate() {
        // The limit of single precision is 2^31 supports, of the power of two below theirs.
        let reach = q.iter().fold(0.0_f64, |m, c| m.max(c.abs())) / H;
        if reach > (1_u64 << 32) as f64 {
            assert_eq!(single.status[i], Status::Invalid, "{q:?}");
        } else if reach < (1_u64 << 30) as f64 && double.status[i] != single.status[i] {
            // A neighbour on the rim, or hardly a frame.
            assert!(double.neighbours[i] != single.neighbours[i] || double.gap[i] < 1e-3, "{q:?}");
        }
    }
    report(&faults);
}

/// A sheet with ten thousand samples in half a support, and queries inside, on the rim, and beside.
fn with_blob() -> (Vec<Point>, [(&'static str, Vec<Point>); 4]) {
    let mut random = Random::new(12);
    let mut points = sheet();
    // Flat, so that it has a normal.
    points.extend((0..10_000).map(|_| {
        let p = in_ball(&mut random);
        [0.5 * H * p[0], 0.5 * H * p[1], 0.15 * H * p[2]]
    }));
    let inside: Vec<Point> = (0..300).map(|_| scale(in_ball(&mut random), 0.5 * H)).collect();
    let mut around = |count: usize, from: f64, to: f64| -> Vec<Point> {
        let mut one = || {
            let r = H * (from + (to - from) * random.uniform());
            let (sine, cosine) = (TAU * random.uniform()).sin_cos();
            [r * cosine, r * sine, 0.3 * H * (random.uniform() - 0.5)]
        };
        (0..count).map(|_| one()).collect()
    };
    // Beside it no sample of the blob is a neighbour, but all are near.
    let (rim, beside) = (around(300, 0.5, 1.5), around(3000, 1.55, 4.0));
    let mixed = in_order(&[inside.clone(), rim.clone(), beside.clone()].concat(), 14);
    let queries = [("inside", inside), ("on its rim", rim), ("beside it", beside), ("all around", mixed)];
    (in_order(&points, 13), queries)
}

#[test]
fn ten_thousand_samples_in_one_ball() {
    let _alone = alone();
    let mut faults = Vec::new();
    check_memory("a blob", || {
        let (points, queries) = with_blob();
        check("a blob", &points, &queries, Precision::Double, &mut faults);
    });
    report(&faults);
}

#[test]
fn ten_thousand_samples_in_one_ball_in_single_precision() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (points, queries) = with_blob();
    check("a blob", &points, &queries, Precision::Single, &mut faults);
    report(&faults);
}

/// A sheet of which fifteen points come a thousand times more, and five thousand once more; queries near all, near those
/// that come often, and at these.
fn with_repeats() -> (Vec<Point>, [(&'static str, Vec<Point>); 3]) {
    let sheet = sheet();
    let often = &sheet[..15];
    let mut points = sheet.clone();
    points.extend(often.iter().flat_map(|&p| vec![p; 1000]));
    points.extend(&sheet[100..5100]);
    let queries = [
        ("anywhere", near_samples(&sheet, 5000, 0.5 * H, 16)),
        ("near many", near_samples(often, 1000, 0.8 * H, 17)),
        ("at many", often.to_vec()),
    ];
    (in_order(&points, 15), queries)
}

#[test]
fn half_of_the_samples_repeated() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (points, queries) = with_repeats();
    check("repeats", &points, &queries, Precision::Double, &mut faults);
    report(&faults);
}

#[test]
fn half_of_the_samples_repeated_in_single_precision() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (points, queries) = with_repeats();
    check("repeats", &points, &queries, Precision::Single, &mut faults);
    report(&faults);
}

#[test]
fn repeats_do_not_shrink_an_automatic_support() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (points, [(_, queries), ..]) = with_repeats();
    for support in [Support::default(), Support::AutoPerSample { effective_neighbours: 16.0 }] {
        let definition = Definition::new().with_support(support);
        let [with, without] = [&points, &sheet()].map(|points| {
            let spent = seconds(|| drop(built(points, definition)));
            (spent, built(points, definition))
        });
        println!("{support:?}: {:.0} ms with repeats, {:.0} without", with.0 * 1e3, without.0 * 1e3);
        assert!(with.0 < DEARER * without.0, "{support:?}");
        let [a, b] = [&with.1, &without.1].map(Surface::support);
        assert_eq!((a.smallest, a.largest), (b.smallest, b.largest), "{support:?}");
        check_price(&format!("repeats with {support:?}"), &with.1, &queries, &mut faults);
    }
    report(&faults);
}

/// A sheet whose spacing grows with the distance from the middle: rings of two hundred samples each, supports from 1e-4
/// to 1.
fn growing() -> (Vec<Point>, Vec<f64>) {
    let (around, support) = (200, 0.0793);
    let growth = 1.0 + TAU / f64::from(around);
    let mut random = Random::new(18);
    let (mut points, mut supports) = (Vec::new(), Vec::new());
    let mut r = 1e-4 / support;
    while support * r <= 1.0 {
        for k in 0..around {
            let (sine, cosine) = (TAU * (f64::from(k) + random.uniform()) / f64::from(around)).sin_cos();
            let own = r * growth.powf(random.uniform());
            points.push([own * cosine, own * sine, 0.05 * support * own * random.normal()]);
            supports.push((support * own).min(1.0));
        }
        r *= growth;
    }
    let order = shuffled(points.len(), 20);
    order.into_iter().map(|i| (points[i], supports[i])).unzip()
}

/// A cloud with supports of its own, asked beside the samples at these places.
fn check_own_supports(
    label: &str,
    (points, supports): (&[Point], &[f64]),
    at: impl Iterator<Item = usize>,
    faults: &mut Vec<String>,
) {
    let surface = per_sample(points, supports);
    let mut random = Random::new(19);
    let queries: Vec<Point> =
        at.map(|i| add(points[i], scale(in_cube(&mut random), 0.4 * supports[i]))).collect();
    check_price(label, &surface, &queries, faults);
    check_right(label, (&surface, &queries), |i| supports[i], faults);
    let projected = surface.with(&one_thread()).project(&queries, &Project::new()).unwrap();
    let ok = projected.status.iter().filter(|status| status.is_ok()).count();
    assert!(ok * 10 > queries.len() * 9, "{label}: {ok} of {} projected", queries.len());
}

#[test]
fn a_density_ratio_of_ten_thousand() {
    let _alone = alone();
    let mut faults = Vec::new();
    check_memory("uneven density", || {
        let (points, supports) = growing();
        let all = (points.as_slice(), supports.as_slice());
        let (least, most) = supports.iter().fold((f64::MAX, 0.0_f64), |(l, m), &h| (l.min(h), m.max(h)));
        assert!(most / least > 0.99e4, "{least} {most}");
        check_building("a growing spacing", points.len(), || per_sample(&points, &supports));
        check_own_supports("a growing spacing", all, (0..points.len()).step_by(6), &mut faults);
        for (label, sizes) in [("the finest", 0.0..1e-3), ("the coarsest", 0.1..1.1)] {
            let some = (0..points.len()).filter(|&i| sizes.contains(&supports[i])).take(3000);
            check_own_supports(label, all, some, &mut faults);
        }
    });
    report(&faults);
}

/// Most samples are coarse, and all the others lie in one coarse cell.
#[test]
fn a_fine_patch_in_a_coarse_sheet() {
    let _alone = alone();
    let mut faults = Vec::new();
    let (fine, count) = (1e-4, 15_000);
    let mut points = sheet();
    let mut supports = vec![H; SHEET];
    points.extend(sheet()[..count].iter().map(|&p| add([0.0, 0.0, 0.02], scale(p, fine))));
    supports.resize(points.len(), H * fine * (SHEET as f64 / count as f64).sqrt());
    let all = (points.as_slice(), supports.as_slice());
    check_building("a fine patch", points.len(), || per_sample(&points, &supports));
    check_own_supports("a fine patch", all, (SHEET..points.len()).step_by(5), &mut faults);
    check_own_supports("the coarse sheet around it", all, (0..SHEET).step_by(5), &mut faults);
    report(&faults);
}

#[test]
fn all_queries_at_one_point() {
    let _alone = alone();
    let mut faults = Vec::new();
    let points = sheet();
    let x = add(points[SHEET / 2], [0.1 * H, 0.05 * H, 0.2 * H]);
    let queries = vec![x; 10_000];
    for precision in [Precision::Double, Precision::Single] {
        let surface = uniform(&points, precision);
        check_price(&format!("one point, {precision:?}"), &surface, &queries, &mut faults);
        let (all, one) = (evaluate(&surface, &queries), evaluate(&surface, &[x]));
        assert!(all.status.iter().all(|status| status.is_ok()));
        assert!(all.value.iter().all(|f| f.to_bits() == one.value[0].to_bits()));
        let bits = |v: Point| v.map(f64::to_bits);
        assert!(all.gradient.iter().all(|&g| bits(g) == bits(one.gradient[0])));
        let projected = surface.with(&one_thread()).project(&queries, &Project::new()).unwrap();
        assert!(projected.status[0].is_ok());
        assert!(projected.point.iter().all(|&y| bits(y) == bits(projected.point[0])));
    }
    check_right("one point", (&uniform(&points, Precision::Double), &queries[..1]), |_| H, &mut faults);
    check_single("one point", (&points, &queries), &mut faults);
    report(&faults);
}
