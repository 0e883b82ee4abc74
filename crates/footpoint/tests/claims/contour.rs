//! A contour's polylines lie on f = 0, are connected, run once along all of the accepted curve, and end at its rims.
#![allow(clippy::print_stdout)]

use crate::common::{
    self, Columns, Variant, add, definitions, dot, even_circle, largest, length, near_samples, scale, sub,
};
use footpoint::samples::{self, Samples};
use footpoint::{
    Acceptance, Cancelled, Cloud, Contour, Contours, Definition, NormalField, Polyline, Precision, Project,
    Run, Support, Surface, Want, Weight,
};
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

/// Every vertex is an accepted zero by a fresh evaluation; |f| at most and the longest segment, both in supports.
fn check(surface: &Surface<2>, contours: &Contours, tolerance: f64) -> (f64, f64) {
    let (mut value, mut longest) = (0.0_f64, 0.0_f64);
    for line in &contours.polylines {
        assert!(line.points.len() > 1);
        let e = surface.evaluate(&line.points, Want::ALL);
        let rule = surface.definition().acceptance();
        for i in 0..line.points.len() {
            assert!(e.status[i].is_ok() && e.gap[i] >= rule.gap);
            assert!(dot(e.frame_normal[i], e.gradient[i]) >= rule.alignment);
            assert!(e.eccentricity[i] <= surface.definition().boundary_limit::<2>());
            assert!((dot(line.surface_normal[i], e.surface_normal[i]).abs() - 1.0).abs() < 1e-12);
            value = value.max(e.value[i].abs() / e.support[i]);
            let next = if i + 1 < line.points.len() { i + 1 } else { 0 };
            if next > 0 || line.closed {
                longest = longest.max(length(sub(line.points[next], line.points[i])) / e.support[i]);
                let agree = dot(line.surface_normal[i], line.surface_normal[next]) > 0.0;
                assert!(agree || rule == Acceptance::EVERY_ZERO);
            }
        }
    }
    assert!(value <= tolerance, "|f| = {value:e} h");
    (value, longest)
}

fn segments(line: &Polyline) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    let count = if line.closed { line.points.len() } else { line.points.len() - 1 };
    (0..count).map(|i| (line.points[i], line.points[(i + 1) % line.points.len()]))
}

/// Distance of a point from the polylines.
fn distance(contours: &Contours, p: [f64; 2]) -> f64 {
    let to_segment = |(a, b): ([f64; 2], [f64; 2])| {
        let (way, from) = (sub(b, a), sub(p, a));
        let share = (dot(from, way) / dot(way, way)).clamp(0.0, 1.0);
        length(sub(p, add(a, scale(way, share))))
    };
    contours.polylines.iter().flat_map(|line| segments(line).map(to_segment)).fold(f64::INFINITY, f64::min)
}

/// Foot points of points near the samples lie on the polylines, up to their sagitta; the farthest, in supports.
fn check_feet(surface: &Surface<2>, contours: &Contours, bound: f64) -> f64 {
    let h = surface.support().median;
    let feet = surface.project(&near_samples(surface.cloud().points(), 500, 0.2 * h, 5), &Project::default());
    let ok: Vec<usize> = (0..500).filter(|&i| feet.status[i].is_ok()).collect();
    assert!(ok.len() > 350, "{}", ok.len());
    let farthest = largest(ok.iter().map(|&i| distance(contours, feet.point[i]) / h));
    assert!(farthest <= bound, "a foot point lies {farthest:e} h off the contour");
    farthest
}

