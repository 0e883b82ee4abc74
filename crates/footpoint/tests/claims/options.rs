//! Every option matters, and does what it says.

use crate::common::{
    self, Columns, FIELDS, FIRST_ORDER, OPERATORS, Variant, WEIGHTS, length, near_samples, sub,
};
use footpoint::samples;
use footpoint::{
    Acceptance, Cancelled, Cast, Cloud, Definition, Error, Evaluations, Instructions, Noise, NormalField,
    Operator, Precision, Project, Queries, Ray, Run, Status, Support, Surface, Want, Weight,
};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

fn torus(variant: Variant) -> Columns<3> {
    Columns::new(&samples::torus(1.0, 0.4, 1500, 1).with_noise(0.01, 2), 0.3, variant)
}

fn starts(columns: &Columns<3>) -> Vec<[f64; 3]> {
    near_samples(&columns.points, 300, 0.15 * columns.radius, 3)
}

/// The largest difference of f, in h.
fn difference(a: &Surface<3>, b: &Surface<3>, at: &[[f64; 3]]) -> f64 {
    let (a, b) = (a.evaluate(at, Want::VALUE | Want::SUPPORT), b.evaluate(at, Want::VALUE));
    common::largest((0..at.len()).map(|i| (a.value[i].abs() - b.value[i].abs()).abs() / a.support[i]))
}

#[test]
fn single_precision_is_near_and_not_the_same() {
    for variant in [Variant::Uniform, Variant::PerSample] {
        let columns = torus(variant);
        let at = starts(&columns);
        let double = columns.surface(Definition::new());
        let single = columns.surface(Definition::new().with_precision(Precision::Single));
        assert_eq!(single.definition().precision(), Precision::Single);
        let off = difference(&double, &single, &at);
        assert!(off > 1e-12 && off < 5e-7, "{off:e}");
        // Samples as queries are where they were given, not on the lattice.
        let how = Project::new();
        let (own, given) = (single.project(Queries::Samples, &how), single.project(&columns.points, &how));
        assert_eq!(own.point, given.point);
        let exact = double.project(&columns.points, &how);
        let ok: Vec<usize> =
            (0..at.len()).filter(|&i| exact.status[i].is_ok() && own.status[i].is_ok()).collect();
        let apart =
            common::median(ok.iter().map(|&i| length(sub(own.point[i], exact.point[i])) / columns.radius));
        assert!(ok.len() > at.len() * 9 / 10 && apart < 2e-6, "{} {apart:e}", ok.len());
    }
}

#[test]
fn fewer_instructions_give_the_same_answers() {
    let columns = torus(Variant::Uniform);
    let surface = columns.surface(Definition::new());
    let at = starts(&columns);
    let with = |instructions| {
        let run = Run::new().instructions(instructions);
        surface.with(&run).evaluate(&at, Want::VALUE).unwrap().value
    };
    let best = with(Instructions::Best);
    let baseline = with(Instructions::Baseline);
    let apart = common::largest((0..at.len()).map(|i| (best[i] - baseline[i]).abs() / columns.radius));
    assert!(apart < 1e-13, "{apart:e}");
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("fma") {
        // It rounds twice where the others round once: the option does something.
        assert!(best != baseline);
        assert!(best == with(Instructions::Avx2));
    }
}

#[test]
fn columns_that_exist_are_filled_again() {
    let surface = torus(Variant::Uniform).surface(Definition::new());
    let at = starts(&torus(Variant::Uniform));
    let run = Run::new();
    let mut columns = surface.evaluate(Queries::Samples, Want::ALL);
    let memory = columns.gradient.as_ptr();
    let want = Want::VALUE | Want::GRADIENT;
    surface.with(&run).evaluate_into(&at, want, &mut columns).unwrap();
    assert_eq!(columns, surface.evaluate(&at, want));
    assert_eq!(columns.gradient.as_ptr(), memory);
}

