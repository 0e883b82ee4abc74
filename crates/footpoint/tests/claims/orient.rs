//! Normals get signs that agree: no sample of a surface with two sides is wrong, and one without sides is left alone.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use crate::common::{self, add, dot, fibonacci_sphere, scale, shuffled};
use footpoint::samples::{self, Random, Samples};
use footpoint::{
    Cloud, Definition, NonOrientable, NormalField, NormalSource, Orient, OrientError, Orientation, Precision,
    Project, Run, Sign, Status, Support, Surface, Verdict, spacing,
};

const PROPAGATED: [NonOrientable; 2] = [NonOrientable::Leave, NonOrientable::Force];

fn surface<const D: usize>(points: Vec<[f64; D]>) -> Surface<D> {
    Surface::new(Cloud::new(points), Definition::new()).unwrap()
}

/// With normals of random signs.
fn with_axes<const D: usize>(shape: &Samples<D>) -> Surface<D> {
    let mut random = Random::new(99);
    let axes: Vec<_> =
        shape.normals.iter().map(|n| if random.uniform() < 0.5 { n.map(|c| -c) } else { *n }).collect();
    let cloud = Cloud::new(shape.points.clone()).with_normals(axes).unwrap();
    Surface::new(cloud, Definition::new()).unwrap()
}

fn propagated<const D: usize>(surface: &Surface<D>, source: NormalSource) -> Orientation<D> {
    surface.orient(source, &Orient::Propagated(NonOrientable::Leave)).unwrap()
}

/// Oriented samples that face the side of the truth, and those that face the other.
fn sides<const D: usize>(found: &Orientation<D>, truth: &[[f64; D]]) -> (usize, usize) {
    let cosines: Vec<f64> = found.normal.iter().zip(truth).map(|(n, t)| dot(*n, *t)).collect();
    let count = |side: f64| cosines.iter().filter(|&&c| c * side > 0.0).count();
    (count(1.0), count(-1.0))
}

/// Nobody is flipped after one sign for all, and nearly everybody has a side.
#[track_caller]
fn assert_one_side<const D: usize>(found: &Orientation<D>, truth: &[[f64; D]], what: &str) {
    let (right, wrong) = sides(found, truth);
    println!("{what}: {right} right, {wrong} wrong, {:?}", found.components.first());
    assert_eq!(right.min(wrong), 0, "{what}: {right} against {wrong}");
    assert!(right.max(wrong) as f64 > 0.999 * truth.len() as f64, "{what}: {right}, {wrong}");
    assert_eq!(right + wrong, found.oriented, "{what}");
    assert!(found.components.iter().all(|c| c.verdict == Verdict::Orientable), "{what}");
}

fn noisy<const D: usize>(shape: Samples<D>) -> Samples<D> {
    let spacing = spacing(&Cloud::new(shape.points.clone()), &Run::new()).unwrap();
    shape.with_noise(0.5 * spacing, 5)
}

#[test]
fn torus_and_sphere_with_noise_of_half_a_spacing() {
    for (name, shape) in
        [("torus", samples::torus(1.0, 0.4, 100_000, 1)), ("sphere", samples::sphere(1.0, 100_000, 2))]
    {
        let shape = noisy(shape);
        let found = propagated(&surface(shape.points.clone()), NormalSource::Surface);
        assert_one_side(&found, &shape.normals, name);
        // And that side is outward.
        assert_eq!(sides(&found, &shape.normals).1, 0, "{name}");
        // About half of the arbitrary signs had to be reversed.
        assert!(found.reversed > 20_000 && found.reversed < 80_000, "{name}: {}", found.reversed);
    }
}

#[test]
fn curves() {
    let ellipse = noisy(samples::ellipse(1.0, 0.5, 3000, 3));
    let found = propagated(&surface(ellipse.points.clone()), NormalSource::Surface);
    assert_one_side(&found, &ellipse.normals, "ellipse");
    assert_eq!(sides(&found, &ellipse.normals).1, 0);
}

