//! What is not surface is background, whole or in part: alpha and colours at the silhouette are shares of the rays that hit.

use crate::shapes::{ball, drawn, pixel, plan};
use footpoint_render::{Background, Plan, Shading};

#[test]
fn a_transparent_picture_over_a_colour_is_the_picture_on_that_colour() {
    let surface = ball(3_000);
    let with = |background| Plan { across: 4, background, ..plan(Shading::Surface) };
    let clear = drawn(&surface, &with(Background::Transparent)).image;
    let red = drawn(&surface, &with(Background::Colour([200, 30, 10]))).image;
    let linear = |v: u8| f64::from(footpoint_render::linear(f32::from(v) / 255.0));
    let (mut edge, mut whole, mut none) = (0, 0, 0);
    for (over, on) in clear.pixels().iter().zip(red.pixels()) {
        assert_eq!(on[3], 255);
        let alpha = f64::from(over[3]) / 255.0;
        match over[3] {
            0 => none += 1,
            255 => whole += 1,
            _ => edge += 1,
        }
        // Every pixel has 16 rays.
        assert!((16.0 * alpha - (16.0 * alpha).round()).abs() < 0.04, "{alpha}");
        for k in 0..3 {
            let expected = alpha * linear(over[k]) + (1.0 - alpha) * linear([200, 30, 10][k]);
            assert!((linear(on[k]) - expected).abs() < 0.01, "{over:?} {on:?}");
        }
    }
    assert!(edge > 60 && whole > 600 && none > 1000, "{edge} {whole} {none}");
    assert_eq!(pixel(&clear, 0, 0), [0; 4]);
    assert_eq!(pixel(&red, 63, 47), [200, 30, 10, 255]);
}

#[test]
fn a_silhouette_has_no_specks() {
    let surface = ball(3_000);
    let plan = Plan { across: 2, background: Background::Transparent, ..plan(Shading::Surface) };
    let image = drawn(&surface, &plan).image;
    // Going outward from the middle of any row, surface ends once.
    for y in 0..image.height() {
        let row: Vec<bool> = (0..image.width()).map(|x| pixel(&image, x, y)[3] > 127).collect();
        let changes = row.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(changes == 0 || changes == 2, "row {y} changes {changes} times");
    }
}
