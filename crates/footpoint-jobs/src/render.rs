//! Job: a picture of the surface.

use crate::clock::timed;
use crate::load::Loaded;
use crate::report::Report;
use crate::{Context, JobError, Stage};
use footpoint::{Run, Surface};
use footpoint_io::{Data, Overwrite, check_file, write_file};
use footpoint_render::{
    Aim, Background, Camera, Canvas, Extent, Keep, Occlusion, Picture, Plan, Relief, Shading, Upright, Wish,
    linear, render as draw, write_depth, write_image, write_mask, write_normals,
};
use serde::Serialize;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// What a picture shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Show {
    /// Light on the surface, by its exact normal.
    #[default]
    Surface,
    /// Light on the surface, by the frame normal.
    Frame,
    /// n·∇f/|∇f|.
    Difference,
    /// Mean curvature, one over the unit of the file.
    Curvature,
    /// Distance to the surface of another file's points, by the same recipe.
    Distance(PathBuf),
    /// The weighted average of a column.
    Attribute(String),
    /// The samples' own colours: columns `red green blue`, `r g b` or `diffuse_red …`.
    Colour,
    /// The surface normal, x y z as red green blue.
    Normal,
    /// Distance from the eye's plane.
    Depth,
}

/// What to draw, and what to write beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderPlan {
    /// What is shown.
    pub show: Show,
    /// From where.
    pub wish: Wish,
    /// How large it is.
    pub canvas: Canvas,
    /// Rays along each side of a pixel.
    pub across: usize,
    /// What lies behind.
    pub background: Background,
    /// Whether light falls on colours.
    pub relief: Relief,
    /// Rays for shadows in hollows, from every point that is seen; 0 for none.
    pub occlusion: usize,
    /// The numbers at the ends of the colours; found if not given.
    pub range: Option<[f64; 2]>,
    /// File for the depths, a PNG of 16 bits.
    pub depth: Option<PathBuf>,
    /// File for the normals, a PNG of 16 bits.
    pub normals: Option<PathBuf>,
    /// File for the pixels that hit, a PNG of 8 bits.
    pub mask: Option<PathBuf>,
}

impl Default for RenderPlan {
    /// The surface from the automatic view, on about 1600 × 1200 pixels of 4 rays in its own shape, on white.
    fn default() -> Self {
        Self {
            show: Show::Surface,
            wish: Wish::default(),
            canvas: Canvas::Shaped(1600 * 1200),
            across: 2,
            background: Background::default(),
            relief: Relief::Lit,
            occlusion: 0,
            range: None,
            depth: None,
            normals: None,
            mask: None,
        }
    }
}

impl RenderPlan {
    /// The files that are written, the picture first: the input's name with `.png` if `output` names none.
    pub(crate) fn files(&self, input: &Path, output: Option<&Path>) -> Vec<PathBuf> {
        let picture = output.map_or_else(|| picture_name(input), Path::to_owned);
        let planes = [&self.depth, &self.normals, &self.mask].into_iter().flatten();
        [picture].into_iter().chain(planes.cloned()).collect()
    }
}

/// What a picture shows and from where. Lengths are in the unit of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RenderReport {
    /// What is shown: `surface`, `difference`, …
    pub shading: &'static str,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rays a pixel.
    pub samples_per_pixel: usize,
    /// From where: as options it gives the same picture.
    pub camera: Camera,
    /// What is taken as up, and why.
    pub up: Upright,
    /// Rays cast, without those of occlusion.
    pub rays: usize,
    /// Rays that met the surface.
    pub hits: usize,
    /// Rays over the wall seconds of `draw`, shading included.
    pub rays_per_second: f64,
    /// The numbers at the ends of the colours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// The depths that the depth file has as 1 and 65535.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_range: Option<[f32; 2]>,
}

/// How far the sky reaches that occlusion looks for, in diagonals of the cloud.
const SKY: f64 = 0.15;

