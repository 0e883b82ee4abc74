//! What the figures share: a curve's samples, the contour through them, and the frames that the library finds.

use super::FigureError;
use super::canvas::Canvas;
use super::style::{CONTOUR, NORMAL, SAMPLE, TANGENT, colour};
use footpoint::samples::{Random, Samples};
use footpoint::{Contour, Definition, Operator, Project, Run, Status, Support, Surface, Want};
use std::f64::consts::TAU;

/// Cells of the contour, in supports: narrow enough for its corners not to show.
const CELL: f64 = 0.04;
/// Samples of a graph.
const COUNT: u32 = 110;

/// A curve and the page it is drawn on.
pub(super) struct Scene<'r> {
    pub(super) surface: Surface<2>,
    pub(super) canvas: Canvas,
    run: &'r Run<'r>,
}

/// What the library finds at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) point: [f64; 2],
    /// f, with the sign in which n has a positive component along y.
    pub(super) value: f64,
    pub(super) average: [f64; 2],
    pub(super) normal: [f64; 2],
    pub(super) gradient: [f64; 2],
}

impl<'r> Scene<'r> {
    /// The curve of the recommended definition with this support radius.
    pub(super) fn new(
        points: Vec<[f64; 2]>,
        radius: f64,
        canvas: Canvas,
        run: &'r Run<'r>,
    ) -> Result<Self, FigureError> {
        let definition = Definition::new().with_support(Support::Uniform(radius));
        let surface = Surface::build(footpoint::Cloud::new(points), definition, run)?;
        Ok(Self { surface, canvas, run })
    }

    /// Draws samples and contour; gives the contour's vertices.
    pub(super) fn draw_curve(&mut self) -> Result<Vec<[f64; 2]>, FigureError> {
        self.canvas.dots(self.surface.cloud().points(), SAMPLE, colour::SAMPLES);
        let contours = self.surface.with(self.run).contour(&Contour::new().with_cell(CELL))?;
        let mut vertices = Vec::new();
        for line in contours.polylines {
            self.canvas.polyline(&line.points, line.closed, CONTOUR);
            vertices.extend(line.points);
        }
        Ok(vertices)
    }

    /// f and what belongs to it at some points.
    pub(super) fn frames(&self, points: &[[f64; 2]]) -> Result<Vec<Frame>, FigureError> {
        let want = Want::VALUE | Want::AVERAGE | Want::FRAME_NORMAL | Want::GRADIENT;
        let e = self.surface.with(self.run).evaluate(points, want)?;
        let frame = |i: usize| {
            let sign = if e.frame_normal[i][1] < 0.0 { -1.0 } else { 1.0 };
            let [normal, gradient] = [e.frame_normal[i], e.gradient[i]].map(|v| v.map(|c| sign * c));
            match e.status[i] {
                Status::Ok => Ok(Frame {
                    point: points[i],
                    value: sign * e.value[i],
                    average: e.average[i],
                    normal,
                    gradient,
                }),
                other => Err(FigureError::Point(other)),
            }
        };
        (0..points.len()).map(frame).collect()
    }

    /// The same at one point.
    pub(super) fn frame(&self, point: [f64; 2]) -> Result<Frame, FigureError> {
        self.frames(&[point])?.pop().ok_or(FigureError::Point(Status::Invalid))
    }

    /// Writes f = 0 at the vertex nearest to a place.
    pub(super) fn label_contour(&mut self, contour: &[[f64; 2]], near: [f64; 2], offset: [f64; 2]) {
        let away = |p: &[f64; 2]| (p[0] - near[0]).hypot(p[1] - near[1]);
        let nearest = contour.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let at = nearest.copied().unwrap_or(near);
        self.canvas.letters(at, offset, "f = 0", colour::INK);
    }

    /// The first iterates of an operator from a point, so many.
    pub(super) fn iterates<const N: usize>(
        &self,
        point: [f64; 2],
        operator: Operator,
    ) -> Result<[[f64; 2]; N], FigureError> {
        let trace = self.surface.trace(point, &Project::new().with_operator(operator));
        trace.iterates.first_chunk().copied().ok_or(FigureError::Point(trace.status))
    }

    /// Draws the line through a orthogonal to n, so many pixels to its left and right.
    pub(super) fn draw_tangent(&mut self, frame: &Frame, [left, right]: [f64; 2]) {
        let along = frame.tangent();
        let [left, right] = [-left, right].map(|count| self.canvas.pixels(count));
        self.canvas.segment(moved(frame.average, along, left), moved(frame.average, along, right), TANGENT);
    }

    /// Draws n as an arrow so many pixels long.
    pub(super) fn draw_normal(&mut self, frame: &Frame, from: [f64; 2], length: f64) -> [f64; 2] {
        let tip = moved(from, frame.normal, self.canvas.pixels(length));
        self.canvas.arrow(from, tip, NORMAL);
        tip
    }
}

impl Frame {
    /// The unit vector orthogonal to n with a positive component along x.
    pub(super) fn tangent(&self) -> [f64; 2] {
        [self.normal[1], -self.normal[0]]
    }

    /// Where the line through a point in this direction meets the line through a orthogonal to n.
    pub(super) fn meets(&self, point: [f64; 2], direction: [f64; 2]) -> [f64; 2] {
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        let to_average = [self.average[0] - point[0], self.average[1] - point[1]];
        moved(point, direction, dot(self.normal, to_average) / dot(self.normal, direction))
    }
}

/// `from + factor · direction`.
pub(super) fn moved(from: [f64; 2], direction: [f64; 2], factor: f64) -> [f64; 2] {
    [from[0] + factor * direction[0], from[1] + factor * direction[1]]
}

/// Samples of the graph of a function for |x| < 1.9, evenly spread in x up to chance, moved by noise.
pub(super) fn graph(height: impl Fn(f64) -> f64, noise: f64) -> Vec<[f64; 2]> {
    let mut random = Random::new(2004);
    let mut at = |i: u32| {
        let x = 1.9 * (2.0 * (f64::from(i) + random.uniform()) / f64::from(COUNT) - 1.0);
        [x, height(x)]
    };
    let points = (0..COUNT).map(&mut at).collect();
    Samples { points, normals: Vec::new() }.with_noise(noise, 2004).points
}

/// A hill of this height and width on a slope that waves: narrower than the supports of figures 4 to 6, so that their steps
/// are as long as they are drawn.
pub(super) fn hill([height, width]: [f64; 2], [slope, wave]: [f64; 2]) -> Vec<[f64; 2]> {
    graph(|x| height * (-(x / width).powi(2)).exp() + slope * x + wave * (2.2 * x).sin(), 0.015)
}

/// Samples of the curve at this distance from the origin in every direction, evenly spread in the angle up to chance.
pub(super) fn round(radius: impl Fn(f64) -> f64, count: u32) -> Vec<[f64; 2]> {
    let mut random = Random::new(2004);
    let mut at = |i: u32| {
        let angle = TAU * (f64::from(i) + random.uniform()) / f64::from(count);
        [angle.cos(), angle.sin()].map(|c| c * radius(angle))
    };
    (0..count).map(&mut at).collect()
}
