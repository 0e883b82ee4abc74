//! Between two epochs some 5 % are significant where nothing moved, whatever their noise and density, and
//! what moved is.
#![allow(clippy::unwrap_used)]

use crate::common::shuffled;
use footpoint::samples::Random;
use footpoint::{
    Cloud, Comparison, Definition, Differences, NormalField, Pair, Precision, Queries, Run, Status, Support,
};

/// Rolling ground of 20 by 20 with noise along its height; what lies in the disc of radius 4 about the
/// middle is raised.
fn ground(count: usize, noise: f64, raised: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| {
            let (x, y) = (20.0 * random.uniform() - 10.0, 20.0 * random.uniform() - 10.0);
            let up = if x.hypot(y) < 4.0 { raised } else { 0.0 };
            [x, y, 0.5 * (0.4 * x).sin() * (0.3 * y).cos() + up + noise * random.normal()]
        })
        .collect()
}

fn compared(earlier: Vec<[f64; 3]>, later: Vec<[f64; 3]>, how: &Comparison) -> Differences<3> {
    let clouds = (Cloud::new(earlier), Cloud::new(later));
    let (clouds, definition) = ((&clouds.0, &clouds.1), Definition::default());
    how.compare(clouds, definition, Queries::Samples, &Run::new()).unwrap().differences
}

/// Shares of the significant among those that did not move, and of the found among all that did, rims left
/// out.
fn shares(points: &[[f64; 3]], found: &Differences<3>) -> [f64; 2] {
    let share = |from: f64, to: f64| {
        let rows: Vec<usize> = (0..points.len())
            .filter(|&row| (from..to).contains(&points[row][0].hypot(points[row][1])))
            .filter(|&row| found.status[row].is_ok())
            .collect();
        let is_significant =
            |row: &&usize| found.distance[**row].abs() > Comparison::LEVEL * found.sigma[**row];
        rows.iter().filter(is_significant).count() as f64 / rows.len() as f64
    };
    [share(5.0, 9.0), share(0.0, 3.0)]
}

#[test]
fn nothing_cries_wolf_and_what_moved_is_found() {
    for (count, noise, what) in
        [(16_000, 0.02, "equal epochs"), (8_000, 0.02, "half the density"), (16_000, 0.05, "more noise")]
    {
        let (mut still, mut moved) = (0.0, 0.0);
        for seed in 0..3 {
            let later = ground(count, noise, 0.05, 10 + seed);
            let found = compared(ground(16_000, 0.02, 0.0, seed), later.clone(), &Comparison::new());
            let ok = found.status.iter().filter(|status| status.is_ok()).count();
            assert!(ok * 100 > 98 * count, "{what}: {ok} of {count} ok");
            let [a, b] = shares(&later, &found);
            still += a / 3.0;
            moved += b / 3.0;
        }
        println!("{what}: {:.2} % of the still, {:.1} % of the moved", 100.0 * still, 100.0 * moved);
        assert!((0.03..0.07).contains(&still), "{what}: {still} of what did not move");
        assert!(moved > 0.95, "{what}: {moved} of what did");
    }
}

#[test]
fn the_distance_is_that_of_the_surfaces_with_the_sign_of_the_earlier() {
    let (earlier, later) = (ground(16_000, 0.01, 0.0, 1), ground(16_000, 0.01, 0.1, 2));
    let up = vec![[0.0, 0.0, 1.0]; earlier.len()];
    for (normals, sign) in [(None, 1.0), (Some(1.0), 1.0), (Some(-1.0), -1.0)] {
        let mut cloud = Cloud::new(earlier.clone());
        if let Some(side) = normals {
            cloud = cloud.with_normals(up.iter().map(|n| n.map(|c| side * c)).collect::<Vec<_>>()).unwrap();
        }
        let clouds = (&cloud, &Cloud::new(later.clone()));
        let run = Run::new();
        let found = Comparison::new().compare(clouds, Definition::default(), Queries::Samples, &run).unwrap();
        let found = found.differences;
        let mut raised: Vec<f64> = (0..later.len())
            .filter(|&row| later[row][0].hypot(later[row][1]) < 3.0 && found.status[row].is_ok())
            .map(|row| found.distance[row])
            .collect();
        raised.sort_by(f64::total_cmp);
        let median = raised[raised.len() / 2];
        // Along the normal of a slope of a tenth, more or less.
        assert!((median * sign - 0.1).abs() < 0.003, "{normals:?}: {median}");
    }
}

