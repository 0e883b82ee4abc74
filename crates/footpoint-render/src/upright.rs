//! Which axis is up, from where a cloud comes and how it is shaped: the one place that all views go by.

use crate::vector::{Vector, dot, sub};
use crate::view::{Extent, Wish, sides};
use serde::{Deserialize, Serialize};

/// Where a cloud comes from, as far as that says what is up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// Anywhere.
    #[default]
    Unknown,
    /// A file in a format of surveys.
    SurveyFormat,
    /// A file that states a coordinate reference system.
    ReferenceSystem,
}

/// Why an axis is taken as up; the first that holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Why {
    /// It was asked for.
    Stated,
    /// z: the file's format is one of surveys.
    SurveyFormat,
    /// z: the file states a reference system.
    ReferenceSystem,
    /// z: x and y are as large as those of maps.
    MapCoordinates,
    /// z: the cloud is flat, heights over a plane.
    Flat,
    /// z, y or −y: the cloud stands on its lower end.
    Stands,
    /// y or −y: much more is seen along z than from anywhere else, so z points to the front or away from it.
    Front,
    /// z: nothing speaks for another.
    Usual,
}

impl Why {
    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Stated => "as asked for",
            Self::SurveyFormat => "the format is one of surveys",
            Self::ReferenceSystem => "the file states a reference system",
            Self::MapCoordinates => "x and y are as large as those of maps",
            Self::Flat => "the cloud is flat, heights over a plane",
            Self::Stands => "the cloud stands on its lower end",
            Self::Front => "most is seen along z",
            Self::Usual => "nothing speaks for another axis",
        }
    }
}

/// What is up, and why.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Upright {
    /// A direction, not always a unit vector.
    pub axis: [f64; 3],
    /// Why this one.
    pub why: Why,
}

const Z: Vector = [0.0, 0.0, 1.0];
const Y: Vector = [0.0, 1.0, 0.0];
const MINUS_Y: Vector = [0.0, -1.0, 0.0];

/// Both middles beyond this are coordinates of a map: no object is put so far from its origin.
const MAP: f64 = 10_000.0;
/// Flat is what is less high than this share of its lesser side …
const FLAT: f64 = 1.0 / 3.0;
/// … with one height over each place: standard deviation within a cell as a share of the whole height. Two
/// sheets, as a flat closed body has, give 0.35 or more.
const ONE_HEIGHT: f64 = 0.3;
/// Cells along each side of the raster of heights.
const CELLS: usize = 32;
/// What a cloud stands on lies within this share of its height above the lower end …
const FOOT: f64 = 0.04;
/// … and covers at least this share of its plan.
const STANDING: f64 = 0.1;
/// What hangs is taken to have y downward, as cameras have, only where its upper end covers this share: many
/// an object is cut off above.
const HANGING: f64 = 0.4;
/// An end must cover so many times the plan of another's to be preferred.
const SURER: f64 = 2.0;
/// Where more of the samples than this are seen from above it is a sheet, and its rim no foot.
const SHEET: f64 = 0.85;

impl Extent {
    /// What is up: what was asked for, z where the origin is a survey's, else what the shape says.
    pub fn upright(&self, wish: &Wish) -> Upright {
        let (axis, why) = match (wish.up, wish.origin) {
            (Some(up), _) => (up, Why::Stated),
            (_, Origin::SurveyFormat) => (Z, Why::SurveyFormat),
            (_, Origin::ReferenceSystem) => (Z, Why::ReferenceSystem),
            (_, Origin::Unknown) => self.by_shape(),
        };
        Upright { axis, why }
    }

    fn by_shape(&self) -> (Vector, Why) {
        if self.has_map_coordinates() {
            return (Z, Why::MapCoordinates);
        }
        if self.is_flat(Z) {
            return (Z, Why::Flat);
        }
        if let Some(axis) = self.stands() {
            return (axis, Why::Stands);
        }
        let [x, y, z] = self.most_seen();
        if x == 0.0 && y == 0.0 { ([0.0, z.signum(), 0.0], Why::Front) } else { (Z, Why::Usual) }
    }

    /// Whether the cloud is a survey, which is never seen from below.
    pub(crate) fn is_survey(&self, wish: &Wish, up: Vector) -> bool {
        wish.origin != Origin::Unknown || self.has_map_coordinates() || self.is_flat(up)
    }

