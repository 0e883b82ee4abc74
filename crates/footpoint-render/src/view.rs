//! Where to look from: named views, the automatic one, and the distance at which a cloud fills the picture.

use crate::camera::{Axes, Camera, CameraError, Projection};
use crate::upright::{Origin, Upright, Why};
use crate::vector::{Vector, add_scaled, cross, dot, length, scale, sub, unit};
use footpoint::Surface;

/// From where to look. Right in the front view is +x; the front is the side of −y where z is up, as on
/// drawings, and that of +z where y is. [`Extent::upright`] says which is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum View {
    /// As `Iso`, unless more of the samples are seen from elsewhere; a survey from above, the front at the
    /// lower edge.
    #[default]
    Auto,
    /// From the front.
    Front,
    /// From behind.
    Back,
    /// From the left.
    Left,
    /// From the right.
    Right,
    /// From above, the front at the lower edge.
    Top,
    /// From below, the front at the upper edge.
    Bottom,
    /// From the front, right and above, all three alike.
    Iso,
}

/// What is wished of a camera; the rest is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// From where, unless `from` says it.
    pub view: View,
    /// The eye.
    pub from: Option<[f64; 3]>,
    /// What is looked at; the middle of the cloud by default.
    pub at: Option<[f64; 3]>,
    /// What is up; what [`Extent::upright`] finds by default.
    pub up: Option<[f64; 3]>,
    /// Where the cloud comes from.
    pub origin: Origin,
    /// Parallel rays instead of perspective.
    pub parallel: bool,
    /// Angle of view from the lower to the upper edge, in degrees, for perspective.
    pub fov_degrees: f64,
    /// Height of the picture in the unit of the cloud, for parallel rays; what the cloud needs by default.
    pub height: Option<f64>,
}

impl Default for Wish {
    /// The automatic view in perspective, 30 degrees.
    fn default() -> Self {
        Self {
            view: View::Auto,
            from: None,
            at: None,
            up: None,
            origin: Origin::Unknown,
            parallel: false,
            fov_degrees: 30.0,
            height: None,
        }
    }
}

/// So many samples or fewer stand for the cloud.
const MOST: usize = 50_000;
/// Share of the samples beyond each end of an axis that may be outliers.
const OUTLYING: f64 = 0.005;
/// What lies further outside than this share of the rest's width is an outlier.
const ALLOWED: f64 = 0.25;
/// Share of the picture, from edge to edge, that the cloud fills.
const FILLED: f64 = 0.92;
/// Cells along each side of the raster that tells which samples are seen.
const RASTER: usize = 64;
/// How far behind the nearest sample of its cell a seen one may be, as a share of the cloud's size.
const THICK: f64 = 0.05;
/// A view must show this much more to be preferred.
const BETTER: f64 = 1.1;
/// Facing a direction by more than this is no chance.
const CLEARLY: f64 = 0.1;
/// A survey less high than this share of its width is land.
const LOW: f64 = 2.0 / 3.0;
/// Angle at which land is looked at, from the horizon.
const TILT_DEGREES: f64 = 60.0;
/// Sine of the angle between up and the line of sight below which something else is up.
const UPRIGHT: f64 = 0.2;

/// Where the cloud is, without its outliers: what a camera is fitted to.
#[derive(Clone, Debug)]
pub struct Extent {
    pub(crate) points: Vec<Vector>,
    /// Empty, or one for each of the points.
    normals: Vec<Vector>,
    pub(crate) middle: Vector,
    /// Length of the diagonal of the bounds.
    pub(crate) size: f64,
    /// The median of the supports.
    pub(crate) support: f64,
}

/// A line of sight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// From what is looked at toward the eye, of any length.
    pub(crate) back: Vector,
    /// Up in the picture.
    up: Vector,
    /// What is up in the cloud.
    pub(crate) upright: Upright,
}

