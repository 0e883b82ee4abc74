//! Pictures as arrays of bytes.

use crate::arrays::{Answers, Doubles, numbers, rows};
use crate::errors::{of_file, of_render, wrong};
use crate::options::Options;
use crate::work::How;
use footpoint::Surface;
use footpoint_jobs::{
    Canvas, JobError, Overwrite, RenderPlan, axis, check_picture, origin_of, picture, title, write_picture,
};
use footpoint_render::{Background, Picture, Relief, RenderError, Shading, View, Wish, linear, write_image};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// The picture's bytes, width and height. `values` are one number or one colour a sample, where the shading wants them.
pub(crate) fn render<'py>(
    py: Python<'py>,
    (surface, to, values): (&Surface<3>, Option<&Surface<3>>, Option<&Doubles<'py>>),
    options: &Options<'_, 'py>,
    how: &How,
) -> PyResult<Bound<'py, PyDict>> {
    let plan = plan(options)?;
    let word = options.get::<String>("shading", "a word")?.unwrap_or_else(|| "surface".to_owned());
    let colours: Vec<[f64; 3]>;
    let shading = match (word.as_str(), to, values) {
        ("surface", ..) => Shading::Surface,
        ("frame", ..) => Shading::Frame,
        ("difference", ..) => Shading::Difference,
        ("curvature", ..) => Shading::Curvature,
        ("normal", ..) => Shading::Normal,
        ("depth", ..) => Shading::Depth,
        ("distance", Some(to), _) => Shading::Distance(to),
        ("attribute", _, Some(values)) => Shading::Attribute(numbers(values)?),
        ("colour", _, Some(values)) => {
            let shares = rows::<3>(values)?.iter();
            colours = shares.map(|rgb| rgb.map(|share| f64::from(linear(share as f32)))).collect();
            Shading::Colour(&colours)
        }
        _ => {
            let known = "surface, frame, difference, curvature, normal, depth, distance (with to=), attribute \
                         (with attribute=), colour (with colours=)";
            return Err(wrong("shading", format!("\"{word}\" is none of {known}")));
        }
    };
    let overwrite = if options.is_set("overwrite")? { Overwrite::Replace } else { Overwrite::Refuse };
    let path = options.get::<PathBuf>("path", "a path")?;
    if let Some(path) = &path {
        check_picture(path, overwrite).map_err(of_picture_file)?;
    }
    let name = options.get::<String>("title", "a text")?;
    let title = name.as_deref().unwrap_or_else(|| title(&shading));
    let found = how.run(py, usize::MAX, |run| picture(surface, &plan, (shading, title), run))?;
    let (_, picture) = found.map_err(|problem| match problem {
        RenderError::Cancelled(_) => crate::surface::interrupted(),
        problem => of_render(&problem),
    })?;
    if picture.hits == 0 {
        return Err(PyValueError::new_err(
            "no ray met the surface: look from elsewhere (view, look_from, look_at), or widen the support (auto, per_sample)",
        ));
    }
    if let Some(path) = &path {
        let written = py.detach(|| write_picture(path, overwrite, &|out| write_image(&picture.image, out)));
        written.map_err(of_picture_file)?;
    }
    let answers = Answers::new(py);
    answers.put("image", bytes(&picture, plan.background))?;
    answers.0.set_item("width", picture.image.width())?;
    answers.0.set_item("height", picture.image.height())?;
    Ok(answers.0)
}

fn of_picture_file(problem: JobError) -> PyErr {
    if let JobError::NotPng(_) = problem { wrong("path", problem) } else { of_file(problem) }
}

/// Red green blue, and alpha where the background is transparent.
fn bytes(picture: &Picture, background: Background) -> Vec<u8> {
    let pixels = picture.image.pixels();
    match background {
        Background::Transparent => pixels.as_flattened().to_vec(),
        _ => pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
    }
}

/// Pixels of a picture whose size is not given.
const PIXELS: usize = 800 * 600;

/// The name of an axis, or a direction.
fn upward(options: &Options<'_, '_>) -> PyResult<Option<[f64; 3]>> {
    match options.get::<String>("look_up", "a word") {
        Ok(Some(word)) => axis(&word)
            .map(Some)
            .ok_or_else(|| wrong("look_up", format!("\"{word}\" is none of x, y, z, -x, -y, -z"))),
        _ => options.get("look_up", "the name of an axis, or three numbers"),
    }
}

fn plan(options: &Options<'_, '_>) -> PyResult<RenderPlan> {
    let usual = RenderPlan::default();
    let views = [
        ("auto", View::Auto),
        ("front", View::Front),
        ("back", View::Back),
        ("left", View::Left),
        ("right", View::Right),
        ("top", View::Top),
        ("bottom", View::Bottom),
        ("iso", View::Iso),
    ];
    let parallel = options.choice("camera", &[("perspective", false), ("orthographic", true)])?;
    let wish = Wish {
        view: options.choice("view", &views)?.unwrap_or_default(),
        from: options.vector("look_from")?,
        at: options.vector("look_at")?,
        up: upward(options)?,
        origin: origin_of(options.get::<String>("format", "a word")?.as_deref(), options.is_set("has_crs")?),
        parallel: parallel.unwrap_or(false),
        fov_degrees: options.number("fov")?.unwrap_or(usual.wish.fov_degrees),
        height: options.number("view_height")?,
    };
    if wish.height.is_some() && !wish.parallel {
        return Err(wrong("view_height", "it belongs to camera=\"orthographic\""));
    }
    let samples = options.whole("samples", "1, 4, 9, 16, … 256")?.unwrap_or(4);
    if !(1..=256).contains(&samples) || samples.isqrt().pow(2) != samples {
        return Err(wrong("samples", format!("{samples} is no square from 1 to 256")));
    }
    let background = options.get::<String>("background", "a word")?;
    let background = background.map_or(Ok(usual.background), |word| {
        word.parse().map_err(|problem| wrong("background", format!("\"{word}\": {problem}")))
    })?;
    let size = options.get("size", "two numbers of pixels")?;
    Ok(RenderPlan {
        wish,
        canvas: size.map_or(Canvas::Shaped(PIXELS), Canvas::Given),
        across: samples.isqrt(),
        background,
        relief: if options.is_set("flat")? { Relief::Flat } else { Relief::Lit },
        occlusion: options.whole("occlusion", "a number of rays")?.unwrap_or(0),
        range: options.get("range", "two numbers")?,
        ..usual
    })
}