#[test]
fn kitten() {
    let Some(data) = common::shared("data") else { return };
    let text = std::fs::read_to_string(data.join("cloud/cgal_kitten.xyz")).unwrap();
    let mut shape = Samples::<3>::default();
    for line in text.lines() {
        let row: Vec<f64> = line.split_whitespace().map(|w| w.parse().unwrap()).collect();
        shape.points.push([row[0], row[1], row[2]]);
        shape.normals.push([row[3], row[4], row[5]]);
    }
    assert_eq!(shape.points.len(), 5210);
    let given = propagated(&with_axes(&shape), NormalSource::Given);
    assert_one_side(&given, &shape.normals, "kitten, given normals");
    let computed = propagated(&surface(shape.points.clone()), NormalSource::Surface);
    assert_one_side(&computed, &shape.normals, "kitten, computed normals");
}

#[test]
fn one_percent_of_wrong_normals_flips_nobody_else() {
    for (name, mut shape) in [
        ("torus", noisy(samples::torus(1.0, 0.4, 100_000, 1))),
        ("sphere", noisy(samples::sphere(1.0, 100_000, 2))),
    ] {
        let mut random = Random::new(7);
        let wrong: Vec<bool> = shape.points.iter().map(|_| random.uniform() < 0.01).collect();
        let truth = shape.normals.clone();
        let directions = samples::sphere(1.0, truth.len(), 8).points;
        for i in (0..truth.len()).filter(|&i| wrong[i]) {
            shape.normals[i] = directions[i];
        }
        let found = propagated(&with_axes(&shape), NormalSource::Given);
        assert!(found.doubtful > 50, "{name}: {} doubtful edges", found.doubtful);
        assert_eq!(found.oriented, truth.len());
        let (right, against) = (0..truth.len()).filter(|&i| !wrong[i]).fold((0, 0), |(right, against), i| {
            if dot(found.normal[i], truth[i]) > 0.0 { (right + 1, against) } else { (right, against + 1) }
        });
        println!("{name}: {right} right, {against} wrong, {:?}", found.components[0]);
        assert_eq!(right.min(against), 0, "{name}: {right} against {against}");
        assert_eq!(found.components[0].verdict, Verdict::Orientable, "{name}");
    }
}

#[test]
fn surfaces_without_sides_are_left_alone_unless_forced() {
    let strip = samples::moebius(1.0, 0.35, 20_000, 1);
    let bottle = samples::klein(1.5, 0.6, 40_000, 2);
    for (name, shape) in [("strip", &strip), ("noisy strip", &noisy(strip.clone())), ("bottle", &bottle)] {
        for source in [NormalSource::Given, NormalSource::Surface] {
            let surface = with_axes(shape);
            let [left, forced] =
                PROPAGATED.map(|how| surface.orient(source, &Orient::Propagated(how)).unwrap());
            println!("{name}: {:?}", left.components[0]);
            assert_eq!(left.components[0].verdict, Verdict::NonOrientable, "{name}");
            assert!(left.components[0].odd_edges > 100, "{name}");
            let largest = left.components[0].samples;
            assert!(largest > shape.points.len() * 9 / 10, "{name}: {largest}");
            assert_eq!(left.oriented + largest, forced.oriented, "{name}");
            for i in (0..shape.points.len()).filter(|&i| left.component[i] == 0) {
                assert!(left.normal[i][0].is_nan() && left.status[i] == Status::Degenerate, "{name}");
                assert!(!forced.normal[i][0].is_nan() && forced.status[i] == Status::Ok, "{name}");
            }
            assert_eq!(forced.components[0].verdict, Verdict::NonOrientable, "{name}");
        }
    }
}

#[test]
fn a_strip_cut_across_has_sides() {
    let whole = samples::moebius(1.0, 0.35, 20_000, 1);
    let keep: Vec<usize> = (0..whole.points.len())
        .filter(|&i| whole.points[i][1].abs() > 0.15 || whole.points[i][0] < 0.0)
        .collect();
    let cut = Samples {
        points: keep.iter().map(|&i| whole.points[i]).collect(),
        normals: keep.iter().map(|&i| whole.normals[i]).collect(),
    };
    let found = propagated(&surface(cut.points.clone()), NormalSource::Surface);
    assert_one_side(&found, &cut.normals, "cut strip");
}

