//! What a picture shows: light on the surface, or numbers in colours.

use crate::colour::{Colour, Colours, Map, NO_NUMBER, to_linear};
use crate::light::{Lights, PLASTER};
use crate::vector::{Vector, dot, scale};
use footpoint::{Cancelled, Project, Queries, Run, Sign, Surface, Want};

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub enum Shading<'a> {
    /// Light on the surface, by its exact normal ∇f/|∇f|.
    #[default]
    Surface,
    /// Light on the surface, by the frame normal n: smoother than the surface is.
    Frame,
    /// n·∇f/|∇f|, the cosine of the angle between the two.
    Difference,
    /// Mean curvature, one over a length, positive where the surface bulges outward: by the sign of the samples' normals or,
    /// without them, toward the eye.
    Curvature,
    /// Distance to another surface, a length; positive on the side of its normals, if its samples have some.
    Distance(&'a Surface<3>),
    /// The weighted average of numbers that the samples carry, one each.
    Attribute(&'a [f64]),
    /// Light on the surface in the samples' own colours, linear light from 0 to 1.
    Colour(&'a [[f64; 3]]),
    /// The surface normal towards the eye: x y z from −1 to 1 as red green blue in sRGB.
    Normal,
    /// Distance from the eye's plane, a length.
    Depth,
}

/// One point that is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) point: Vector,
    /// Of the surface, towards the eye.
    pub(crate) normal: Vector,
    pub(crate) frame: Vector,
    pub(crate) gradient: Vector,
    /// Unit vector.
    pub(crate) to_eye: Vector,
    pub(crate) depth: f64,
    /// Which of the picture's rays found it.
    pub(crate) number: usize,
}

/// Share of the numbers at either end that may lie beyond the colours.
const BEYOND: f64 = 0.02;

impl Shading<'_> {
    /// Whether colours stand for numbers, so that the picture needs a scale bar.
    pub fn has_numbers(&self) -> bool {
        self.map().is_some()
    }

    fn map(&self) -> Option<Map> {
        match self {
            Self::Difference => Some(Map::Agreement),
            Self::Curvature => Some(Map::Diverging),
            Self::Distance(other) if other.sign() == Sign::Given => Some(Map::Diverging),
            Self::Distance(_) | Self::Attribute(_) | Self::Depth => Some(Map::Sequential),
            Self::Surface | Self::Frame | Self::Colour(_) | Self::Normal => None,
        }
    }

    /// The colours of a range of numbers.
    pub(crate) fn colours(&self, range: [f64; 2]) -> Option<Colours> {
        self.map().map(|map| Colours::new(map, range))
    }

    /// The numbers at the points; empty where the shading has none.
    pub(crate) fn numbers(
        &self,
        surface: &Surface<3>,
        run: &Run<'_>,
        seen: &[Seen],
    ) -> Result<Vec<f64>, Cancelled> {
        let points = || seen.iter().map(|s| s.point).collect::<Vec<_>>();
        Ok(match self {
            Self::Difference => {
                seen.iter().map(|s| dot(s.frame, s.gradient) / dot(s.gradient, s.gradient).sqrt()).collect()
            }
            Self::Depth => seen.iter().map(|s| s.depth).collect(),
            Self::Curvature => {
                let points = points();
                let bent =
                    surface.with(run).evaluate(Queries::Points(&points), Want::CURVATURE)?.curvature.mean;
                let outward = |s: &Seen| match surface.sign() {
                    Sign::Given => 1.0,
                    Sign::Arbitrary => 1.0_f64.copysign(dot(s.gradient, s.to_eye)),
                };
                bent.into_iter().zip(seen).map(|(k, s)| k * outward(s)).collect()
            }
            Self::Distance(other) => {
                let points = points();
                let feet = other.with(run).project(Queries::Points(&points), &Project::default())?;
                feet.distance
            }
            Self::Attribute(values) => {
                let rows: Vec<[f64; 1]> = values.iter().map(|&v| [v]).collect();
                surface.with(run).average(&points(), &rows)?.into_iter().map(|[v]| v).collect()
            }
            Self::Surface | Self::Frame | Self::Colour(_) | Self::Normal => Vec::new(),
        })
    }

    /// A range for these numbers, without the 2 % furthest out; symmetric about 0 for those with a sign.
    pub(crate) fn range_of(&self, numbers: Vec<f64>) -> [f64; 2] {
        let mut sorted: Vec<f64> = numbers.into_iter().filter(|v| v.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let last = sorted.len().saturating_sub(1);
            sorted.get((share * last as f64).round() as usize).copied().unwrap_or(0.0)
        };
        match (self, self.map()) {
            (Self::Depth, _) => [at(0.0), at(1.0)],
            (Self::Difference, _) => [at(BEYOND).min(1.0), 1.0],
            (_, Some(Map::Diverging)) => {
                let reach = at(BEYOND).abs().max(at(1.0 - BEYOND).abs());
                [-reach, reach]
            }
            (Self::Distance(_), _) => [0.0, at(1.0 - BEYOND)],
            _ => [at(BEYOND), at(1.0 - BEYOND)],
        }
    }

    /// The samples' own colours at the points; empty where the shading does not show them.
    pub(crate) fn own_colours(
        &self,
        surface: &Surface<3>,
        run: &Run<'_>,
        seen: &[Seen],
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        match self {
            Self::Colour(colours) => {
                let points: Vec<Vector> = seen.iter().map(|s| s.point).collect();
                surface.with(run).average(&points, colours)
            }
            _ => Ok(Vec::new()),
        }
    }

    /// The colours of the points in linear light.
    pub(crate) fn paint(&self, painter: &Painter<'_>, seen: &[Seen], found: &Found) -> Vec<Colour> {
        let one = |(i, s): (usize, &Seen)| {
            let open = found.open.get(i).copied().unwrap_or(1.0);
            let light = |albedo, normal| painter.lights.on_surface(albedo, normal, s.to_eye, open);
            match (self, painter.colours) {
                (Self::Surface, _) => light(PLASTER, s.normal),
                (Self::Frame, _) => {
                    let facing = 1.0_f64.copysign(dot(s.frame, s.to_eye));
                    light(PLASTER, scale(s.frame, facing))
                }
                (Self::Colour(_), _) => {
                    let own = found.own[i];
                    if own[0].is_nan() {
                        return NO_NUMBER;
                    }
                    let own = own.map(|c| c.clamp(0.0, 1.0) as f32);
                    match painter.relief {
                        Relief::Lit => light(own, s.normal),
                        Relief::Flat => own,
                    }
                }
                (Self::Normal, _) => s.normal.map(|c| to_linear((0.5 + 0.5 * c).clamp(0.0, 1.0) as f32)),
                (_, Some(colours)) => {
                    let colour = colours.of(found.numbers[i]);
                    match painter.relief {
                        Relief::Lit => painter.lights.on_number(colour, s.normal, s.to_eye, open),
                        Relief::Flat => colour,
                    }
                }
                (_, None) => PLASTER,
            }
        };
        seen.iter().enumerate().map(one).collect()
    }
}

/// What is known of every point that is seen; empty lists where it is not wanted.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub(crate) numbers: Vec<f64>,
    pub(crate) own: Vec<[f64; 3]>,
    /// Shares of the sky.
    pub(crate) open: Vec<f64>,
}

/// Whether light falls on colours: the samples' own, and those that stand for numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Relief {
    /// Some, so that the shape shows.
    #[default]
    Lit,
    /// None: colours are exactly those of the samples or of the scale bar.
    Flat,
}

/// What painting takes beside the points.
pub(crate) struct Painter<'p> {
    pub(crate) lights: Lights,
    pub(crate) colours: Option<&'p Colours>,
    pub(crate) relief: Relief,
}
