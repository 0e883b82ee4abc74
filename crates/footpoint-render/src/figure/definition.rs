//! Figure 1: the curve as the zero set of f, and what f is at a point.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Scene, graph, moved};
use super::style::{GUIDE, STEP, colour};
use footpoint::Run;

const RADIUS: f64 = 0.55;

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    let points = graph(|x| 0.3 * (1.9 * x - 0.5).sin(), 0.025);
    let title = "f(x) is the distance of x from the weighted average a(x) along the normal n(x)";
    let canvas = Canvas::new(title, [-1.5, -0.5], [1.5, 1.1]);
    let mut scene = Scene::new(points, RADIUS, canvas, run)?;
    let x = [0.2, 0.5];
    scene.canvas.disc(x, RADIUS, colour::SUPPORT);
    let contour = scene.draw_curve()?;
    let frame = scene.frame(x)?;
    let foot = frame.meets(x, frame.normal);
    let rim = moved(x, [0.96, 0.28], RADIUS);
    scene.canvas.segment(x, rim, GUIDE);
    scene.draw_tangent(&frame, [110.0, 110.0]);
    scene.canvas.segment(x, foot, STEP);
    scene.canvas.right_angle(foot, frame.normal, frame.tangent(), STEP);
    let tip = scene.draw_normal(&frame, x, 42.0);
    let (canvas, ink, blue) = (&mut scene.canvas, colour::INK, colour::FRAME);
    canvas.point(x, ink);
    canvas.point(frame.average, blue);
    canvas.letters(x, [-12.0, -1.0], "x", ink);
    canvas.letters(moved(x, [0.96, 0.28], 0.55 * RADIUS), [-2.0, 10.0], "h", ink);
    canvas.letters(tip, [-19.0, -4.0], "n(x)", blue);
    canvas.letters(frame.average, [9.0, -15.0], "a(x)", blue);
    canvas.letters(moved(x, frame.normal, -0.5 * frame.value), [-18.0, -5.0], "f(x)", ink);
    scene.label_contour(&contour, [-1.2, -0.1], [8.0, 16.0]);
    Ok(scene.canvas.finish())
}