#[test]
fn each_component_faces_outward() {
    let (torus, ball) = (samples::torus(1.0, 0.4, 20_000, 1), samples::sphere(0.4, 5000, 2));
    let mut both = torus.clone();
    for (point, normal) in ball.points.iter().zip(&ball.normals) {
        both.points.push(add(*point, [3.0, 0.0, 0.0]));
        both.normals.push(*normal);
    }
    let found = propagated(&surface(both.points.clone()), NormalSource::Surface);
    assert_eq!(found.components.iter().map(|c| c.samples).collect::<Vec<_>>(), [20_000, 5000]);
    assert_eq!(sides(&found, &both.normals), (25_000, 0));
    for i in 0..25_000 {
        assert_eq!(found.component[i], u32::from(i >= 20_000));
    }
    let reversed: usize = found.components.iter().map(|c| c.reversed).sum();
    assert!(found.components.iter().all(|c| c.reversed > 0) && found.reversed == reversed);
}

#[test]
fn sharp_edges_and_thin_walls_with_given_normals() {
    // A thin board: every edge is a right angle, and its two sides are less than a support apart.
    let mut random = Random::new(3);
    let mut board = Samples::<3>::default();
    let half = [1.0, 0.7, 0.0125];
    for face in 0..6 {
        let (axis, side) = (face / 2, [1.0, -1.0][face % 2]);
        let area = half[(axis + 1) % 3] * half[(axis + 2) % 3];
        for _ in 0..(40_000.0 * area) as usize {
            let mut point = [0; 3].map(|_| 2.0 * random.uniform() - 1.0);
            point[axis] = side;
            let mut normal = [0.0; 3];
            normal[axis] = side;
            board.points.push(std::array::from_fn(|k| half[k] * point[k]));
            board.normals.push(normal);
        }
    }
    let found = propagated(&with_axes(&board), NormalSource::Given);
    assert_one_side(&found, &board.normals, "board");
    assert_eq!(sides(&found, &board.normals).1, 0, "the board faces outward");
    assert!(found.components[0].doubtful_edges >= 5, "{:?}", found.components[0]);
}