#[test]
fn weights_fields_factors_and_supports_change_f() {
    let columns = torus(Variant::Uniform);
    let at = starts(&columns);
    let surface = columns.surface(Definition::new());
    let with = |definition| columns.surface(definition);
    for (weight, _) in WEIGHTS.into_iter().filter(|(w, _)| *w != Weight::Poly3) {
        assert!(difference(&surface, &with(Definition::new().with_weight(weight)), &at) > 1e-3, "{weight:?}");
    }
    for field in FIELDS.into_iter().filter(|f| *f != NormalField::CentredCovariance) {
        assert!(difference(&surface, &with(Definition::new().with_field(field)), &at) > 1e-3, "{field:?}");
    }
    for variant in [Variant::PerSample, Variant::Factors] {
        let other = torus(variant).surface(Definition::new());
        assert!(difference(&surface, &other, &at) > 1e-3, "{variant:?}");
    }
    // A column of supports is there to be asked for: another rule ignores it.
    let ignored = Surface::new(torus(Variant::PerSample).cloud(), *surface.definition()).unwrap();
    assert_eq!(difference(&surface, &ignored, &at), 0.0);
    let gaussian = |cut| Weight::Gaussian { cut };
    let at_cut =
        |cut| with(Definition::new().with_weight(gaussian(cut)).with_support(Support::Uniform(0.15)));
    let differences: Vec<f64> =
        [1e-1, 1e-3, 1e-6, 1e-9].iter().map(|&cut| difference(&at_cut(cut), &at_cut(1e-15), &at)).collect();
    println!("cut against 1e-15: {differences:?}");
    assert!(differences[0] > 1e-2 && differences[1] < differences[0] && differences[2] < differences[1]);
    assert!(differences[3] < 1e-6);
}

#[test]
fn the_domain_ratio_puts_points_outside() {
    let points: Vec<[f64; 3]> = samples::plane(1.0, 2500, 1).points.into_iter().collect();
    let nearest = |x: [f64; 3]| points.iter().map(|&p| length(sub(p, x))).fold(f64::MAX, f64::min);
    let queries: Vec<[f64; 3]> =
        (0..100).map(|i| [0.003 * f64::from(i), 0.1, 0.003 * f64::from(i)]).collect();
    for ratio in [0.25, 0.5, 0.8, 1.0] {
        for weight in [Weight::Poly3, Weight::Gaussian { cut: 1e-4 }] {
            let h = 0.25 / weight.reach();
            let definition = Definition::new()
                .with_support(Support::Uniform(h))
                .with_weight(weight)
                .with_domain_ratio(ratio);
            let surface = Surface::new(Cloud::new(points.clone()), definition).unwrap();
            let e = surface.evaluate(&queries, Want::VALUE);
            for (i, &x) in queries.iter().enumerate() {
                let inside = nearest(x) < ratio * 0.25;
                assert_eq!(e.status[i] == Status::Outside, !inside, "{ratio} {weight:?} {x:?}");
            }
        }
    }
}

#[test]
fn each_number_of_the_acceptance_rule_has_its_status() {
    let columns = torus(Variant::Uniform);
    let at = starts(&columns);
    let statuses = |acceptance| {
        let surface = columns.surface(Definition::new().with_acceptance(acceptance));
        surface.project(&at, &Project::default()).status
    };
    let usual = statuses(Acceptance::default());
    assert!(usual.iter().filter(|s| s.is_ok()).count() > 280);
    let strict = [
        (Acceptance { alignment: 10.0, ..Acceptance::default() }, Status::Singular),
        (Acceptance { gap: 1.5, ..Acceptance::default() }, Status::Degenerate),
        (Acceptance { boundary: Some(0.0), ..Acceptance::default() }, Status::Boundary),
    ];
    for (acceptance, expected) in strict {
        let found = statuses(acceptance);
        for i in (0..at.len()).filter(|&i| usual[i].is_ok()) {
            assert_eq!(found[i], expected, "{acceptance:?}");
        }
    }
    // The number that decides is the one that is measured.
    let surface = columns.surface(Definition::new());
    let p = surface.project(&at, &Project::new().with_tolerance(1e-12));
    let e = surface.evaluate(&p.point, Want::ALL);
    for i in (0..at.len()).filter(|&i| p.status[i].is_ok()).take(50) {
        let alignment = common::dot(e.gradient[i], e.frame_normal[i]);
        let aside = length(sub(e.average[i], p.point[i])) / e.support[i];
        for (factor, accepted) in [(1.0 - 1e-6, true), (1.0 + 1e-6, false)] {
            let rules = [
                Acceptance { alignment: factor * alignment, gap: 0.0, boundary: Some(1.0) },
                Acceptance { alignment: 0.0, gap: factor * e.gap[i], boundary: Some(1.0) },
                Acceptance { alignment: 0.0, gap: 0.0, boundary: Some(aside / factor) },
            ];
            for rule in rules {
                let surface = columns.surface(Definition::new().with_acceptance(rule));
                let status = surface.project(&[at[i]], &Project::new().with_tolerance(1e-12)).status[0];
                assert_eq!(status.is_ok(), accepted, "{rule:?}: {status}");
            }
        }
    }
}

