//! Light comes from the upper left, hollows are darker with occlusion, and threads and tiles change nothing.

use crate::shapes::{ball, drawn, pixel, plan};
use footpoint::samples::{plane, sphere};
use footpoint::{Cancelled, Cloud, Definition, Run, Surface};
use footpoint_render::{Occlusion, Plan, RenderError, Shading, render};
use std::sync::atomic::AtomicBool;

#[test]
fn the_upper_left_is_brighter_than_the_lower_right() {
    let surface = ball(3_000);
    for shading in [Shading::Surface, Shading::Frame] {
        let image = drawn(&surface, &plan(shading)).image;
        let [bright, dark] = [pixel(&image, 27, 19), pixel(&image, 37, 29)].map(|p| i32::from(p[1]));
        assert!(bright > dark + 40, "{bright} {dark}");
    }
}

#[test]
fn occlusion_darkens_where_a_ball_lies_on_a_floor() {
    let mut points = sphere(0.4, 3_000, 3).points;
    points.extend(plane(1.0, 4_000, 4).points.iter().map(|p| [p[0], p[1], -0.52]));
    let surface = Surface::new(Cloud::new(points), Definition::default()).unwrap();
    let camera = footpoint_render::Camera { from: [0.0, -4.0, 2.0], ..plan(Shading::Surface).camera };
    let plain = Plan { camera, ..plan(Shading::Surface) };
    let shaded = Plan { occlusion: Some(Occlusion { rays: 32, reach: 0.6 }), ..plain.clone() };
    let [open, hidden] = [plain, shaded].map(|plan| drawn(&surface, &plan).image);
    // Below the ball the floor is darker, far away it is not.
    let ratio = |x: usize, y: usize| f64::from(pixel(&hidden, x, y)[1]) / f64::from(pixel(&open, x, y)[1]);
    assert!(ratio(32, 33) < 0.93, "{}", ratio(32, 33));
    assert!(ratio(32, 41) > ratio(32, 33) + 0.03, "{}", ratio(32, 41));
}

#[test]
fn any_number_of_threads_draws_the_same_picture() {
    let surface = ball(2_000);
    let plan = Plan { occlusion: Some(Occlusion { rays: 4, reach: 1.0 }), ..plan(Shading::Surface) };
    let one = render(&surface, &plan, &Run::new().threads(1)).unwrap();
    assert_eq!(one.image, render(&surface, &plan, &Run::new().threads(3)).unwrap().image);
    assert_eq!(one.rays, 64 * 48);
}

#[test]
fn a_cancelled_or_senseless_picture_is_none() {
    let surface = ball(500);
    let flag = AtomicBool::new(true);
    let error = render(&surface, &plan(Shading::Surface), &Run::new().cancel(&flag)).unwrap_err();
    assert_eq!(error, RenderError::Cancelled(Cancelled));
    let refused = |plan: &Plan<'_>| render(&surface, plan, &Run::new()).unwrap_err();
    assert_eq!(refused(&Plan { size: [0, 5], ..plan(Shading::Surface) }), RenderError::Size(0, 5));
    assert_eq!(refused(&Plan { across: 0, ..plan(Shading::Surface) }), RenderError::NoSamples);
    let range = Some([1.0, 1.0]);
    assert_eq!(refused(&Plan { range, ..plan(Shading::Depth) }), RenderError::Range(1.0, 1.0));
}
