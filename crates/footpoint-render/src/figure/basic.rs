//! Figure 4: the iterates of the basic projection.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Scene, hill};
use super::style::{STEP, colour};
use footpoint::{Operator, Run};

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    let title =
        "The basic projection: from x to its weighted average, then along the normals of the iterates";
    let canvas = Canvas::new(title, [-0.9, 0.05], [0.9, 1.68]);
    let mut scene = Scene::new(hill([0.77, 0.32], [-0.12, -0.08]), 1.27, canvas, run)?;
    let contour = scene.draw_curve()?;
    let iterates: [[f64; 2]; 4] = scene.iterates([-0.01, 1.56], Operator::Basic)?;
    let frames = scene.frames(&iterates[1..3])?;
    for frame in &frames {
        scene.draw_tangent(frame, [95.0, 95.0]);
        let end = frame.meets(frame.point, frame.normal);
        scene.canvas.right_angle(end, frame.normal, frame.tangent().map(|c| -c), STEP);
    }
    for step in iterates.windows(2) {
        scene.canvas.step(step[0], step[1], STEP);
    }
    for frame in &frames {
        scene.canvas.point(frame.average, colour::FRAME);
    }
    let names = ["x", "x′ = a(x)", "x″", "x‴"];
    let offsets = [[13.0, 0.0], [36.0, 2.0], [17.0, -2.0], [17.0, 5.0]];
    for ((&iterate, name), offset) in iterates.iter().zip(names).zip(offsets) {
        scene.canvas.point(iterate, colour::INK);
        scene.canvas.letters(iterate, offset, name, colour::INK);
    }
    scene.label_contour(&contour, [-0.72, 0.2], [0.0, 16.0]);
    Ok(scene.canvas.finish())
}
