//! Colours stand for numbers: the right ones, with a bar that says which, and one of their own for what has no number.

use crate::shapes::{ball, drawn, pixel, plan};
use footpoint::samples::sphere;
use footpoint_render::{Background, Plan, Relief, Shading, view_size};

/// The bar's colours, from its middle row.
fn bar(plan: &Plan<'_>, image: &footpoint_render::Image) -> Vec<[u8; 4]> {
    let [width, rows] = view_size(plan.size, &plan.shading);
    let row = (rows..image.height())
        .max_by_key(|&y| (0..width).filter(|&x| pixel(image, x, y) != [255; 4]).count())
        .unwrap();
    (0..width).map(|x| pixel(image, x, row)).filter(|p| *p != [255; 4]).collect()
}

#[test]
fn an_attribute_is_shown_in_the_colours_of_its_bar() {
    let surface = ball(3_000);
    let heights: Vec<f64> = surface.cloud().points().iter().map(|p| p[2]).collect();
    let plan = Plan {
        size: [320, 240],
        relief: Relief::Flat,
        range: Some([-1.0, 1.0]),
        ..plan(Shading::Attribute(&heights))
    };
    let picture = drawn(&surface, &plan);
    assert_eq!(picture.range, Some([-1.0, 1.0]));
    let bar = bar(&plan, &picture.image);
    assert!(bar.len() > 180, "the bar has {} pixels", bar.len());
    let [width, rows] = plan.view_size();
    let view = plan.camera.view(width, rows);
    // On the axis of the picture the height is that of the ray's hit: y = −√(1 − z²).
    for y in (0..rows).step_by(7) {
        let ray = view.ray(width as f64 / 2.0, y as f64 + 0.5);
        let slope = ray.direction[2];
        let t = (5.0 - (25.0 - 24.0 * (1.0 + slope * slope)).sqrt()) / (1.0 + slope * slope);
        let shown = pixel(&picture.image, width / 2, y);
        if t.is_nan() || shown == [255; 4] || (t * slope).abs() > 0.95 {
            continue;
        }
        let expected = bar[((t * slope + 1.0) / 2.0 * (bar.len() - 1) as f64).round() as usize];
        let off = (0..3).map(|k| shown[k].abs_diff(expected[k])).max().unwrap();
        assert!(off <= 8, "row {y}: {shown:?}, the bar has {expected:?}");
    }
}

#[test]
fn what_has_no_number_has_a_colour_of_its_own_and_the_bar_says_so() {
    let surface = ball(3_000);
    let mut heights: Vec<f64> = surface.cloud().points().iter().map(|p| p[2]).collect();
    let whole = drawn(&surface, &plan(Shading::Attribute(&heights)));
    for (height, p) in heights.iter_mut().zip(surface.cloud().points()) {
        if p[0] > 0.0 {
            *height = f64::NAN;
        }
    }
    let plan = Plan { size: [160, 120], relief: Relief::Flat, ..plan(Shading::Attribute(&heights)) };
    let half = drawn(&surface, &plan);
    let none = pixel(&half.image, 95, 43);
    assert!(none[0] > 150 && none[1] < 60 && none[2] > 150, "{none:?}");
    let count = |image: &footpoint_render::Image| image.pixels().iter().filter(|p| **p == none).count();
    assert_eq!(count(&whole.image), 0);
    let below = |image: &footpoint_render::Image| {
        image.pixels()[160 * plan.view_size()[1]..].iter().filter(|p| **p == none).count()
    };
    assert!(count(&half.image) > 200 && below(&half.image) > 4, "{}", below(&half.image));
}

#[test]
fn ranges_are_found_and_those_with_a_sign_are_symmetric() {
    let surface = ball(20_000);
    let range = |shading| drawn(&surface, &plan(shading)).range.unwrap();
    let [low, high] = range(Shading::Curvature);
    // A sphere of radius 1 bends by 1 everywhere, and random samples make it bumpy.
    assert!(low == -high && (0.9..2.5).contains(&high), "{low} {high}");
    let [low, high] = range(Shading::Difference);
    assert!(high == 1.0 && (0.9..1.0).contains(&low), "{low}");
    let larger = crate::shapes::of(sphere(1.1, 3_000, 5));
    let [low, high] = range(Shading::Distance(&larger));
    assert!(low == -high && (high - 0.1).abs() < 0.02, "{low} {high}");
}

#[test]
fn colours_of_the_samples_are_averaged_in_linear_light() {
    let surface = ball(3_000);
    let side = |p: &[f64; 3]| if p[0] > 0.0 { [0.8, 0.1, 0.1] } else { [0.1, 0.1, 0.8] };
    let colours: Vec<[f64; 3]> = surface.cloud().points().iter().map(side).collect();
    let image = drawn(&surface, &plan(Shading::Colour(&colours))).image;
    let (left, right) = (pixel(&image, 24, 24), pixel(&image, 40, 24));
    assert!(right[0] > 2 * right[2] && left[2] > 2 * left[0], "{left:?} {right:?}");
}

#[test]
fn flat_colours_of_the_samples_are_exactly_theirs() {
    let surface = ball(3_000);
    // 188 of 255 in sRGB.
    let colours = vec![[0.5; 3]; surface.cloud().len()];
    let lit = drawn(&surface, &plan(Shading::Colour(&colours))).image;
    let flat = Plan { relief: Relief::Flat, ..plan(Shading::Colour(&colours)) };
    let flat = drawn(&surface, &flat).image;
    assert_eq!(pixel(&flat, 32, 24), [188, 188, 188, 255]);
    assert_ne!(pixel(&lit, 32, 24), [188, 188, 188, 255]);
}

#[test]
fn a_dark_picture_has_a_bright_bar() {
    let surface = ball(1_000);
    let background = Background::Colour([10, 10, 20]);
    let plan = Plan { background, size: [320, 240], ..plan(Shading::Depth) };
    let image = drawn(&surface, &plan).image;
    let strip = &image.pixels()[320 * plan.view_size()[1]..];
    assert!(strip.iter().filter(|p| p[0] > 200 && p[1] > 200 && p[2] > 200).count() > 50);
}
