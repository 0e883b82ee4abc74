//! Figure 5: the first two steps of the almost orthogonal projection.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Scene, hill};
use super::style::{STEP, colour};
use footpoint::{Operator, Run};

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    let title = "Two steps of the almost orthogonal projection: x itself is projected onto the frames of the iterates";
    let canvas = Canvas::new(title, [0.12, -0.1], [1.42, 0.98]);
    let mut scene = Scene::new(hill([0.95, 0.3], [0.41, -0.29]), 1.02, canvas, run)?;
    let contour = scene.draw_curve()?;
    let iterates: [[f64; 2]; 3] = scene.iterates([0.85, 0.88], Operator::AlmostOrthogonal)?;
    let [x, first, second] = iterates;
    let frames = scene.frames(&[x, first])?;
    for (frame, end) in frames.iter().zip([first, second]) {
        scene.draw_tangent(frame, [80.0, 80.0]);
        scene.canvas.right_angle(end, frame.normal, frame.tangent(), STEP);
        scene.canvas.step(x, end, STEP);
    }
    let (canvas, ink, blue) = (&mut scene.canvas, colour::INK, colour::FRAME);
    for (frame, (name, offset)) in frames.iter().zip([("a(x)", [8.0, 14.0]), ("a(x′)", [-12.0, 14.0])]) {
        canvas.point(frame.average, blue);
        canvas.letters(frame.average, offset, name, blue);
    }
    let names = [("x", [-12.0, 2.0]), ("x′", [-11.0, 10.0]), ("x″", [13.0, -15.0])];
    for (point, (name, offset)) in iterates.into_iter().zip(names) {
        canvas.point(point, ink);
        canvas.letters(point, offset, name, ink);
    }
    scene.label_contour(&contour, [0.25, 0.4], [14.0, 15.0]);
    Ok(scene.canvas.finish())
}