#[test]
fn towards_along_sensors_and_trajectory() {
    let ball = samples::sphere(1.0, 4000, 4);
    let surface = surface(ball.points.clone());
    let orient = |how: Orient<'_, 3>| surface.orient(NormalSource::Surface, &how).unwrap();
    let inward = orient(Orient::Towards([0.1, 0.2, -0.1]));
    assert_eq!(sides(&inward, &ball.normals), (0, 4000));
    assert_eq!((inward.oriented, inward.doubtful, inward.components.len()), (4000, 0, 0));

    let up = orient(Orient::Along([0.0, 0.0, 1e-200]));
    assert!(up.normal.iter().all(|n| n[2] >= 0.0));
    let grazing = up.normal.iter().filter(|n| n[2] < 0.1).count();
    assert!(up.doubtful == grazing && grazing > 200, "{} of {grazing}", up.doubtful);

    let outside: Vec<[f64; 3]> = ball.points.iter().map(|p| scale(*p, 3.0)).collect();
    assert_eq!(sides(&orient(Orient::Sensors(&outside)), &ball.normals), (4000, 0));
    let mut partly = outside;
    partly[7] = [f64::NAN; 3];
    let found = orient(Orient::Sensors(&partly));
    assert_eq!(sides(&found, &ball.normals), (3999, 0));
    assert!(found.status[7] == Status::Degenerate && found.normal[7][0].is_nan() && found.oriented == 3999);

    // The sensor flies around the ball; a sample is measured when the sensor is at its longitude.
    let times: Vec<f64> = ball.points.iter().map(|p| p[1].atan2(p[0])).collect();
    let path: Vec<(f64, [f64; 3])> = (-40..=40)
        .map(|i| {
            let time = std::f64::consts::PI * f64::from(i) / 40.0;
            (time, [30.0 * time.cos(), 30.0 * time.sin(), 0.0])
        })
        .collect();
    let seen = orient(Orient::Trajectory { times: &times, path: &path });
    // From 30 radii away all but the very poles are seen from outside.
    let near_poles = ball.points.iter().filter(|p| p[0].hypot(p[1]) < 0.1).count();
    let (right, wrong) = sides(&seen, &ball.normals);
    assert!(right + wrong == 4000 && wrong <= near_poles, "{wrong} wrong, {near_poles} near the poles");
    let half = orient(Orient::Trajectory { times: &times, path: &path[40..] });
    let late = times.iter().filter(|t| **t >= 0.0).count();
    assert_eq!((half.oriented, half.reversed > 0), (late, true));
    for (i, time) in times.iter().enumerate() {
        assert_eq!(half.status[i] == Status::Outside, *time < 0.0);
        assert_eq!(half.normal[i][0].is_nan(), *time < 0.0);
    }
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    let surface = surface(samples::sphere(1.0, 500, 4).points);
    let refuse = |how: Orient<'_, 3>| surface.orient(NormalSource::Surface, &how).unwrap_err();
    assert_eq!(refuse(Orient::Towards([0.0, f64::NAN, 0.0])), OrientError::NotFinite("viewpoint"));
    assert_eq!(refuse(Orient::Along([0.0; 3])), OrientError::NotFinite("axis"));
    let short = refuse(Orient::Sensors(&[[0.0; 3]; 3]));
    assert_eq!(short.to_string(), "sensor positions: 3 values for 500 samples");
    let times = [0.5; 500];
    assert_eq!(refuse(Orient::Trajectory { times: &times, path: &[] }), OrientError::NoPath);
    let back = [(0.0, [0.0; 3]), (2.0, [0.0; 3]), (1.0, [0.0; 3])];
    assert_eq!(refuse(Orient::Trajectory { times: &times, path: &back }), OrientError::Path(2));
    let propagated = Orient::Propagated(NonOrientable::Leave);
    assert_eq!(surface.orient(NormalSource::Given, &propagated).unwrap_err(), OrientError::NoNormals);
    let stop = std::sync::atomic::AtomicBool::new(true);
    let cancelled = surface.with(&Run::new().cancel(&stop)).orient(NormalSource::Surface, &propagated);
    assert!(matches!(cancelled, Err(OrientError::Cancelled(_))));
}

#[test]
fn absent_samples_and_normals_are_passed_over() {
    let ball = samples::sphere(1.0, 3000, 5);
    let mut points = ball.points.clone();
    // One without a place, one alone, some all in one point, some along a line.
    points.extend([[f64::NAN; 3], [40.0, 0.0, 0.0]]);
    points.extend([[0.0, 50.0, 0.0]; 20]);
    points.extend((0..20).map(|i| [0.0, 0.01 * f64::from(i), -60.0]));
    let found = propagated(&surface(points.clone()), NormalSource::Surface);
    assert_eq!(sides(&found, &ball.normals), (3000, 0));
    assert_eq!((found.oriented, found.components.len(), found.normal.len()), (3000, 1, 3042));
    for i in 3000..3042 {
        let expected = if i == 3000 { Status::Invalid } else { Status::Degenerate };
        assert!(found.status[i] == expected && found.normal[i][0].is_nan() && found.component[i] == u32::MAX);
    }

    // Given normals serve where none can be computed; where they are absent themselves there is no sign.
    let mut normals = ball.normals.clone();
    normals.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    normals.extend((0..20).map(|i| [0.0, 0.0, [1.0, -1.0][i % 2]]));
    normals.extend([[f64::NAN; 3]; 20]);
    normals[11] = [0.0; 3];
    let cloud = Cloud::new(points).with_normals(normals).unwrap();
    let found = propagated(&Surface::new(cloud, Definition::new()).unwrap(), NormalSource::Given);
    let counts: Vec<usize> = found.components.iter().map(|c| c.samples).collect();
    assert_eq!(counts, [2999, 20, 1]);
    assert_eq!((found.status[11], found.status[3000]), (Status::Degenerate, Status::Invalid));
    assert_eq!(found.normal[3001], [0.0, 0.0, 1.0], "a lone sample faces up");
    assert!(found.normal[3002..3022].iter().all(|n| n[2] == 1.0), "so do samples in one place");
}