impl Extent {
    /// Looks at every so many samples. A sample is an outlier where it lies outside the bounds of the middle 99 % by more than
    /// a quarter of their width.
    pub fn new(surface: &Surface<3>) -> Self {
        let cloud = surface.cloud();
        let stride = cloud.len().div_ceil(MOST).max(1);
        let finite = |p: &Vector| p.iter().all(|c| c.is_finite());
        let rows: Vec<usize> =
            (0..cloud.len()).step_by(stride).filter(|&i| finite(&cloud.points()[i])).collect();
        let (mut least, mut most) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        for k in 0..3 {
            let mut along: Vec<f64> = rows.iter().map(|&i| cloud.points()[i][k]).collect();
            along.sort_unstable_by(f64::total_cmp);
            let Some(last) = along.len().checked_sub(1) else { continue };
            let skipped = (OUTLYING * last as f64) as usize;
            let (low, high) = (along[skipped], along[last - skipped]);
            let allowed = ALLOWED * (high - low) + surface.support().median;
            (least[k], most[k]) = (low - allowed, high + allowed);
        }
        let inside = |p: &Vector| (0..3).all(|k| (least[k]..=most[k]).contains(&p[k]));
        let rows: Vec<usize> = rows.into_iter().filter(|&i| inside(&cloud.points()[i])).collect();
        let points: Vec<Vector> = rows.iter().map(|&i| cloud.points()[i]).collect();
        let normals =
            cloud.normals().map_or_else(Vec::new, |normals| rows.iter().map(|&i| normals[i]).collect());
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in &points {
            for k in 0..3 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let size = length(sub(high, low)).max(surface.support().median);
        Self {
            points,
            normals,
            middle: std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]),
            size,
            support: surface.support().median,
        }
    }

    /// Length of the diagonal of the bounds.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The camera that was wished for, at the distance or height at which the cloud fills a picture of so many pixels.
    pub fn camera(&self, wish: &Wish, width: usize, height: usize) -> Result<Camera, CameraError> {
        self.placed(wish, &self.sight(wish)?, width as f64 / height as f64)
    }

    /// The line of sight that was wished for.
    pub(crate) fn sight(&self, wish: &Wish) -> Result<Sight, CameraError> {
        if let Some(up) = wish.up.filter(|&up| !(length(up).is_finite() && length(up) > 0.0)) {
            return Err(CameraError::NoUp(up));
        }
        let upright = self.upright(wish);
        let upward = upright.axis;
        let back = match wish.from {
            Some(from) => sub(from, wish.at.unwrap_or(self.middle)),
            None => self.direction(wish, &upright),
        };
        let up = if length(cross(unit(back), unit(upward))) > UPRIGHT || wish.from.is_some() {
            upward
        } else {
            // Straight from above or below: the front at the lower or at the upper edge.
            let [_, front, _] = sides(upward);
            scale(front, -1.0_f64.copysign(dot(back, upward)))
        };
        Ok(Sight { back, up, upright })
    }

    /// The camera on a line of sight, for a picture of this width over height.
    pub(crate) fn placed(&self, wish: &Wish, sight: &Sight, ratio: f64) -> Result<Camera, CameraError> {
        let mut at = wish.at.unwrap_or(self.middle);
        let Sight { back, up, .. } = *sight;
        let axes = Axes::new(back, up);
        let fov = wish.fov_degrees;
        let trial = Camera {
            from: wish.from.unwrap_or(add_scaled(at, unit(back), 1.0)),
            at,
            up,
            projection: Projection::Perspective { fov_degrees: fov },
        };
        trial.check()?;
        let slope = FILLED * (0.5 * fov).to_radians().tan();
        // Distance from `at` at which every sample is inside the picture.
        let distance = |at: Vector| {
            let needed = |p: &Vector| {
                let [x, y, z] = axes.of(sub(*p, at));
                z + (x.abs() / ratio).max(y.abs()) / slope
            };
            self.points.iter().map(needed).fold(0.0, f64::max)
        };
        if wish.at.is_none() && wish.from.is_none() {
            at = self.centred(at, &axes);
        }
        let half = |at: Vector| {
            let needed = |p: &Vector| {
                let [x, y, _] = axes.of(sub(*p, at));
                (x.abs() / ratio).max(y.abs())
            };
            self.points.iter().map(needed).fold(0.0, f64::max)
        };
        let projection = if wish.parallel {
            let height = wish.height.unwrap_or(2.0 * half(at).max(1e-3 * self.size) / FILLED);
            Projection::Orthographic { height }
        } else {
            Projection::Perspective { fov_degrees: fov }
        };
        let far = if wish.parallel { 2.0 * self.size } else { distance(at).max(1e-3 * self.size) };
        let from = wish.from.unwrap_or(add_scaled(at, unit(back), far));
        // No zero keeps a sign, which would be written.
        let up = up.map(|c| c + 0.0);
        let camera = Camera { from, at, up, projection };
        camera.check()?;
        Ok(camera)
    }

    /// `at` moved across the line of sight, so that the cloud reaches as far to either side.
    fn centred(&self, at: Vector, axes: &Axes) -> Vector {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in &self.points {
            let across = axes.of(sub(*p, at));
            for k in 0..2 {
                low[k] = low[k].min(across[k]);
                high[k] = high[k].max(across[k]);
            }
        }
        if low[0] > high[0] {
            return at;
        }
        let [x, y] = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
        add_scaled(add_scaled(at, axes.right, x), axes.up, y)
    }

    /// From the middle to the eye.
    fn direction(&self, wish: &Wish, upright: &Upright) -> Vector {
        let axes = sides(upright.axis);
        let [right, front, up] = axes;
        match wish.view {
            View::Front => front,
            View::Back => scale(front, -1.0),
            View::Right => right,
            View::Left => scale(right, -1.0),
            View::Top => up,
            View::Bottom => scale(up, -1.0),
            View::Iso => sum(right, front, up),
            View::Auto if self.is_survey(wish, up) => self.over_land(&axes),
            // From straight above nothing is seen to stand; from below only a sheet's front is shown.
            View::Auto => {
                let stands = upright.why == Why::Stands;
                let allowed = |a, b, c| c >= 0.0 && !(stands && a == 0.0 && b == 0.0);
                self.toward_its_front(self.best(&axes, allowed))
            }
        }
    }

    /// Where a survey is seen from: as a map is, north up and east to the right, but tilted so that walls
    /// show; what is high for its width from the side or corner that shows most, from above all the same.
    fn over_land(&self, axes: &[Vector; 3]) -> Vector {
        let ([wide, deep, high], _) = self.lengths(axes);
        if high < LOW * (wide * deep).sqrt() {
            let (rise, back) = TILT_DEGREES.to_radians().sin_cos();
            return add_scaled(scale(axes[1], back), axes[2], rise);
        }
        self.best(axes, |a, b, c| c > 0.0 && (a != 0.0 || b != 0.0))
    }

    /// The direction that shows most where it is not known which axis is up: straight along z, too, is from
    /// the front of what has y upward, and straight against z of what has y downward, as cameras have.
    pub(crate) fn most_seen(&self) -> Vector {
        let axes = sides([0.0, 0.0, 1.0]);
        self.toward_its_front(self.best(&axes, |a, b, c| c >= 0.0 || (a == 0.0 && b == 0.0)))
    }

    /// From the front, right and above, if at least 1/1.1 as many samples are seen from there as from any of
    /// the allowed ones of the 26 directions to the sides, edges and corners of a cube; else from the one
    /// with most.
    fn best(&self, &[right, front, up]: &[Vector; 3], allowed: impl Fn(f64, f64, f64) -> bool) -> Vector {
        let iso = sum(right, front, up);
        let mut best = (iso, BETTER * self.seen(iso));
        for a in [1.0, 0.0, -1.0] {
            for b in [1.0, 0.0, -1.0] {
                for c in [1.0, 0.0, -1.0] {
                    let way = sum(scale(right, a), scale(front, b), scale(up, c));
                    if length(way) > 0.5 && allowed(a, b, c) {
                        let seen = self.seen(way);
                        if seen > best.1 {
                            best = (way, seen);
                        }
                    }
                }
            }
        }
        best.0
    }

    /// A thin sheet is seen as well from behind: of two opposite directions that show alike the one that most
    /// normals face or, without normals, that the sheet bulges toward, as what a scanner saw does.
    fn toward_its_front(&self, way: Vector) -> Vector {
        let behind = scale(way, -1.0);
        let is_behind = BETTER * self.seen(behind) >= self.seen(way) && self.faces(behind) > CLEARLY;
        if is_behind { behind } else { way }
    }

    /// How many samples are seen from a direction, in a coarse raster.
    pub(crate) fn seen(&self, way: Vector) -> f64 {
        let axes =
            Axes::new(way, if way[2].abs() > 0.9 * length(way) { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] });
        let cell = |v: f64| ((v / self.size + 0.5) * RASTER as f64).clamp(0.0, (RASTER - 1) as f64) as usize;
        let place = |p: &Vector| {
            let [x, y, z] = axes.of(sub(*p, self.middle));
            (cell(y) * RASTER + cell(x), z)
        };
        let mut nearest = vec![f64::NEG_INFINITY; RASTER * RASTER];
        for p in &self.points {
            let (i, z) = place(p);
            nearest[i] = nearest[i].max(z);
        }
        let is_seen = |p: &&Vector| {
            let (i, z) = place(p);
            z >= nearest[i] - THICK * self.size
        };
        self.points.iter().filter(is_seen).count() as f64
    }

    /// How much the cloud faces a direction rather than its opposite, from −1 to 1; about 0 where it is closed: the mean of the
    /// normals' components or, without normals, how height towards the eye goes with nearness to the axis (correlation).
    fn faces(&self, way: Vector) -> f64 {
        let way = unit(way);
        let count = self.points.len().max(1) as f64;
        if !self.normals.is_empty() {
            let usable = self.normals.iter().filter(|n| n[0].is_finite());
            return usable.map(|n| dot(*n, way)).sum::<f64>() / count;
        }
        let (mut z, mut r, mut zz, mut rr, mut rz) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in &self.points {
            let d = sub(*p, self.middle);
            let height = dot(d, way);
            let aside = dot(d, d) - height * height;
            (z, r) = (z + height, r + aside);
            (zz, rr, rz) = (zz + height * height, rr + aside * aside, rz + aside * height);
        }
        let covariance = z * r / count - rz;
        covariance / ((zz - z * z / count) * (rr - r * r / count)).sqrt()
    }
}

fn sum(a: Vector, b: Vector, c: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k] + c[k])
}

/// Unit vectors to the right, to the front and up.
pub(crate) fn sides(up: Vector) -> [Vector; 3] {
    let up = unit(up);
    let axis = if up[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let right = unit(add_scaled(axis, up, -dot(axis, up)));
    [right, cross(right, up), up]
}
