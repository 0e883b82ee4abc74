//! From a surface to a picture: tiles of rays, cast, shaded, and averaged in linear light.

use crate::camera::{Camera, CameraError, Rays};
use crate::colour::{Background, Colour};
use crate::image::Image;
use crate::light::Lights;
use crate::occlusion::{self, Occlusion};
use crate::scale_bar::{self, Missing, Words};
use crate::shading::{Found, Painter, Relief, Seen, Shading};
use crate::vector::{scale, unit};
use footpoint::{Cancelled, Cast, Progress, Ray, Run, Surface};

/// So many rays are under way at a time: the memory of a picture does not grow with its rays.
pub(crate) const MOST_RAYS: usize = 1 << 17;
/// Rays that find the range of the colours, where it is not given.
const SCOUTS: usize = 1 << 16;
/// |f| of a hit, in supports: no pixel shows less.
const TOLERANCE: f64 = 1e-5;

/// What to draw.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// From where.
    pub camera: Camera,
    /// Pixels in a row and rows, at least 1 and at most 65,535.
    pub size: [usize; 2],
    /// Rays along each side of a pixel: 2 gives 4 samples a pixel, at least 1.
    pub across: usize,
    /// What is shown.
    pub shading: Shading<'a>,
    /// Whether light falls on colours that stand for numbers.
    pub relief: Relief,
    /// What lies behind.
    pub background: Background,
    /// Shadows in hollows.
    pub occlusion: Option<Occlusion>,
    /// The numbers at the ends of the colours; found by a coarse picture where it is not given.
    pub range: Option<[f64; 2]>,
    /// Written above the scale bar.
    pub title: String,
    /// Whether depth and normals of every pixel are kept.
    pub planes: Keep,
}

/// Whether something is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// It is not.
    #[default]
    No,
    /// It is.
    Yes,
}

/// What the rays through the middles of the pixels found, row by row from the upper left corner; NaN where they found nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// Distance from the eye's plane along the line of sight, a length.
    pub depth: Vec<f32>,
    /// Surface normal towards the eye, in the cloud's axes.
    pub normal: Vec<[f32; 3]>,
}

/// A picture and what is to be said of it.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The picture, with its scale bar.
    pub image: Image,
    /// Depth and normals, where they were to be kept.
    pub planes: Option<Planes>,
    /// Rays that the picture took; those for occlusion and range are not counted.
    pub rays: usize,
    /// Rays that met the surface.
    pub hits: usize,
    /// The numbers at the ends of the colours.
    pub range: Option<[f64; 2]>,
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A size that is none.
    #[error(
        "a picture of {0} × {1} pixels: each must be from 1 to 65535, and both together at most 268 million"
    )]
    Size(usize, usize),
    /// No ray at all.
    #[error("0 samples a pixel: at least 1 is needed")]
    NoSamples,
    /// A range that is none.
    #[error("colours from {0} to {1}: both must be finite, and the first below the second")]
    Range(f64, f64),
    /// A camera that sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Pixels of a gigabyte.
const MOST_PIXELS: usize = 1 << 28;

impl Plan<'_> {
    /// Fails where there is nothing to draw.
    pub fn check(&self) -> Result<(), RenderError> {
        self.camera.check()?;
        let [width, height] = self.size;
        if !((1..=65_535).contains(&width) && (1..=65_535).contains(&height)) || width * height > MOST_PIXELS
        {
            return Err(RenderError::Size(width, height));
        }
        if self.across == 0 {
            return Err(RenderError::NoSamples);
        }
        match self.range {
            Some([low, high]) if !(low < high && (high - low).is_finite()) => {
                Err(RenderError::Range(low, high))
            }
            _ => Ok(()),
        }
    }

    /// Pixels of the part that shows the surface; the rest is the scale bar's.
    pub fn view_size(&self) -> [usize; 2] {
        view_size(self.size, &self.shading)
    }
}

/// Pixels of the part of a picture that shows the surface: all of it, but for a strip where numbers are shown.
pub fn view_size([width, height]: [usize; 2], shading: &Shading<'_>) -> [usize; 2] {
    [width, height - if shading.has_numbers() { scale_bar::strip([width, height]) } else { 0 }]
}