#[test]
fn the_usual_boundary_limits_are_those_of_the_specification() {
    let limits = |weight: Weight, field: NormalField| {
        let definition = Definition::new().with_weight(weight).with_field(field);
        [definition.boundary_limit::<2>(), definition.boundary_limit::<3>()]
    };
    for (weight, m) in [(Weight::Poly2, 2.0_f64), (Weight::Poly3, 3.0), (Weight::Poly4, 4.0)] {
        let about_x = [1.0 / (2.0 * m + 4.0).sqrt(), 1.0 / (2.0 * m + 5.0).sqrt()];
        assert_eq!(limits(weight, NormalField::Covariance), about_x);
        assert_eq!(limits(weight, NormalField::AveragedAxes), [0.5; 2]);
    }
    assert_eq!(limits(Weight::Wendland, NormalField::Covariance), [0.26; 2]);
    assert_eq!(limits(Weight::Wendland, NormalField::CentredCovariance), [0.5; 2]);
    assert_eq!(limits(Weight::GAUSSIAN, NormalField::Covariance), [0.5_f64.sqrt(); 2]);
    assert_eq!(limits(Weight::GAUSSIAN, NormalField::AveragedNormals), [1.1; 2]);
    let own =
        Definition::new().with_acceptance(Acceptance { boundary: Some(0.123), ..Acceptance::default() });
    assert_eq!(own.boundary_limit::<3>(), 0.123);
}

#[test]
fn a_tighter_tolerance_costs_evaluations_and_leaves_less() {
    let columns = torus(Variant::PerSample);
    let at = starts(&columns);
    let surface = columns.surface(Definition::new());
    for operator in OPERATORS {
        let (mut spent, mut left) = (0.0, f64::MAX);
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-9, 1e-12] {
            let how = Project::new().with_operator(operator).with_tolerance(tolerance);
            let p = surface.project(&at, &how);
            let ok: Vec<usize> = (0..at.len()).filter(|&i| p.status[i].is_ok()).collect();
            let support = surface.evaluate(&p.point, Want::SUPPORT).support;
            for &i in &ok {
                assert!(p.residual[i] <= tolerance * support[i] * (1.0 + 1e-3), "{operator:?} {tolerance:e}");
            }
            let mean = ok.iter().map(|&i| f64::from(p.evaluations[i])).sum::<f64>() / ok.len() as f64;
            let residual = common::median(ok.iter().map(|&i| p.residual[i]));
            println!("{operator:?} {tolerance:e}: {mean:.2} evaluations, residual {residual:.1e}");
            assert!(mean > spent && residual < left);
            (spent, left) = (mean, residual);
        }
    }
    for most in [1, 2, 5] {
        let p = surface.project(&at, &Project::new().with_tolerance(1e-12).with_most_evaluations(most));
        assert!(p.evaluations.iter().all(|&e| e <= most));
        assert!(p.status.contains(&Status::NotConverged));
    }
    let never = surface.project(&at[..9], &Project::new().with_tolerance(f64::NAN).with_most_evaluations(7));
    assert!(never.status.iter().zip(&never.evaluations).all(|(s, &e)| s.is_ok() || e <= 7));
}

/// The lengths of all columns.
fn lengths(e: &Evaluations<3>) -> [usize; 17] {
    [
        e.value.len(),
        e.average.len(),
        e.frame_normal.len(),
        e.gradient.len(),
        e.surface_normal.len(),
        e.gap.len(),
        e.neighbours.len(),
        e.effective_neighbours.len(),
        e.weight_sum.len(),
        e.eigenvalues.len(),
        e.squared_sensitivity.len(),
        e.support.len(),
        e.eccentricity.len(),
        e.hessian.len(),
        e.curvature.directions.len(),
        e.sigma.len(),
        e.degree.len(),
    ]
}