#[test]
fn a_circle_is_one_closed_polyline_nearer_to_the_curve_the_narrower_the_cells() {
    let surface =
        Columns::new(&even_circle(300), 0.3, Variant::Uniform).field(NormalField::CentredCovariance);
    // By its symmetry the contour is a circle, drawn inwards by the bias.
    let radius = length(surface.project(&[[1.0, 0.0]], &Project::default()).point[0]);
    let mut errors = Vec::new();
    for cell in [0.4, 0.2, 0.1, 0.05] {
        let contours = surface.contour(&Contour::new().with_cell(cell));
        let (value, longest) = check(&surface, &contours, 1e-6);
        let [line] = contours.polylines.as_slice() else { panic!("{}", contours.polylines.len()) };
        assert!(line.closed);
        let short = (TAU * radius - line.length()) / (TAU * radius);
        // A chord of length s is shorter than its arc by s²/24.
        let bound = (longest * 0.3 / radius).powi(2) / 24.0;
        assert!(short > 0.0 && short < bound + 1e-6, "cells {cell}: {short:e} shorter, bound {bound:e}");
        let farthest = check_feet(&surface, &contours, (2.0 * cell * cell) * 0.3 / 8.0 + 1e-5);
        println!(
            "cells {cell} h: {} vertices, {} evaluations, |f| {value:.1e} h, {short:.1e} shorter, feet {farthest:.1e} h",
            line.points.len(),
            contours.evaluations
        );
        assert!(longest <= 1.5 * cell, "{longest}");
        errors.push(short);
    }
    let vertices = |cell: f64| surface.contour(&Contour::new().with_cell(cell)).polylines[0].points.len();
    assert_eq!([vertices(f64::NAN), vertices(f64::INFINITY)], [vertices(0.125), vertices(0.5)]);
    assert!(errors.windows(2).all(|pair| pair[1] < 0.35 * pair[0]), "{errors:?}");
}

#[test]
fn of_every_definition_on_a_noisy_ellipse() {
    let shape = samples::ellipse(1.0, 0.6, 400, 3).with_noise(0.01, 4);
    for variant in common::VARIANTS {
        let columns = Columns::new(&shape, 0.3, variant);
        for definition in definitions() {
            let surface = columns.surface(definition);
            let contours = surface.contour(&Contour::new());
            let (value, longest) = check(&surface, &contours, 1e-6);
            let lines = &contours.polylines;
            println!(
                "{variant:?} {:?}: {} pieces, closed {}, length {:.4}, |f| {value:.1e} h, longest {longest:.3} h, {} evaluations",
                definition.kind(),
                lines.len(),
                lines[0].closed,
                lines[0].length(),
                contours.evaluations
            );
            // Where n turns sideways within the domain, or the degree changes, the rule lets specks pass.
            let plain = definition.degree() == 0 && definition.field() != NormalField::Covariance;
            let specks = lines[1..].iter().all(|line| !plain && line.length() < 0.3 * 0.3);
            assert!(lines[0].closed && specks, "{:?}: {}", definition.kind(), lines.len());
            check_feet(&surface, &contours, 5e-3);
        }
    }
}

#[test]
fn of_an_arc_ends_where_the_boundary_rule_says() {
    // Five sixths of a circle.
    let mut whole = even_circle(360);
    whole.points.truncate(300);
    whole.normals.truncate(300);
    let columns = Columns::new(&whole, 0.25, Variant::Uniform);
    for definition in definitions() {
        let surface = columns.surface(definition);
        let contours = surface.contour(&Contour::new());
        check(&surface, &contours, 1e-6);
        let [line] = contours.polylines.as_slice() else {
            panic!("{:?}: {} pieces", definition.kind(), contours.polylines.len())
        };
        assert!(!line.closed);
        let ends = [line.points[0], line.points[line.points.len() - 1]];
        let e = surface.evaluate(&ends, Want::ALL);
        let (rule, limit) = (definition.acceptance(), surface.definition().boundary_limit::<2>());
        // What has come to its limit at the ends; about x n turns before the average is too far aside.
        let margin = [0, 1].map(|i| {
            let margins = [
                1.0 - e.eccentricity[i] / limit,
                e.gap[i] / rule.gap - 1.0,
                dot(e.frame_normal[i], e.gradient[i]) / rule.alignment - 1.0,
            ];
            margins.into_iter().fold(f64::INFINITY, f64::min)
        });
        let beyond: Vec<f64> = [0, 1]
            .map(|i| {
                let angle = ends[i][1].atan2(ends[i][0]).rem_euclid(TAU);
                let (first, last) = (0.0, TAU * 299.0 / 360.0);
                let away = if angle < 0.5 * (last + TAU) { angle - last } else { first - (angle - TAU) };
                away / 0.25
            })
            .to_vec();
        println!("{:?}: margins {margin:?}, beyond {beyond:?} h", definition.kind());
        assert!(margin.iter().all(|m| (0.0..1e-3).contains(m)), "{margin:?}");
        assert!(beyond.iter().all(|&b| (0.0..0.5).contains(&b)), "{beyond:?}");
    }
}