/// Draws a surface. Progress counts rays. The same picture for any number of threads.
pub fn render(surface: &Surface<3>, plan: &Plan<'_>, run: &Run<'_>) -> Result<Picture, RenderError> {
    plan.check()?;
    let [width, height] = plan.view_size();
    let silent = run.silent();
    let easel = Easel { surface, plan, run: &silent, view: plan.camera.view(width, height) };
    let range = match plan.range {
        Some(range) => range,
        None => easel.range()?,
    };
    let colours = plan.shading.colours(range);
    let painter =
        Painter { lights: Lights::new(easel.view.axes()), colours: colours.as_ref(), relief: plan.relief };

    let mut image = Image::new(plan.size[0], plan.size[1], plan.background);
    let mut planes = (plan.planes == Keep::Yes).then(|| {
        let all = plan.size[0] * plan.size[1];
        Planes { depth: vec![f32::NAN; all], normal: vec![[f32::NAN; 3]; all] }
    });
    let samples = plan.across * plan.across;
    let total = width * height * samples;
    let (mut done, mut hits, mut missing) = (0, 0, Missing::None);
    for tile in tiles(width, height, samples) {
        let drawn = easel.draw(&tile, &painter)?;
        for (pixel, &(sum, count)) in tile.pixels().zip(&drawn.pixels) {
            let share = 1.0 / count.max(1) as f32;
            image.paint(pixel[0], pixel[1], sum.map(|c| c * share), count as f32 / samples as f32);
        }
        if let Some(planes) = &mut planes {
            easel.keep(&tile, planes)?;
        }
        hits += drawn.hits;
        if drawn.missing == Missing::Some {
            missing = Missing::Some;
        }
        done += tile.count() * samples;
        run.announce(Progress { done, total });
    }
    if let Some(colours) = &colours {
        let words = Words { title: &plan.title, missing, ink: plan.background.ink() };
        scale_bar::draw(&mut image, colours, &words);
    }
    Ok(Picture { image, planes, rays: total, hits, range: colours.is_some().then_some(range) })
}

/// A part of the picture, from and to these pixels.
#[derive(Clone, Copy, Debug)]
struct Tile {
    from: [usize; 2],
    to: [usize; 2],
    /// Pixels in a row of the picture.
    width: usize,
}

impl Tile {
    fn pixels(self) -> impl Iterator<Item = [usize; 2]> {
        (self.from[1]..self.to[1]).flat_map(move |y| (self.from[0]..self.to[0]).map(move |x| [x, y]))
    }

    fn count(self) -> usize {
        (self.to[0] - self.from[0]) * (self.to[1] - self.from[1])
    }
}

/// Square tiles, whose rays are near each other.
fn tiles(width: usize, height: usize, samples: usize) -> impl Iterator<Item = Tile> {
    let side = (MOST_RAYS / samples).isqrt().max(1);
    let corner = move |i: usize, most: usize| (i * side, ((i + 1) * side).min(most));
    (0..height.div_ceil(side)).flat_map(move |j| {
        (0..width.div_ceil(side)).map(move |i| {
            let ((left, right), (top, low)) = (corner(i, width), corner(j, height));
            Tile { from: [left, top], to: [right, low], width }
        })
    })
}

/// A tile as it was drawn.
struct Drawn {
    /// The sum of the colours that the rays found in each pixel, and how many they are.
    pixels: Vec<(Colour, usize)>,
    hits: usize,
    missing: Missing,
}

struct Easel<'e> {
    surface: &'e Surface<3>,
    plan: &'e Plan<'e>,
    run: &'e Run<'e>,
    view: Rays,
}

