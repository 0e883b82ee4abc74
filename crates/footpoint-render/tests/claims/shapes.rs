//! Surfaces and plans that several claims use.

use footpoint::samples::{Samples, sphere};
use footpoint::{Cloud, Definition, Run, Surface};
use footpoint_render::{
    Background, Camera, Extent, Image, Keep, Picture, Plan, Projection, Relief, Shading, View, Wish, render,
};

/// A unit sphere with outward normals.
pub(crate) fn ball(count: usize) -> Surface<3> {
    of(sphere(1.0, count, 7))
}

pub(crate) fn of(samples: Samples<3>) -> Surface<3> {
    let cloud = Cloud::new(samples.points).with_normals(samples.normals).unwrap();
    Surface::new(cloud, Definition::default()).unwrap()
}

/// From the front, at a distance of 5.
pub(crate) fn from_the_front() -> Camera {
    Camera {
        from: [0.0, -5.0, 0.0],
        at: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        projection: Projection::Perspective { fov_degrees: 30.0 },
    }
}

/// 64 × 48 pixels of one ray.
pub(crate) fn plan(shading: Shading<'_>) -> Plan<'_> {
    Plan {
        camera: from_the_front(),
        size: [64, 48],
        across: 1,
        shading,
        relief: Relief::Lit,
        background: Background::default(),
        occlusion: None,
        range: None,
        title: "title".to_owned(),
        planes: Keep::No,
    }
}

pub(crate) fn drawn(surface: &Surface<3>, plan: &Plan<'_>) -> Picture {
    render(surface, plan, &Run::new()).unwrap()
}

pub(crate) fn pixel(image: &Image, x: usize, y: usize) -> [u8; 4] {
    image.pixels()[y * image.width() + x]
}

/// The camera of a view for a picture of 64 × 48 pixels.
pub(crate) fn viewed(surface: &Surface<3>, view: View) -> Camera {
    Extent::new(surface).camera(&Wish { view, ..Wish::default() }, 64, 48).unwrap()
}