/// A row of samples along the x axis, or two.
fn rows(heights: &[f64], count: usize) -> Columns<2> {
    let mut shape = Samples::default();
    for &y in heights {
        shape.points.extend((0..count).map(|i| [2.0 * i as f64 / (count - 1) as f64 - 1.0, y]));
        shape.normals.extend(vec![[0.0, 1.0]; count]);
    }
    Columns::new(&shape, 0.25, Variant::Uniform)
}

#[test]
fn two_sheets_are_two_polylines_and_every_zero_is_more() {
    let columns = rows(&[-0.15, 0.15], 80);
    for field in common::FIELDS {
        let definition = Definition::new().with_field(field);
        let contours = columns.surface(definition).contour(&Contour::new());
        check(&columns.surface(definition), &contours, 1e-6);
        let heights: Vec<f64> = contours.polylines.iter().map(|line| line.points[0][1]).collect();
        println!(
            "{field:?}: {heights:?}, lengths {:?}",
            contours.polylines.iter().map(Polyline::length).collect::<Vec<_>>()
        );
        assert_eq!(heights.len(), 2, "{field:?}: {heights:?}");
        assert!(heights.iter().all(|y| (y.abs() - 0.15).abs() < 1e-6) && heights[0] * heights[1] < 0.0);
        let every = columns.surface(definition.with_acceptance(Acceptance::EVERY_ZERO));
        let zeros = every.contour(&Contour::new());
        check(&every, &zeros, 1e-6);
        let between = zeros.polylines.iter().flat_map(|line| &line.points).filter(|p| p[1].abs() < 0.1);
        assert!(between.count() > 10, "{field:?}");
    }
}

#[test]
fn a_figure_eight_has_all_its_feet_on_the_contour() {
    let at = |i: usize| {
        let (sine, cosine) = (TAU * i as f64 / 600.0).sin_cos();
        [sine, 1.3 * sine * cosine]
    };
    let surface = Surface::new(
        Cloud::new((0..600).map(at).collect::<Vec<_>>()),
        Definition::new().with_support(Support::Uniform(0.12)),
    )
    .unwrap();
    let contours = surface.contour(&Contour::new());
    check(&surface, &contours, 1e-6);
    let pieces: Vec<f64> = contours.polylines.iter().map(Polyline::length).collect();
    println!("figure eight: {pieces:?}, feet {:.1e} h", check_feet(&surface, &contours, 5e-3));
    assert!(pieces.iter().sum::<f64>() > 5.0);
}

#[test]
fn supports_may_differ_a_hundredfold() {
    // A spiral whose spacing and supports grow with the radius.
    let shape: Vec<[f64; 2]> = (0..900)
        .map(|i| {
            let (angle, r) = (0.06 * f64::from(i), 0.01 * (0.006 * f64::from(i)).exp());
            [r * angle.cos(), r * angle.sin()]
        })
        .collect();
    let radii: Vec<f64> = shape.iter().map(|&p| 0.3 * length(p)).collect();
    let cloud = Cloud::new(shape.clone()).with_supports(radii).unwrap();
    let surface = Surface::new(cloud, Definition::new().with_support(Support::FromSamples)).unwrap();
    let contours = surface.contour(&Contour::new());
    let (value, longest) = check(&surface, &contours, 1e-6);
    println!(
        "spiral: {} pieces, |f| {value:.1e}, {longest:.3}, {} evaluations",
        contours.polylines.len(),
        contours.evaluations
    );
    assert_eq!(contours.polylines.len(), 1);
    let feet = surface.project(&shape, &Project::default());
    let farthest = largest((0..900).map(|i| distance(&contours, feet.point[i]) / (0.3 * length(shape[i]))));
    assert!(farthest < 5e-3, "{farthest}");
}