    fn has_map_coordinates(&self) -> bool {
        let [x, y, _] = self.middle;
        x.abs().min(y.abs()) > MAP.max(self.size)
    }

    /// Lengths to the right, to the front and up, and where they begin.
    pub(crate) fn lengths(&self, axes: &[Vector; 3]) -> ([f64; 3], [f64; 3]) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in &self.points {
            let p = sub(*p, self.middle);
            for k in 0..3 {
                let along = dot(p, axes[k]);
                (low[k], high[k]) = (low[k].min(along), high[k].max(along));
            }
        }
        (std::array::from_fn(|k| high[k] - low[k]), low)
    }

    /// Whether the cloud is heights over a plane: much less high than wide, and with one height over each
    /// place.
    fn is_flat(&self, up: Vector) -> bool {
        let axes = sides(up);
        let (long, low) = self.lengths(&axes);
        // False, too, where there is no point to measure.
        let is_low = long[2] < FLAT * long[0].min(long[1]);
        if !is_low {
            return false;
        }
        // Number, mean, and sum of squares about it.
        let mut cells = vec![(0.0, 0.0, 0.0); CELLS * CELLS];
        for p in &self.points {
            let p = sub(*p, self.middle);
            let place =
                |k: usize| (((dot(p, axes[k]) - low[k]) / long[k] * CELLS as f64) as usize).min(CELLS - 1);
            let (number, mean, squares) = &mut cells[place(1) * CELLS + place(0)];
            let height = dot(p, axes[2]);
            let off = height - *mean;
            *number += 1.0;
            *mean += off / *number;
            *squares += off * (height - *mean);
        }
        let shared = cells.iter().filter(|(number, ..)| *number > 1.0);
        let (free, squares) =
            shared.fold((0.0, 0.0), |(free, sum), (number, _, squares)| (free + number - 1.0, sum + squares));
        free == 0.0 || squares / free < (ONE_HEIGHT * long[2]).powi(2)
    }

    /// The axis on whose lower end the cloud stands, as a vase does: the samples there spread wide, and the
    /// middle of all is above them. z, unless it stands on an end of y far better.
    fn stands(&self) -> Option<Vector> {
        let mut best = (Z, self.foot(Z));
        for (axis, least) in [(Y, STANDING), (MINUS_Y, HANGING)] {
            let foot = self.foot(axis);
            let is_sheet = || self.seen(axis) > SHEET * self.points.len() as f64;
            if foot >= least && foot > SURER * best.1 && !is_sheet() {
                best = (axis, foot);
            }
        }
        (best.1 >= STANDING).then_some(best.0)
    }

    /// Share of the plan that the foot covers, with what is between its parts; 0 where the middle of all is
    /// not above it.
    fn foot(&self, up: Vector) -> f64 {
        let axes = sides(up);
        let (long, low) = self.lengths(&axes);
        let mut mean = [0.0; 2];
        let mut lowest = Vec::new();
        for p in &self.points {
            let [x, y, z] = axes.map(|axis| dot(sub(*p, self.middle), axis));
            mean = [mean[0] + x / self.points.len() as f64, mean[1] + y / self.points.len() as f64];
            if z - low[2] < FOOT * long[2] {
                lowest.push([x, y]);
            }
        }
        let outline = hull(lowest);
        let sides = || outline.iter().zip(outline.iter().cycle().skip(1));
        let is_above = outline.len() > 2 && sides().all(|(a, b)| left_of(*a, *b, mean) >= 0.0);
        if !is_above {
            return 0.0;
        }
        let area = 0.5 * sides().map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>();
        area / (long[0] * long[1])
    }
}

/// Twice the area of a triangle, positive where c lies to the left of the way from a to b.
fn left_of(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Corners of the convex hull, counterclockwise (Andrew's monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let chain = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut corners: Vec<[f64; 2]> = Vec::new();
        for &p in points {
            while let [.., a, b] = corners[..] {
                if left_of(a, b, p) > 0.0 {
                    break;
                }
                corners.pop();
            }
            corners.push(p);
        }
        corners.pop();
        corners
    };
    let mut corners = chain(&mut points.iter());
    corners.extend(chain(&mut points.iter().rev()));
    corners
}
