//! All views go by one axis that is up; a survey is never seen from below or mirrored: north is up and east
//! to the right.

use crate::shapes::ball;
use footpoint::samples::{Samples, torus};
use footpoint::{Cloud, Definition, Surface};
use footpoint_render::{Camera, Extent, Origin, View, Why, Wish};

fn of(points: Vec<[f64; 3]>) -> Extent {
    Extent::new(&Surface::new(Cloud::new(points), Definition::default()).unwrap())
}

fn camera(extent: &Extent, wish: &Wish) -> Camera {
    extent.camera(wish, 64, 48).unwrap()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// From what is looked at toward the eye.
fn back(camera: &Camera) -> [f64; 3] {
    let way: [f64; 3] = std::array::from_fn(|k| camera.from[k] - camera.at[k]);
    let length = dot(way, way).sqrt();
    way.map(|c| c / length)
}

/// To the right in the picture.
fn right(camera: &Camera) -> [f64; 3] {
    let (u, b) = (camera.up, back(camera));
    [u[1] * b[2] - u[2] * b[1], u[2] * b[0] - u[0] * b[2], u[0] * b[1] - u[1] * b[0]]
}

/// Heights over a square of side 2.
fn land(height: impl Fn(f64, f64) -> f64) -> Vec<[f64; 3]> {
    let side = |i: usize| f64::from(u32::try_from(i).unwrap()) / 40.0 - 1.0;
    (0..81 * 81)
        .map(|i| {
            let (x, y) = (side(i % 81), side(i / 81));
            [x, y, height(x, y)]
        })
        .collect()
}

/// The y-up copy of points with z up, or any other that turns axes.
fn turned(points: &[[f64; 3]], turn: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<[f64; 3]> {
    points.iter().map(|&p| turn(p)).collect()
}

/// A cone without its point on a round floor, z up.
fn pot() -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for i in 0..40 {
        let share = f64::from(i) / 39.0;
        for k in 0..80 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 80.0).sin_cos();
            let wide = 1.0 - 0.6 * share;
            points.push([wide * cos, wide * sin, 2.5 * share]);
            points.push([share * cos, share * sin, 0.0]);
        }
    }
    points
}

#[test]
fn a_survey_is_seen_from_above_with_north_up_whatever_shows_most() {
    // A hollow and a hill, a vault seen best from below, and what is high.
    let hollow = land(|x, y| 0.3 * (x * x + y * y));
    let hill = land(|x, y| -0.3 * (x * x + y * y));
    let tents = land(|x, y| 0.2 * (9.0 * x).sin() * (7.0 * y).cos());
    for (name, points) in [("hollow", &hollow), ("hill", &hill), ("tents", &tents)] {
        for (origin, why) in [
            (Origin::Unknown, Why::Flat),
            (Origin::SurveyFormat, Why::SurveyFormat),
            (Origin::ReferenceSystem, Why::ReferenceSystem),
        ] {
            let extent = of(points.clone());
            let wish = Wish { origin, ..Wish::default() };
            let upright = extent.upright(&wish);
            assert_eq!((upright.axis, upright.why), ([0.0, 0.0, 1.0], why), "{name}");
            let camera = camera(&extent, &wish);
            let (back, right) = (back(&camera), right(&camera));
            assert!(back[2] > 0.5 && back[1] <= 0.0, "{name}: from {back:?}");
            assert!(right[0] > 0.0 && right[1].abs() < 1e-9, "{name}: east is at {right:?}");
        }
    }
    // As high as wide: a shaft open below.
    let shaft: Vec<_> = pot().into_iter().filter(|p| p[2] > 0.05).collect();
    let extent = of(turned(&shaft, |[x, y, z]| [x, y, 0.6 * z]));
    let survey = Wish { origin: Origin::SurveyFormat, ..Wish::default() };
    assert!(back(&camera(&extent, &survey))[2] > 0.5);
    assert_eq!(camera(&extent, &survey).up, [0.0, 0.0, 1.0]);
}

#[test]
fn coordinates_of_a_map_make_a_survey() {
    let steep = land(|x, y| x + y);
    let upright = |points: Vec<[f64; 3]>| of(points).upright(&Wish::default()).why;
    assert_ne!(upright(steep.clone()), Why::MapCoordinates);
    assert_eq!(upright(turned(&steep, |[x, y, z]| [400_000.0 + x, 5e6 + y, z])), Why::MapCoordinates);
}

#[test]
fn a_flat_body_is_no_land() {
    let Samples { points, .. } = torus(1.0, 0.2, 6000, 7);
    let why = of(points).upright(&Wish::default()).why;
    assert_ne!(why, Why::Flat);
}

#[test]
fn what_stands_is_shown_upright_whichever_axis_is_up() {
    let [y_up, y_down] = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    for (name, points, up, front) in [
        ("z", pot(), [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]),
        ("y", turned(&pot(), |[x, y, z]| [x, z, -y]), y_up, [0.0, 0.0, 1.0]),
        ("-y", turned(&pot(), |[x, y, z]| [x, -z, y]), y_down, [0.0, 0.0, -1.0]),
    ] {
        let extent = of(points);
        let upright = extent.upright(&Wish::default());
        assert_eq!((upright.axis, upright.why), (up, Why::Stands), "{name}");
        let view = |view| camera(&extent, &Wish { view, ..Wish::default() });
        let near = |a: [f64; 3], b: [f64; 3]| dot(a, b) > 1.0 - 1e-9;
        assert!(near(back(&view(View::Front)), front), "{name}: {:?}", back(&view(View::Front)));
        assert!(near(back(&view(View::Top)), up), "{name}");
        for view in [View::Front, View::Left, View::Iso, View::Auto].map(view) {
            assert_eq!(view.up, up, "{name}: named views and the automatic one agree");
            assert!(dot(back(&view), up) > -1e-9, "{name}: from below");
        }
        // Never mirrored: seen from the front x is to the right.
        assert!(right(&view(View::Front))[0] > 0.99, "{name}");
    }
}

#[test]
fn what_is_asked_for_holds() {
    let extent = of(pot());
    let wish = Wish { up: Some([0.0, 1.0, 0.0]), origin: Origin::SurveyFormat, ..Wish::default() };
    let upright = extent.upright(&wish);
    assert_eq!((upright.axis, upright.why), ([0.0, 1.0, 0.0], Why::Stated));
    let front = camera(&extent, &Wish { view: View::Front, ..wish });
    assert!(back(&front)[2] > 0.99 && front.up == [0.0, 1.0, 0.0]);
    assert!(back(&camera(&extent, &wish))[1] > 0.5, "a survey with y up is seen from there");
}

#[test]
fn a_round_body_has_z_up() {
    let extent = Extent::new(&ball(3_000));
    assert_eq!(extent.upright(&Wish::default()).axis, [0.0, 0.0, 1.0]);
}