#[test]
fn columns_that_are_not_wanted_are_empty_and_the_others_do_not_change() {
    let columns = torus(Variant::PerSampleAndFactors);
    let cloud = columns.cloud().with_noise(Noise::Uniform(0.01)).unwrap();
    let surface = Surface::new(cloud, Definition::new().with_support(columns.support())).unwrap();
    let at = starts(&columns);
    let all = surface.evaluate(&at, Want::ALL);
    assert_eq!(lengths(&all), [at.len(); 17]);
    let others = [Want::HESSIAN, Want::CURVATURE, Want::SIGMA, Want::DEGREE];
    let each: Vec<Want> = FIRST_ORDER.into_iter().chain(others).collect();
    assert_eq!(each.len(), 17);
    for (k, want) in each.iter().copied().enumerate() {
        let e = surface.evaluate(&at, want);
        let expected: [usize; 17] = std::array::from_fn(|j| if j == k { at.len() } else { 0 });
        assert_eq!(lengths(&e), expected);
        let rest = each.iter().copied().filter(|w| *w != want).reduce(|a, b| a | b).unwrap();
        assert!(Want::ALL.contains(want) && !rest.contains(want) && rest | want == Want::ALL);
        // One column alone, and the others beside it, make up the whole again.
        let mut joined = surface.evaluate(&at, rest);
        macro_rules! take {
            ($($column:ident)*) => { $(if joined.$column.is_empty() { joined.$column = e.$column; })* };
        }
        take!(value average frame_normal gradient surface_normal gap neighbours effective_neighbours weight_sum
              eigenvalues squared_sensitivity support eccentricity hessian sigma degree);
        if joined.curvature.mean.is_empty() {
            joined.curvature = e.curvature;
        }
        assert!(joined == all, "column {k}");
    }
}

#[test]
fn the_trace_shows_plain_iterates_that_end_where_the_projection_does() {
    let columns = torus(Variant::Uniform);
    let surface = columns.surface(Definition::new());
    let at = starts(&columns);
    for operator in OPERATORS {
        let how = Project::new().with_operator(operator).with_tolerance(1e-9);
        let p = surface.project(&at, &how);
        let (mut falls, mut steps) = (0, 0);
        let (mut plain, mut mixed, mut elsewhere) = (0, 0, 0);
        for (i, &start) in at.iter().enumerate() {
            let trace = surface.trace(start, &how);
            // What plain iteration solves the projection solves.
            assert!(!trace.status.is_ok() || p.status[i].is_ok());
            assert_eq!(trace.values.len(), trace.iterates.len());
            let back = length(sub(trace.iterates[0], start));
            assert!(back <= 1e-15, "the first iterate is the query, but for rounding: {back:e}");
            if trace.status.is_ok() {
                plain += trace.iterates.len();
                mixed += p.evaluations[i] as usize;
                let apart = length(sub(*trace.iterates.last().unwrap(), p.point[i]));
                elsewhere += usize::from(apart > 1e-7 * columns.radius);
                let e = surface.evaluate(&trace.iterates, Want::VALUE);
                for (f, value) in trace.values.iter().zip(&e.value) {
                    assert!((f.abs() - value.abs()).abs() <= 1e-13 * columns.radius);
                }
                for pair in trace.values.windows(2).filter(|p| p[1].abs() > 1e-11) {
                    steps += 1;
                    falls += usize::from(pair[1].abs() < pair[0].abs());
                }
                // The sign is carried: no value on the way jumps from one side to the other.
                let farthest = trace.values[0].abs();
                assert!(trace.values.iter().all(|v| v.abs() <= 1.5 * farthest + 0.1 * columns.radius));
            }
        }
        assert!(steps > 1000, "{operator:?}: {steps}");
        println!("{operator:?}: |f| falls in {falls} of {steps} steps");
        println!("{operator:?}: {plain} evaluations, mixed {mixed}; {elsewhere} ended elsewhere");
        // Another zero is rare, and the way there is shorter, but that of *basic* must be its own.
        assert!(elsewhere * 500 <= at.len(), "{elsewhere} of {}", at.len());
        assert!(if operator == Operator::Basic { mixed == plain } else { 4 * mixed < 3 * plain });
        assert!(falls as f64 > 0.95 * steps as f64, "{operator:?}: {falls} of {steps}");
    }
    let nowhere = surface.trace([f64::NAN; 3], &Project::default());
    assert!(nowhere.status == Status::Invalid && nowhere.iterates.is_empty());
    assert_eq!(surface.trace([9.0; 3], &Project::default()).status, Status::Outside);
}

