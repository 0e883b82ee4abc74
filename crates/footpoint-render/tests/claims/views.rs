//! A view shows the cloud, filling the picture, whatever its outliers; the automatic one shows an open scan from its front.

use crate::shapes::{ball, drawn, of, plan, viewed};
use footpoint::samples::{Samples, sphere};
use footpoint::{Cloud, Definition, Surface};
use footpoint_render::{Extent, Plan, Projection, Shading, View, Wish};

fn back(surface: &Surface<3>, view: View) -> [f64; 3] {
    let camera = viewed(surface, view);
    let way: [f64; 3] = std::array::from_fn(|k| camera.from[k] - camera.at[k]);
    let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
    way.map(|c| c / length)
}

fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
}

#[test]
fn named_views_look_from_where_they_say() {
    let surface = ball(1_000);
    let third = 1.0 / 3.0_f64.sqrt();
    for (view, way) in [
        (View::Front, [0.0, -1.0, 0.0]),
        (View::Back, [0.0, 1.0, 0.0]),
        (View::Left, [-1.0, 0.0, 0.0]),
        (View::Right, [1.0, 0.0, 0.0]),
        (View::Top, [0.0, 0.0, 1.0]),
        (View::Bottom, [0.0, 0.0, -1.0]),
        (View::Iso, [third, -third, third]),
        // A closed surface is seen from everywhere alike.
        (View::Auto, [third, -third, third]),
    ] {
        assert!(near(back(&surface, view), way), "{view:?}: {:?}", back(&surface, view));
    }
    assert_eq!(viewed(&surface, View::Top).up, [0.0, 1.0, 0.0], "the front is at the lower edge");
}

/// What a scanner far along +z sees of a unit sphere, with normals or without.
fn cap(keep: impl Fn(&[f64; 3]) -> bool, with_normals: bool) -> Surface<3> {
    let Samples { points, normals } = sphere(1.0, 6_000, 3);
    let (points, normals): (Vec<_>, Vec<_>) =
        points.into_iter().zip(normals).filter(|(p, _)| keep(p)).unzip();
    let cloud = Cloud::new(points);
    let cloud = if with_normals { cloud.with_normals(normals).unwrap() } else { cloud };
    Surface::new(cloud, Definition::default()).unwrap()
}

#[test]
fn an_open_scan_is_shown_from_its_front() {
    for with_normals in [true, false] {
        let from_above = cap(|p| p[2] > 0.1, with_normals);
        assert!(back(&from_above, View::Auto)[2] > 0.5, "{:?}", back(&from_above, View::Auto));
        let from_behind = cap(|p| p[1] > 0.1, with_normals);
        assert!(back(&from_behind, View::Auto)[1] > 0.5, "{:?}", back(&from_behind, View::Auto));
        let from_below = cap(|p| p[2] < -0.1, with_normals);
        assert!(back(&from_below, View::Auto)[2] < -0.5, "{:?}", back(&from_below, View::Auto));
    }
}

#[test]
fn outliers_do_not_make_the_cloud_a_dot() {
    let mut samples = sphere(1.0, 3_000, 7);
    samples.points[5] = [400.0, 3.0, 0.0];
    samples.points[9] = [0.0, -90.0, 2000.0];
    let surface = of(samples);
    let camera = viewed(&surface, View::Front);
    let picture = drawn(&surface, &Plan { camera, ..plan(Shading::Surface) });
    let share = picture.hits as f64 / picture.rays as f64;
    // A disc as high as 0.92 of a picture four wide to three high covers half of it.
    assert!((0.4..0.56).contains(&share), "{share}");
    assert!((Extent::new(&surface).size() - 12.0_f64.sqrt()).abs() < 0.05);
}

#[test]
fn parallel_rays_and_wishes_are_kept() {
    let surface = ball(3_000);
    let extent = Extent::new(&surface);
    let wish = Wish { view: View::Front, parallel: true, ..Wish::default() };
    let camera = extent.camera(&wish, 64, 48).unwrap();
    let Projection::Orthographic { height } = camera.projection else { panic!("{camera:?}") };
    assert!((height - 2.0 / 0.92).abs() < 0.02, "{height}");
    let wish = Wish { from: Some([3.0, 0.0, 4.0]), at: Some([0.1, 0.0, 0.0]), ..wish };
    let camera =
        extent.camera(&Wish { height: Some(7.0), up: Some([1.0, 0.0, 0.0]), ..wish }, 64, 48).unwrap();
    assert_eq!((camera.from, camera.at, camera.up), ([3.0, 0.0, 4.0], [0.1, 0.0, 0.0], [1.0, 0.0, 0.0]));
    assert_eq!(camera.projection, Projection::Orthographic { height: 7.0 });
    assert!(extent.camera(&Wish { fov_degrees: 200.0, ..Wish::default() }, 64, 48).is_err());
}