/// Draws the surface of `input` into `output`, by default the input's name with `.png` in the current folder.
///
/// Fails on 2-D points, and where no ray meets the surface.
pub fn render(
    input: &Path,
    output: Option<&Path>,
    plan: &RenderPlan,
    context: &Context<'_>,
) -> Result<Report, JobError> {
    let files = plan.files(input, output);
    let output = &files[0];
    for (i, file) in files.iter().enumerate() {
        check_picture(file, context.overwrite)?;
        if files[..i].contains(file) {
            return Err(JobError::SameFile(file.display().to_string()));
        }
    }
    let mut report = Report::new("render", context.recipe.clone());
    let loaded = Loaded::read(input, context, &mut report)?;
    report.inputs.push(loaded.report());
    loaded.check_space()?;
    let other = match &plan.show {
        Show::Distance(path) => {
            let other = Loaded::read(path, context, &mut report)?;
            report.inputs.push(other.report());
            loaded.check_dimension(&other)?;
            Some(other)
        }
        _ => None,
    };
    let values = match &plan.show {
        Show::Attribute(name) => loaded.column(name)?,
        _ => Vec::new(),
    };
    let colours = match plan.show {
        Show::Colour => colours(&loaded)?,
        _ => Vec::new(),
    };
    if let Some(other) = other.as_ref().filter(|_| context.is_dry()) {
        other.check_columns(&context.recipe)?;
    }
    if context.ends_before(&loaded, &files, &mut report)? {
        return Ok(report);
    }
    let other = other.map(|other| other.surface::<3>(context, &mut report)).transpose()?;
    let surface = loaded.surface::<3>(context, &mut report)?;
    let shading = match &plan.show {
        Show::Surface => Shading::Surface,
        Show::Frame => Shading::Frame,
        Show::Difference => Shading::Difference,
        Show::Curvature => Shading::Curvature,
        Show::Distance(_) => other.as_ref().map_or(Shading::Surface, Shading::Distance),
        Show::Attribute(_) => Shading::Attribute(&values),
        Show::Colour => Shading::Colour(&colours),
        Show::Normal => Shading::Normal,
        Show::Depth => Shading::Depth,
    };
    let title = match &plan.show {
        Show::Attribute(name) => name,
        _ => title(&shading),
    };
    context.begin(Stage::Draw);
    let plan = &RenderPlan { wish: Wish { origin: loaded.origin(), ..plan.wish }, ..plan.clone() };
    let (aim, picture) = timed(&mut report.times.draw, || {
        picture(&surface, plan, (shading, title), &context.run).map_err(|error| loaded.render_error(error))
    })?;
    if picture.hits == 0 {
        return Err(JobError::NothingHit(input.display().to_string()));
    }
    let seconds = report.times.draw.wall_seconds;
    report.points = picture.rays;
    report.points_per_second = if seconds > 0.0 { picture.rays as f64 / seconds } else { 0.0 };
    report.render = Some(RenderReport {
        shading: name(&shading),
        width: aim.size[0],
        height: aim.size[1],
        samples_per_pixel: plan.across * plan.across,
        camera: aim.camera,
        up: aim.upright,
        rays: picture.rays,
        hits: picture.hits,
        rays_per_second: report.points_per_second,
        range: picture.range,
        depth_range: plan.depth.as_ref().and(picture.planes.as_ref()).map(|planes| planes.depth_range()),
    });
    write_all(&mut report, &picture, (output, plan, aim.size), context)?;
    Ok(report)
}

