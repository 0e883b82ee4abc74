//! Figure 5: the first two steps of the almost orthogonal projection.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Scene, hill};
use super::style::{STEP, colour};
use footpoint::{Operator, Run};

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    let title = "Two steps of the almost orthogonal projection: x itself is projected onto the frames of the iterates";
    let canvas = Canvas::new(title, [-0.5, -0.25], [1.4, 1.05]);
    let mut scene = Scene::new(hill([0.95, 0.3], [0.41, -0.29]), 1.02, canvas, run)?;
    let contour = scene.draw_curve()?;
    let iterates: [[f64; 2]; 3] = scene.iterates([0.85, 0.88], Operator::AlmostOrthogonal)?;
    let [x, first, second] = iterates;
    let frames = scene.frames(&[x, first])?;
    for (frame, end) in frames.iter().zip([first, second]) {
        scene.draw_tangent(frame, [80.0, 80.0]);
        scene.canvas.right_angle(end, frame.normal, frame.tangent(), STEP);
        scene.canvas.arrow(x, end, STEP);
    }
    let (canvas, ink, blue) = (&mut scene.canvas, colour::INK, colour::FRAME);
    for (frame, name) in frames.iter().zip(["a(x)", "a(x′)"]) {
        canvas.point(frame.average, blue);
        canvas.letters(frame.average, [10.0, -14.0], name, blue);
    }
    for (point, name) in iterates.into_iter().zip(["x", "x′", "x″"]) {
        canvas.point(point, ink);
        canvas.letters(point, [-12.0, 4.0], name, ink);
    }
    scene.label_contour(&contour, [1.3, 0.1], [0.0, 16.0]);
    Ok(scene.canvas.finish())
}