/// Everything as bits, in the order of the samples.
fn bits<const D: usize>(found: &Orientation<D>) -> Vec<([u64; D], Status, u32)> {
    (0..found.normal.len())
        .map(|i| (found.normal[i].map(f64::to_bits), found.status[i], found.component[i]))
        .collect()
}

fn check_bits<const D: usize>(shape: &Samples<D>, definition: Definition, what: &str) {
    let build = |order: &[usize]| {
        let pick = |column: &[[f64; D]]| order.iter().map(|&i| column[i]).collect::<Vec<_>>();
        let cloud = Cloud::new(pick(&shape.points)).with_normals(pick(&shape.normals)).unwrap();
        Surface::new(cloud, definition).unwrap()
    };
    let straight: Vec<usize> = (0..shape.points.len()).collect();
    let order = shuffled(shape.points.len(), 12);
    let (surface, mixed) = (build(&straight), build(&order));
    for how in PROPAGATED.map(Orient::Propagated) {
        for source in [NormalSource::Surface, NormalSource::Given] {
            let expected = surface.orient(source, &how).unwrap();
            assert!(expected.oriented > 0 || how == Orient::Propagated(NonOrientable::Leave), "{what}");
            for threads in [1, 2, 4] {
                let run = Run::new().threads(threads);
                let found = surface.with(&run).orient(source, &how).unwrap();
                assert!(bits(&found) == bits(&expected), "{what}, {threads} threads");
                assert_eq!(found.components, expected.components);
            }
            let found = mixed.orient(source, &how).unwrap();
            let (found, expected) = (bits(&found), bits(&expected));
            assert!(order.iter().zip(&found).all(|(&i, row)| *row == expected[i]), "{what}, shuffled");
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads_or_on_the_order_of_the_samples() {
    // Equal weights everywhere on the ball; repeats, so that only content can order some samples; trees by chance on noise.
    let mut ball = fibonacci_sphere(3000);
    for i in (0..3000).step_by(10) {
        ball.points.push(ball.points[i]);
        ball.normals.push(ball.normals[(i + 1) % 3000]);
    }
    let torus = samples::torus(1.0, 0.4, 4000, 1).with_noise(0.05, 2);
    let per_sample = Support::AutoPerSample { effective_neighbours: 12.0 };
    for definition in [
        Definition::new(),
        Definition::new().with_support(per_sample),
        Definition::new().with_precision(Precision::Single),
    ] {
        check_bits(&ball, definition, "ball");
        check_bits(&torus, definition, "torus");
        check_bits(&samples::moebius(1.0, 0.35, 4000, 3), definition, "strip");
    }
    check_bits(&samples::ellipse(1.0, 0.4, 800, 4).with_noise(0.01, 5), Definition::new(), "ellipse");
}

#[test]
fn large_coordinates_change_nothing() {
    let shape = noisy(samples::torus(1.0, 0.4, 20_000, 1));
    let far: Vec<_> = shape.points.iter().map(|p| add(*p, [4.5e5, 5.3e6, 120.0])).collect();
    let found = propagated(&surface(far), NormalSource::Surface);
    assert_eq!(sides(&found, &shape.normals), (20_000, 0));
}

#[test]
fn oriented_samples_serve_averaged_normals_and_signed_distances() {
    let shape = noisy(samples::torus(1.0, 0.4, 20_000, 1));
    let unsigned = surface(shape.points.clone());
    assert_eq!(unsigned.sign(), Sign::Arbitrary);
    let found = propagated(&unsigned, NormalSource::Surface);
    let cloud = Cloud::new(shape.points.clone()).with_normals(found.normal).unwrap();
    for field in [NormalField::AveragedNormals, NormalField::CentredCovariance] {
        let signed = Surface::new(cloud.clone(), Definition::new().with_field(field)).unwrap();
        assert_eq!(signed.sign(), Sign::Given);
        let feet = signed.project(&[[1.42, 0.0, 0.0], [1.38, 0.0, 0.0]], &Project::new());
        assert!((feet.distance[0] - 0.02).abs() < 0.005, "{field}: {:?}", feet.distance);
        assert!((feet.distance[1] + 0.02).abs() < 0.005, "{field}: {:?}", feet.distance);
    }
}
