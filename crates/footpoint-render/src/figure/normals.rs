//! Figure 2: the directions of smallest covariance along the contour, and its normals ∇f.

use super::FigureError;
use super::canvas::Canvas;
use super::scene::{Frame, Scene, moved, round};
use super::style::{GRADIENT, NORMAL, Pen, STEP, colour};
use footpoint::Run;
use footpoint::samples::Random;

const LINES: usize = 30;

pub(super) fn draw(run: &Run<'_>) -> Result<String, FigureError> {
    // Waves no longer than the support, on the upper half only.
    let radius = |angle: f64| 0.8 * (1.0 + 0.22 * angle.sin().max(0.0) * (11.0 * angle).sin());
    let title =
        "On the contour the direction of smallest covariance n is not always that of the gradient of f";
    let canvas = Canvas::new(title, [-1.15, -0.95], [1.15, 1.2]);
    let mut scene = Scene::new(round(radius, 200), 0.3, canvas, run)?;
    let contour = scene.draw_curve()?;
    let mut random = Random::new(5);
    let mut some = |i: usize| {
        let share = (i as f64 + random.uniform()) / LINES as f64;
        contour[(share * contour.len() as f64) as usize]
    };
    let chosen: Vec<[f64; 2]> = (0..LINES).map(&mut some).collect();
    let frames = scene.frames(&chosen)?;
    for frame in &frames {
        line(&mut scene.canvas, frame.point, along_gradient(frame), GRADIENT);
        line(&mut scene.canvas, frame.point, frame.normal, NORMAL);
    }
    let widest = frames.iter().max_by(|a, b| degrees(a).total_cmp(&degrees(b)));
    if let Some(frame) = widest {
        let canvas = &mut scene.canvas;
        canvas.angle((frame.point, HALF), [frame.normal, along_gradient(frame)], STEP);
        let label = moved(frame.point, frame.normal, canvas.pixels(HALF + 11.0));
        canvas.remark(label, [0.0, 0.0], &format!("{:.0}°", degrees(frame)), colour::INK);
    }
    legend(&mut scene.canvas);
    Ok(scene.canvas.finish())
}

/// Half the length of a line, in pixels.
const HALF: f64 = 19.0;

fn line(canvas: &mut Canvas, at: [f64; 2], direction: [f64; 2], pen: Pen) {
    let half = canvas.pixels(HALF);
    canvas.segment(moved(at, direction, -half), moved(at, direction, half), Pen { width: 1.3, ..pen });
}

fn along_gradient(frame: &Frame) -> [f64; 2] {
    let length = frame.gradient[0].hypot(frame.gradient[1]);
    frame.gradient.map(|c| c / length)
}

/// Angle between n and ∇f.
fn degrees(frame: &Frame) -> f64 {
    let (n, g) = (frame.normal, along_gradient(frame));
    (n[0] * g[1] - n[1] * g[0]).atan2(n[0] * g[0] + n[1] * g[1]).abs().to_degrees()
}

/// In the middle, which the contour goes around.
fn legend(canvas: &mut Canvas) {
    for (y, pen, text) in [(0.09, NORMAL, "n(x)"), (-0.09, GRADIENT, "∇f(x)")] {
        line(canvas, [-0.17, y], [1.0, 0.0], pen);
        canvas.letters([0.1, y], [0.0, 0.0], text, pen.colour);
    }
}