#[test]
fn progress_reaches_the_total_and_cancelling_ends_the_work() {
    let columns = torus(Variant::Uniform);
    let surface = columns.surface(Definition::new());
    let at = near_samples(&columns.points, 5000, 0.05, 3);
    for threads in [1, 3] {
        let (last, total) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let report = |p: footpoint::Progress| {
            assert!(p.done <= p.total);
            last.fetch_max(p.done, Ordering::Relaxed);
            total.store(p.total, Ordering::Relaxed);
        };
        let run = Run::new().threads(threads).progress(&report);
        let done = || (last.swap(0, Ordering::Relaxed), total.load(Ordering::Relaxed));
        surface.with(&run).evaluate(&at, Want::ALL).unwrap();
        assert_eq!(done(), (5000, 5000));
        surface.with(&run).project(&at, &Project::default()).unwrap();
        assert_eq!(done(), (5000, 5000));

        let flag = AtomicBool::new(true);
        let run = Run::new().threads(threads).cancel(&flag);
        assert_eq!(surface.with(&run).evaluate(&at, Want::ALL), Err(Cancelled));
        assert_eq!(surface.with(&run).project(&at, &Project::default()), Err(Cancelled));
        // From within, after the first report.
        flag.store(false, Ordering::Relaxed);
        let stop = |_| flag.store(true, Ordering::Relaxed);
        let run = run.progress(&stop);
        assert_eq!(surface.with(&run).project(&at, &Project::default()), Err(Cancelled));
        flag.store(false, Ordering::Relaxed);
        let run = Run::new().cancel(&flag);
        assert!(surface.with(&run).evaluate(&at, Want::VALUE).is_ok());
    }
}

#[test]
fn wide_supports_do_not_delay_the_end() {
    // Every sample is a neighbour of every query, and all queries are one group: seconds for each of these calls.
    let points = samples::sphere(1.0, 300_000, 1).points;
    let definition = Definition::new().with_support(Support::Uniform(3.0));
    let surface = Surface::new(Cloud::new(points.clone()), definition).unwrap();
    let at = &points[..500];
    let flag = AtomicBool::new(false);
    let run = Run::new().cancel(&flag);
    let ended = |call: &(dyn Fn() -> Result<(), Cancelled> + Sync)| {
        flag.store(false, Ordering::Relaxed);
        let begun = Instant::now();
        thread::scope(|scope| {
            scope.spawn(|| {
                thread::sleep(Duration::from_millis(100));
                flag.store(true, Ordering::Relaxed);
            });
            assert_eq!(call(), Err(Cancelled));
        });
        begun.elapsed()
    };
    let levin = Project::new().with_operator(Operator::Levin { degree: Some(2) });
    let rays: Vec<Ray<3>> =
        at.iter().map(|p| Ray { origin: p.map(|c| 2.0 * c), direction: p.map(|c| -c) }).collect();
    let all = [
        ended(&|| surface.with(&run).evaluate(at, Want::ALL).map(drop)),
        ended(&|| surface.with(&run).project(at, &Project::new()).map(drop)),
        ended(&|| surface.with(&run).project(at, &levin).map(drop)),
        ended(&|| surface.with(&run).cast(&rays, &Cast::new()).map(drop)),
    ];
    assert!(all.iter().all(|&late| late < Duration::from_secs(1)), "{all:?}");
}

#[test]
fn making_a_surface_can_be_cancelled() {
    let flag = AtomicBool::new(true);
    let run = Run::new().cancel(&flag);
    let error = Surface::build(torus(Variant::Uniform).cloud(), Definition::new(), &run).unwrap_err();
    assert!(matches!(error, Error::Cancelled(_)), "{error:?}");
    assert_eq!(error.to_string(), "cancelled");
}

#[test]
fn operators_differ() {
    let columns = torus(Variant::Uniform);
    let surface = columns.surface(Definition::new());
    let at = starts(&columns);
    let points = OPERATORS.map(|o| surface.project(&at, &Project::new().with_operator(o)).point);
    assert_eq!(Project::default().operator(), Operator::Orthogonal);
    for (a, b) in [(0, 1), (1, 2), (0, 2)] {
        let apart = common::median((0..at.len()).map(|i| length(sub(points[a][i], points[b][i]))));
        assert!(apart > 1e-4 * columns.radius, "{a} {b}: {apart:e}");
    }
}