/// From where, and the picture: what [`render`] draws and writes, of a surface in memory. The plan's `show`
/// and its files are not looked at; the shading says what is shown, with a title for numbers.
pub fn picture(
    surface: &Surface<3>,
    plan: &RenderPlan,
    (shading, title): (Shading<'_>, &str),
    run: &Run<'_>,
) -> Result<(Aim, Picture), footpoint_render::RenderError> {
    let extent = Extent::new(surface);
    let aim = extent.aim(&plan.wish, plan.canvas, &shading)?;
    let wants_planes = plan.depth.is_some() || plan.normals.is_some() || plan.mask.is_some();
    let drawing = Plan {
        camera: aim.camera,
        size: aim.size,
        across: plan.across,
        shading,
        relief: plan.relief,
        background: plan.background,
        occlusion: (plan.occlusion > 0)
            .then(|| Occlusion { rays: plan.occlusion, reach: SKY * extent.size() }),
        range: plan.range,
        title: title.to_owned(),
        planes: if wants_planes { Keep::Yes } else { Keep::No },
    };
    Ok((aim, draw(surface, &drawing, run)?))
}

/// The direction of a word: `x`, `y` or `z`, and against it with a minus before.
pub fn axis(word: &str) -> Option<[f64; 3]> {
    let (sign, letter) = word.strip_prefix('-').map_or((1.0, word), |letter| (-1.0, letter));
    let place = ["x", "y", "z"].iter().position(|name| *name == letter)?;
    let mut axis = [0.0; 3];
    axis[place] = sign;
    Some(axis)
}

/// What reports call a shading.
fn name(shading: &Shading<'_>) -> &'static str {
    match shading {
        Shading::Surface => "surface",
        Shading::Frame => "frame",
        Shading::Difference => "difference",
        Shading::Curvature => "curvature",
        Shading::Distance(_) => "distance",
        Shading::Attribute(_) => "attribute",
        Shading::Colour(_) => "colour",
        Shading::Normal => "normal",
        Shading::Depth => "depth",
        _ => "other",
    }
}

/// What stands above the scale bar of a shading; that of an attribute has its column's name.
pub fn title(shading: &Shading<'_>) -> &'static str {
    match shading {
        Shading::Difference => "n·∇f/|∇f|",
        Shading::Curvature => "mean curvature",
        Shading::Distance(_) => "distance",
        Shading::Depth => "depth",
        _ => "",
    }
}

fn write_all(
    report: &mut Report,
    picture: &Picture,
    (output, plan, size): (&Path, &RenderPlan, [usize; 2]),
    context: &Context<'_>,
) -> Result<(), JobError> {
    put(report, output, context, &|out| write_image(&picture.image, out))?;
    let Some(planes) = &picture.planes else { return Ok(()) };
    if let Some(path) = &plan.depth {
        put(report, path, context, &|out| write_depth(planes, size, out))?;
    }
    if let Some(path) = &plan.normals {
        put(report, path, context, &|out| write_normals(planes, size, out))?;
    }
    if let Some(path) = &plan.mask {
        put(report, path, context, &|out| write_mask(planes, size, out))?;
    }
    Ok(())
}

/// Writes one picture file.
pub(crate) fn put(
    report: &mut Report,
    path: &Path,
    context: &Context<'_>,
    fill: &dyn Fn(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), JobError> {
    timed(&mut report.times.write, || write_picture(path, context.overwrite, fill))?;
    report.wrote(path);
    Ok(())
}

/// Writes what `fill` gives to a file, which is complete or not there.
pub fn write_picture(
    path: &Path,
    overwrite: Overwrite,
    fill: &dyn Fn(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), JobError> {
    Ok(write_file(path, overwrite, |file| {
        let mut out = BufWriter::new(file);
        fill(&mut out)?;
        out.flush()
    })?)
}

/// Fails, before any work is done, where no picture could be put at `path`.
pub fn check_picture(path: &Path, overwrite: Overwrite) -> Result<(), JobError> {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("png") => Ok(check_file(path, overwrite)?),
        _ => Err(JobError::NotPng(path.display().to_string())),
    }
}

/// `scan.png` for `folder/scan.ply` and for `folder/scan.ply.gz`.
fn picture_name(input: &Path) -> PathBuf {
    let without = |name: &Path| name.file_stem().map_or_else(|| PathBuf::from("picture"), PathBuf::from);
    let packed = input.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let stem = if packed { without(&without(input)) } else { without(input) };
    let mut name = stem.into_os_string();
    name.push(".png");
    PathBuf::from(name)
}

/// The samples' colours in linear light from 0 to 1. Integers are shares of the largest of their type, other numbers of 255 if
/// one is above 1.
fn colours(loaded: &Loaded) -> Result<Vec<[f64; 3]>, JobError> {
    let table = &loaded.input.table;
    let families =
        [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];
    let has = |name: &&str| table.column(name).is_some();
    let family = families.into_iter().find(|family| family.iter().all(has)).unwrap_or(families[0]);
    let mut columns = Vec::new();
    for name in family {
        columns.push((loaded.column(name)?, table.column(name).map(|column| &column.data)));
    }
    let whole = columns.iter().flat_map(|(values, _)| values).any(|&v| v > 1.0);
    let most = |data: Option<&Data>| match data {
        Some(Data::U16(_)) => 65_535.0,
        Some(Data::U8(_)) => 255.0,
        _ if whole => 255.0,
        _ => 1.0,
    };
    let share = |(values, data): &(Vec<f64>, Option<&Data>), i: usize| {
        f64::from(linear((values[i] / most(*data)) as f32))
    };
    Ok((0..table.rows()).map(|i| std::array::from_fn(|k| share(&columns[k], i))).collect())
}