#[test]
fn sigma_is_what_the_distances_scatter_by() {
    let how = Comparison::new().with_effective_neighbours(vec![16.0]);
    let mut sum = 0.0;
    let mut count = 0.0;
    for seed in 0..4 {
        let later = ground(8_000, 0.02, 0.0, 30 + seed);
        let found = compared(ground(8_000, 0.02, 0.0, 20 + seed), later, &how);
        for row in (0..8_000).filter(|&row| found.status[row].is_ok()) {
            sum += (found.distance[row] / found.sigma[row]).powi(2);
            count += 1.0;
        }
    }
    let ratio = f64::sqrt(sum / count);
    println!("deviation of the distances {ratio:.3} sigma");
    // Student's factor makes sigma larger than the deviation.
    assert!((0.85..1.0).contains(&ratio), "{ratio}");
}

#[test]
fn every_option_matters() {
    let (earlier, later) = (ground(4_000, 0.02, 0.0, 1), ground(4_000, 0.02, 0.0, 2));
    let found = |how: &Comparison| compared(earlier.clone(), later.clone(), how);
    let usual = found(&Comparison::new());
    let registered = found(&Comparison::new().with_registration(0.03));
    for row in (0..later.len()).filter(|&row| usual.status[row].is_ok()) {
        let expected = usual.sigma[row].hypot(0.03);
        assert!((registered.sigma[row] / expected - 1.0).abs() < 1e-12, "{row}");
        assert_eq!(registered.distance[row].to_bits(), usual.distance[row].to_bits());
    }
    // Each support alone, and the best of them wherever it is.
    let alone = [8.0, 16.0, 32.0].map(|n| found(&Comparison::new().with_effective_neighbours(vec![n])));
    let mut won = [0; 3];
    for row in 0..later.len() {
        let one = alone.iter().position(|a| {
            a.support[row] == usual.support[row] && a.distance[row].to_bits() == usual.distance[row].to_bits()
        });
        match one {
            Some(k) => won[k] += 1,
            None => assert!(!usual.status[row].is_ok(), "{row}"),
        }
    }
    // On such ground the widest knows most.
    assert!(won.iter().all(|&count| count > 5), "{won:?}");
    // A coarse tolerance is part of sigma.
    let coarse = found(&Comparison::new().with_tolerance(0.03));
    let median = |found: &Differences<3>| {
        let mut sigma: Vec<f64> = found.sigma.iter().copied().filter(|s| s.is_finite()).collect();
        sigma.sort_by(f64::total_cmp);
        sigma[sigma.len() / 2]
    };
    assert!(median(&coarse) > 1.2 * median(&usual), "{} {}", median(&coarse), median(&usual));
    // The definition's own support.
    let clouds = (&Cloud::new(earlier), &Cloud::new(later));
    let own = Comparison::new().with_effective_neighbours(Vec::new());
    for support in [Support::Uniform(0.9), Support::AutoPerSample { effective_neighbours: 20.0 }] {
        let definition = Definition::default().with_support(support);
        let found = own.compare(clouds, definition, Queries::Samples, &Run::new()).unwrap();
        let uniform = matches!(support, Support::Uniform(_));
        let widest = found.widest.earlier.support();
        assert_eq!((widest.uniform, widest.median == 0.9), (uniform, uniform));
        assert_eq!(found.widest.later.support().uniform, uniform);
        let ok = found.differences.status.iter().filter(|status| status.is_ok()).count();
        assert!(ok > 3800, "{support:?}: {ok}");
    }
}

#[test]
fn the_bits_are_the_same_for_any_threads_and_order() {
    let (earlier, later) = (ground(3_000, 0.02, 0.0, 1), ground(3_000, 0.02, 0.1, 2));
    let how = Comparison::new().with_registration(0.01);
    let answers = |earlier: &[[f64; 3]], later: &[[f64; 3]], threads: usize| {
        let clouds = (Cloud::new(earlier.to_vec()), Cloud::new(later.to_vec()));
        let run = Run::new().threads(threads);
        let found =
            how.compare((&clouds.0, &clouds.1), Definition::default(), Queries::Samples, &run).unwrap();
        let d = found.differences;
        let numbers = |row: usize| {
            let own = [d.distance[row], d.sigma[row], d.support[row]];
            [&d.start[row][..], &d.foot[row], &d.surface_normal[row], &own].concat()
        };
        let bits = |row: usize| (numbers(row).iter().map(|v| v.to_bits()).collect::<Vec<_>>(), d.status[row]);
        (0..later.len()).map(bits).collect::<Vec<_>>()
    };
    let expected = answers(&earlier, &later, 0);
    assert!(expected == answers(&earlier, &later, 1) && expected == answers(&earlier, &later, 3));
    let order = shuffled(earlier.len(), 7);
    let [first, second] =
        [&earlier, &later].map(|points| order.iter().map(|&i| points[i]).collect::<Vec<_>>());
    let found = answers(&first, &second, 2);
    assert!(order.iter().zip(found).all(|(&i, row)| row == expected[i]));
}

