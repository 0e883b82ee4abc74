//! Figure 6: one step of the orthogonal projection.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Scene, hill, moved};
use super::style::{GRADIENT, STEP, colour};
use footpoint::{Operator, Run};

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    let title = "One step of the orthogonal projection: x moves along the gradient of f onto the frame of the iterate";
    let canvas = Canvas::new(title, [-0.8, -0.15], [0.9, 1.15]);
    let mut scene = Scene::new(hill([0.73, 0.3], [0.22, 0.07]), 1.12, canvas, run)?;
    let contour = scene.draw_curve()?;
    let [x, first, second]: [[f64; 2]; 3] = scene.iterates([0.25, 0.97], Operator::Orthogonal)?;
    let frame = scene.frame(first)?;
    scene.draw_tangent(&frame, [80.0, 80.0]);
    let normal = scene.draw_normal(&frame, first, 50.0);
    let gradient = moved(first, frame.gradient, scene.canvas.pixels(50.0));
    let (canvas, ink, blue) = (&mut scene.canvas, colour::INK, colour::FRAME);
    canvas.arrow(first, gradient, GRADIENT);
    canvas.angle((first, 22.0), [frame.normal, frame.gradient], STEP);
    canvas.arrow(x, second, STEP);
    canvas.point(frame.average, blue);
    canvas.letters(frame.average, [0.0, -14.0], "a(x′)", blue);
    canvas.letters(normal, [0.0, 9.0], "n(x′)", blue);
    canvas.letters(gradient, [0.0, 9.0], "∇f(x′)", GRADIENT.colour);
    for (point, name) in [(x, "x"), (first, "x′"), (second, "x″")] {
        canvas.point(point, ink);
        canvas.letters(point, [-12.0, 2.0], name, ink);
    }
    scene.label_contour(&contour, [-0.7, 0.0], [0.0, 16.0]);
    Ok(scene.canvas.finish())
}
