//! Rays go where the camera's formulas say, and a camera that sees nothing is refused.

use crate::shapes::from_the_front;
use footpoint::Ray;
use footpoint_render::{Camera, CameraError, Projection};

fn at(ray: &Ray<3>, t: f64) -> [f64; 3] {
    std::array::from_fn(|k| ray.origin[k] + t * ray.direction[k])
}

fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}

#[test]
fn the_edges_of_a_perspective_picture_are_half_the_angle_away() {
    let view = from_the_front().view(200, 100);
    let half = 5.0 * 15.0_f64.to_radians().tan();
    // t is the depth: at 5 all rays are in the plane of what is looked at.
    assert!(near(at(&view.ray(100.0, 50.0), 5.0), [0.0; 3]));
    assert!(near(at(&view.ray(100.0, 0.0), 5.0), [0.0, 0.0, half]), "rows go down");
    assert!(near(at(&view.ray(200.0, 50.0), 5.0), [2.0 * half, 0.0, 0.0]), "columns go right");
    assert!(near(view.ray(0.0, 0.0).origin, [0.0, -5.0, 0.0]));
}

#[test]
fn parallel_rays_are_a_height_apart_at_the_edges() {
    let camera = Camera { projection: Projection::Orthographic { height: 3.0 }, ..from_the_front() };
    let view = camera.view(200, 100);
    let (top, low) = (view.ray(100.0, 0.0), view.ray(100.0, 100.0));
    assert_eq!(top.direction, low.direction);
    assert!(near(top.direction, [0.0, 1.0, 0.0]));
    assert!(near(at(&top, 5.0), [0.0, 0.0, 1.5]) && near(at(&low, 5.0), [0.0, 0.0, -1.5]));
}

#[test]
fn up_may_be_askew_and_even_along_the_line_of_sight() {
    let askew = Camera { up: [0.0, 3.0, 2.0], ..from_the_front() };
    assert_eq!(askew.view(8, 8).ray(1.0, 2.0), from_the_front().view(8, 8).ray(1.0, 2.0));
    let along = Camera { up: [0.0, 1.0, 0.0], ..from_the_front() };
    assert!(along.check().is_ok());
    assert!(along.view(8, 8).ray(0.0, 0.0).direction.iter().all(|c| c.is_finite()));
}

#[test]
fn a_camera_that_sees_nothing_is_refused() {
    let camera = from_the_front();
    let blind = Camera { from: camera.at, ..camera };
    assert!(matches!(blind.check(), Err(CameraError::NoSight { .. })));
    assert!(matches!(Camera { up: [0.0; 3], ..camera }.check(), Err(CameraError::NoUp(_))));
    for fov_degrees in [0.0, 180.0, -3.0, f64::NAN] {
        let projection = Projection::Perspective { fov_degrees };
        assert!(matches!(Camera { projection, ..camera }.check(), Err(CameraError::Fov(_))), "{fov_degrees}");
    }
    let projection = Projection::Orthographic { height: 0.0 };
    assert!(matches!(Camera { projection, ..camera }.check(), Err(CameraError::Height(_))));
}