#[test]
fn other_definitions_and_curves_compare_too() {
    // Averaged fields need the surface's own normals: with others the surface follows the samples' density on slopes.
    let with_normals = |points: Vec<[f64; 3]>| {
        let normal = |[x, y, _]: &[f64; 3]| {
            let slope = |along: f64, across: f64| -0.5 * along * across;
            let (sine, cosine) = (0.4 * x).sin_cos();
            let (other_sine, other_cosine) = (0.3 * y).sin_cos();
            [slope(0.4 * cosine, other_cosine), slope(sine, -0.3 * other_sine), 1.0]
        };
        let normals: Vec<[f64; 3]> = points.iter().map(normal).collect();
        Cloud::new(points).with_normals(normals).unwrap()
    };
    let cloud = with_normals(ground(4_000, 0.02, 0.0, 1));
    let later = with_normals(ground(4_000, 0.02, 0.0, 2));
    let usual = Definition::default();
    let significant = |definition: Definition| {
        let run = Run::new();
        let found = Comparison::new()
            .compare((&cloud, &later), definition, Queries::Samples, &run)
            .unwrap()
            .differences;
        let ok: Vec<usize> = (0..4_000).filter(|&row| found.status[row].is_ok()).collect();
        assert!(ok.len() > 3_700, "{definition:?}: {}", ok.len());
        let loud = ok.iter().filter(|&&row| found.distance[row].abs() > 1.96 * found.sigma[row]).count();
        loud as f64 / ok.len() as f64
    };
    for definition in [
        usual.with_field(NormalField::Covariance),
        usual.with_field(NormalField::AveragedNormals),
        usual.with_field(NormalField::AveragedAxes),
        usual.with_degree(2),
        usual.with_precision(Precision::Single),
    ] {
        let share = significant(definition);
        println!("{:?} degree {}: {share:.4}", definition.field(), definition.degree());
        assert!((0.02..0.09).contains(&share), "{definition:?}: {share}");
    }
    let circle =
        |noise: f64, seed: u64| footpoint::samples::circle(1.0, 2_000, seed).with_noise(noise, seed).points;
    let (earlier, later) = (Cloud::new(circle(0.01, 1)), Cloud::new(circle(0.01, 2)));
    let run = Run::new();
    let found =
        Comparison::new().compare((&earlier, &later), usual, Queries::Samples, &run).unwrap().differences;
    let loud = (0..2_000).filter(|&row| found.distance[row].abs() > 1.96 * found.sigma[row]).count();
    assert!((40..180).contains(&loud), "{loud} of 2000");
}

#[test]
fn what_is_not_known_is_said() {
    let earlier = Cloud::new(ground(4_000, 0.02, 0.0, 1));
    let mut points = ground(4_000, 0.02, 0.0, 2);
    points.extend([[0.0, 0.0, 50.0], [f64::NAN, 0.0, 0.0]]);
    // A shelf of its own, far above: a surface on this side alone.
    points.extend(ground(4_000, 0.02, 0.0, 3).into_iter().map(|[x, y, z]| [x, y, z + 20.0]));
    let later = Cloud::new(points.clone());
    let run = Run::new();
    let how = Comparison::new();
    let found = how.compare((&earlier, &later), Definition::default(), Queries::Samples, &run).unwrap();
    let d = &found.differences;
    assert!(d.start[4_000][0].is_nan() && d.distance[4_000].is_nan() && !d.status[4_000].is_ok());
    assert_eq!(d.status[4_001], Status::Invalid);
    let shelf = 4_002 + 2_000;
    assert!((d.start[shelf][2] - points[shelf][2]).abs() < 0.2, "{:?}", d.start[shelf]);
    assert_eq!((d.status[shelf], d.sigma[shelf].is_nan()), (Status::Outside, true));
    // Whoever finds the foot elsewhere has it judged.
    let Pair { earlier, later } = &found.widest;
    let feet = [d.start[shelf], d.start[shelf]].map(|[x, y, z]| [x, y, z - 20.0]);
    let feet = earlier.project(&feet, &footpoint::Project::new()).point;
    let starts = later.project(&[points[shelf], points[shelf]], &footpoint::Project::new()).point;
    let sigma = how.judge(&found.widest, (&feet, &starts), &run).unwrap();
    assert!(sigma[0] == sigma[1] && (0.002..0.02).contains(&sigma[0]), "{sigma:?}");
    assert!(how.judge(&found.widest, (&starts, &starts), &run).unwrap()[0].is_nan());
    let nothing =
        how.compare((earlier.cloud(), &Cloud::default()), Definition::default(), Queries::Samples, &run);
    assert!(matches!(nothing, Err(footpoint::CompareError::Later(_))));
}