impl Easel<'_> {
    /// What these rays see, and which of them it is; `number` names the first one in the picture.
    fn look(&self, rays: &[Ray<3>], number: usize) -> Result<Vec<(usize, Seen)>, Cancelled> {
        let how = Cast::new().with_tolerance(TOLERANCE);
        let hits = self.surface.with(self.run).cast(rays, &how)?;
        let seen = |i: usize| {
            hits.status[i].is_ok().then(|| {
                let ahead = rays[i].direction;
                let seen = Seen {
                    point: hits.point[i],
                    normal: hits.surface_normal[i],
                    frame: hits.frame_normal[i],
                    gradient: hits.gradient[i],
                    to_eye: scale(unit(ahead), -1.0),
                    depth: hits.t[i],
                    number: number + i,
                };
                (i, seen)
            })
        };
        Ok((0..rays.len()).filter_map(seen).collect())
    }

    fn draw(&self, tile: &Tile, painter: &Painter<'_>) -> Result<Drawn, Cancelled> {
        let across = self.plan.across;
        let samples = across * across;
        let place = |i: usize| (i as f64 + 0.5) / across as f64;
        let rays: Vec<Ray<3>> = tile
            .pixels()
            .flat_map(|[x, y]| {
                (0..samples)
                    .map(move |k| self.view.ray(x as f64 + place(k % across), y as f64 + place(k / across)))
            })
            .collect();
        let number = (tile.from[1] * tile.width + tile.from[0]) * samples;
        let (which, seen): (Vec<usize>, Vec<Seen>) = self.look(&rays, number)?.into_iter().unzip();
        let shading = &self.plan.shading;
        let running = self.surface.with(self.run);
        let found = Found {
            numbers: shading.numbers(self.surface, self.run, &seen)?,
            own: shading.own_colours(self.surface, self.run, &seen)?,
            open: match &self.plan.occlusion {
                Some(how) => occlusion::open(&running, self.surface.support().median, how, &seen)?,
                None => Vec::new(),
            },
        };
        let colours = shading.paint(painter, &seen, &found);
        let mut pixels = vec![([0.0; 3], 0); tile.count()];
        for (ray, colour) in which.iter().zip(colours) {
            let (sum, count) = &mut pixels[ray / samples];
            (0..3).for_each(|k| sum[k] += colour[k]);
            *count += 1;
        }
        let missing = if found.numbers.iter().any(|v| v.is_nan()) { Missing::Some } else { Missing::None };
        Ok(Drawn { pixels, hits: seen.len(), missing })
    }

    /// Casts the rays through the middles of a tile's pixels into the planes.
    fn keep(&self, tile: &Tile, planes: &mut Planes) -> Result<(), Cancelled> {
        let pixels: Vec<[usize; 2]> = tile.pixels().collect();
        for some in pixels.chunks(MOST_RAYS) {
            let rays: Vec<Ray<3>> =
                some.iter().map(|&[x, y]| self.view.ray(x as f64 + 0.5, y as f64 + 0.5)).collect();
            for (i, seen) in self.look(&rays, 0)? {
                let pixel = some[i][1] * self.plan.size[0] + some[i][0];
                planes.depth[pixel] = seen.depth as f32;
                planes.normal[pixel] = seen.normal.map(|c| c as f32);
            }
        }
        Ok(())
    }

    /// The range of the numbers in a coarse picture.
    fn range(&self) -> Result<[f64; 2], Cancelled> {
        if !self.plan.shading.has_numbers() {
            return Ok([0.0, 1.0]);
        }
        let [width, height] = self.plan.view_size();
        let coarse = ((width * height) as f64 / SCOUTS as f64).sqrt().max(1.0);
        let [columns, rows] = [width, height].map(|side| ((side as f64 / coarse) as usize).max(1));
        let rays: Vec<Ray<3>> = (0..columns * rows)
            .map(|i| {
                let place =
                    |k: usize, count: usize, side: usize| (k as f64 + 0.5) / count as f64 * side as f64;
                self.view.ray(place(i % columns, columns, width), place(i / columns, rows, height))
            })
            .collect();
        let seen: Vec<Seen> = self.look(&rays, 0)?.into_iter().map(|(_, seen)| seen).collect();
        let numbers = self.plan.shading.numbers(self.surface, self.run, &seen)?;
        Ok(self.plan.shading.range_of(numbers))
    }
}

impl Planes {
    /// The least and the largest depth; NaN where nothing was found.
    pub fn depth_range(&self) -> [f32; 2] {
        let fold = |pick: fn(f32, f32) -> f32| self.depth.iter().copied().fold(f32::NAN, pick);
        [fold(f32::min), fold(f32::max)]
    }
}
