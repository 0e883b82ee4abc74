//! A canvas has the shape of what it shows, within bounds, with about as many pixels whatever the shape; a
//! given size is kept.

use crate::shapes::{drawn, of, plan};
use footpoint::samples::sphere;
use footpoint::{Cloud, Definition, Surface};
use footpoint_render::{Aim, Canvas, Extent, Plan, Shading, View, Wish, view_size};

const PIXELS: usize = 20_000;

/// An ellipsoid.
fn body(scales: [f64; 3]) -> Surface<3> {
    let points = sphere(1.0, 4_000, 5).points;
    let points: Vec<[f64; 3]> =
        points.into_iter().map(|p| std::array::from_fn(|k| scales[k] * p[k])).collect();
    Surface::new(Cloud::new(points), Definition::default()).unwrap()
}

fn aim(surface: &Surface<3>, wish: &Wish, canvas: Canvas, shading: &Shading<'_>) -> Aim {
    Extent::new(surface).aim(wish, canvas, shading).unwrap()
}

#[test]
fn the_shape_follows_the_content() {
    for (scales, ratio) in [
        ([1.0, 1.0, 1.0], 1.0),
        ([2.0, 1.0, 1.0], 2.0),
        ([1.0, 1.0, 2.0], 0.5),
        ([9.0, 1.0, 1.0], 2.5),
        ([1.0, 1.0, 9.0], 0.4),
    ] {
        for parallel in [false, true] {
            let surface = body(scales);
            let wish = Wish { view: View::Front, parallel, ..Wish::default() };
            let found = aim(&surface, &wish, Canvas::Shaped(PIXELS), &Shading::Surface);
            let [width, height] = found.size.map(|side| side as f64);
            assert!((width / height / ratio - 1.0).abs() < 0.1, "{scales:?}: {width} x {height}");
            assert!((width * height / PIXELS as f64 - 1.0).abs() < 0.03, "{scales:?}: {width} x {height}");
            // Nothing is cut off, and little is empty: an ellipse covers π/4 of what it fits into.
            let plan = Plan { camera: found.camera, size: found.size, ..plan(Shading::Surface) };
            let picture = drawn(&surface, &plan);
            let rows = picture.image.pixels().chunks(found.size[0]);
            let is_white = |p: &[u8; 4]| *p == [255; 4];
            let is_edge = |y: usize| y == 0 || y + 1 == found.size[1];
            assert!(rows.enumerate().all(|(y, row)| {
                is_white(&row[0])
                    && is_white(&row[row.len() - 1])
                    && (!is_edge(y) || row.iter().all(is_white))
            }));
            let share = picture.hits as f64 / picture.rays as f64;
            assert!(share > 0.5 || scales.contains(&9.0), "{scales:?}: {share}");
        }
    }
}

#[test]
fn a_scale_bar_is_below_what_is_shown() {
    let surface = of(sphere(1.0, 2_000, 3));
    let wish = Wish { view: View::Front, ..Wish::default() };
    let bare = aim(&surface, &wish, Canvas::Shaped(PIXELS), &Shading::Surface);
    let found = aim(&surface, &wish, Canvas::Shaped(PIXELS), &Shading::Depth);
    assert_eq!(view_size(found.size, &Shading::Depth), bare.size);
    assert_eq!(found.camera, bare.camera, "the same view with and without numbers");
}

#[test]
fn a_given_size_is_kept() {
    let surface = body([1.0, 1.0, 3.0]);
    let size = [64, 48];
    let found = aim(&surface, &Wish::default(), Canvas::Given(size), &Shading::Surface);
    assert_eq!(found.size, size);
    assert_eq!(found.camera, Extent::new(&surface).camera(&Wish::default(), 64, 48).unwrap());
    // Where the eye's place is given the shape is four to three.
    let wish = Wish { from: Some([9.0, 0.0, 0.0]), ..Wish::default() };
    let found = aim(&surface, &wish, Canvas::Shaped(480_000), &Shading::Surface);
    assert_eq!(found.size, [800, 600]);
}