#[test]
fn a_long_thin_cloud_costs_as_much_as_its_length() {
    let cost = |length: f64| {
        let count = (20.0 * length) as usize;
        let points: Vec<_> = (0..count).map(|i| [i as f64 / 20.0, 0.3 * (i as f64 / 20.0).sin()]).collect();
        let surface =
            Surface::new(Cloud::new(points), Definition::new().with_support(Support::Uniform(0.3))).unwrap();
        let contours = surface.contour(&Contour::new());
        assert_eq!(contours.polylines.len(), 1);
        contours.evaluations as f64 / length
    };
    let (short, long) = (cost(30.0), cost(3000.0));
    println!("evaluations by length: {short:.0}, {long:.0}");
    assert!(long < 1.2 * short, "{short} {long}");
}

#[test]
fn hostile_clouds_have_a_contour_or_none() {
    let lines = |points: Vec<[f64; 2]>, h: f64| {
        let definition = Definition::new().with_support(Support::Uniform(h));
        let surface = Surface::new(Cloud::new(points), definition).unwrap();
        let contours = surface.contour(&Contour::new());
        check(&surface, &contours, 1e-6);
        contours.polylines.len()
    };
    assert_eq!(lines(vec![[0.3, 0.1]], 1.0), 0);
    assert_eq!(lines(vec![[0.3, 0.1]; 50], 1.0), 0);
    assert_eq!(lines(vec![[f64::NAN, 0.1], [0.3, 0.1], [0.3, 0.2], [f64::INFINITY, 0.0]], 0.5), 1);
    let mut circle = even_circle(200).points;
    circle.extend(circle.clone());
    circle.extend([[f64::NAN; 2], [1e9, -1e9], [1e300, 0.0]]);
    assert_eq!(lines(circle.clone(), 0.3), 1);
    // Far from the origin, tiny, huge.
    assert_eq!(lines(circle.iter().map(|p| [p[0] + 5e5, p[1] - 4e6]).collect(), 0.3), 1);
    assert_eq!(lines(circle.iter().map(|p| scale(*p, 1e-120)).collect(), 0.3e-120), 1);
    assert_eq!(lines(even_circle(200).points.iter().map(|p| scale(*p, 1e150)).collect(), 0.3e150), 1);
}

#[test]
fn the_same_bits_for_any_threads_and_order_and_in_other_numbers_the_same_curve() {
    let shape = samples::ellipse(1.0, 0.6, 300, 8).with_noise(0.01, 9);
    let columns = Columns::new(&shape, 0.3, Variant::PerSample);
    let surface = columns.surface(Definition::new());
    let contours = surface.contour(&Contour::new());
    assert_eq!(surface.with(&Run::new().threads(1)).contour(&Contour::new()), Ok(contours.clone()));
    let mixed = columns.select(&common::shuffled(300, 4)).surface(Definition::new());
    assert_eq!(mixed.contour(&Contour::new()), contours);
    let single = columns.surface(Definition::new().with_precision(Precision::Single));
    let rough = single.contour(&Contour::new());
    check(&single, &rough, 1e-6);
    assert!((rough.polylines[0].length() - contours.polylines[0].length()).abs() < 1e-4);
    let exact = surface.contour(&Contour::new().with_tolerance(1e-12));
    check(&surface, &exact, 1e-12);
    assert_eq!(exact.polylines.len(), 1);
    let gaussian = Definition::new().with_weight(Weight::GAUSSIAN).with_support(Support::Uniform(0.12));
    let surface = Surface::new(Cloud::new(shape.points), gaussian).unwrap();
    let contours = surface.contour(&Contour::new());
    check(&surface, &contours, 1e-6);
    assert_eq!(contours.polylines.len(), 1);
    let flag = AtomicBool::new(true);
    assert_eq!(surface.with(&Run::new().cancel(&flag)).contour(&Contour::new()), Err(Cancelled));
}
