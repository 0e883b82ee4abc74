//! Figure 6: one step of the orthogonal projection.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Scene, hill, moved};
use super::style::{GRADIENT, STEP, colour};
use footpoint::{Operator, Run};

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    let title = "One step of the orthogonal projection: x moves along the gradient of f onto the frame of the iterate";
    let canvas = Canvas::new(title, [-0.6, 0.0], [0.75, 1.1]);
    let mut scene = Scene::new(hill([0.73, 0.3], [0.22, 0.07]), 1.12, canvas, run)?;
    let contour = scene.draw_curve()?;
    let [x, first, second]: [[f64; 2]; 3] = scene.iterates([0.25, 0.97], Operator::Orthogonal)?;
    let frame = scene.frame(first)?;
    scene.draw_tangent(&frame, [80.0, 120.0]);
    let normal = scene.draw_normal(&frame, first, 50.0);
    let gradient = moved(first, frame.gradient, scene.canvas.pixels(50.0));
    let (canvas, ink, blue) = (&mut scene.canvas, colour::INK, colour::FRAME);
    canvas.arrow(first, gradient, GRADIENT);
    canvas.angle((first, 22.0), [frame.normal, frame.gradient], STEP);
    canvas.step(x, second, STEP);
    canvas.point(frame.average, blue);
    canvas.letters(frame.average, [12.0, 14.0], "a(x′)", blue);
    canvas.letters(normal, [6.0, 10.0], "n(x′)", blue);
    canvas.letters(gradient, [-24.0, 2.0], "∇f(x′)", GRADIENT.colour);
    let names = [(x, "x", [-12.0, 2.0]), (first, "x′", [-12.0, -4.0]), (second, "x″", [14.0, 8.0])];
    for (point, name, offset) in names {
        canvas.point(point, ink);
        canvas.letters(point, offset, name, ink);
    }
    scene.label_contour(&contour, [-0.3, 0.2], [-22.0, 8.0]);
    Ok(scene.canvas.finish())
}
