//! Arguments of `render`.

use super::common::Common;
use clap::{Args, ValueEnum};
use footpoint_jobs::{Background, Canvas, Relief, RenderPlan, Show, View, Wish, axis};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct RenderArguments {
    /// The cloud
    pub(crate) input: PathBuf,
    /// Picture to write, a PNG [default: the input's name with .png, in the current folder]
    #[arg(short, long)]
    pub(crate) output: Option<PathBuf>,
    /// What to show [default: surface; distance with --to, attribute with --attribute]
    #[arg(long, value_enum)]
    shading: Option<ShadingName>,
    /// Column to show: its weighted average around each point
    #[arg(long, value_name = "NAME")]
    attribute: Option<String>,
    /// Cloud whose surface distances are measured to
    #[arg(long, value_name = "CLOUD", conflicts_with = "attribute")]
    to: Option<PathBuf>,
    /// Numbers at the ends of the colours, in the unit of what is shown [default: from the picture, without the 2 % furthest out]
    #[arg(long, value_name = "LOW,HIGH", value_parser = pair, allow_hyphen_values = true, hide_short_help = true)]
    range: Option<[f64; 2]>,
    /// Give colours exactly as they are, in the file or in the scale bar, without light
    #[arg(long, hide_short_help = true)]
    flat: bool,
    /// Pixels: width and height, or the width at 4:3 [default: two million in the shape of what is shown]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, help_heading = "Picture")]
    size: Option<[usize; 2]>,
    /// Rays a pixel: 1, 4, 9, 16, …
    #[arg(long, value_name = "COUNT", default_value = "4", value_parser = square, help_heading = "Picture", hide_short_help = true)]
    samples: usize,
    /// What lies behind: `white`, `black`, `#rrggbb` or `transparent`
    #[arg(
        long,
        value_name = "COLOUR",
        default_value = "white",
        help_heading = "Picture",
        hide_short_help = true
    )]
    background: Background,
    /// Darken hollows: so many rays from every point that is seen (16 is smooth with --samples 4)
    #[arg(long, value_name = "RAYS", num_args = 0..=1, default_value_t = 0, default_missing_value = "16",
          help_heading = "Picture", hide_short_help = true)]
    occlusion: usize,
    /// Write depths too: PNG, 16 bits of grey; 0 is none, 1 the nearest, 65535 the farthest (see the report)
    #[arg(long, value_name = "FILE", help_heading = "Picture", hide_short_help = true)]
    depth: Option<PathBuf>,
    /// Write normals too: PNG, 16 bits each of red green blue for x y z from -1 to 1
    #[arg(long, value_name = "FILE", help_heading = "Picture", hide_short_help = true)]
    normals: Option<PathBuf>,
    /// Write too which pixels show the surface: PNG, 8 bits of grey, 255 or 0
    #[arg(long, value_name = "FILE", help_heading = "Picture", hide_short_help = true)]
    mask: Option<PathBuf>,
    /// From where to look [default: auto]
    #[arg(long, value_enum, conflicts_with = "look_from", help_heading = "Camera")]
    view: Option<ViewName>,
    /// Place of the eye, in the unit of the file
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, help_heading = "Camera")]
    look_from: Option<[f64; 3]>,
    /// What is in the middle of the picture [default: the middle of the cloud]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true, help_heading = "Camera", hide_short_help = true)]
    look_at: Option<[f64; 3]>,
    /// What is up: x, y, z, -y, or X,Y,Z [default: z for surveys, else by shape]
    ///
    /// All views go by it. z is up in LAS, LAZ, COPC, E57 and PTX files, where a reference system is stated,
    /// where x and y are as large as those of maps, and where the cloud is flat: such surveys are seen from
    /// above, y to the north. Else it is z, y or -y, by which end the cloud stands on and from where most of
    /// it is seen. The report tells which, and why.
    #[arg(
        long,
        visible_alias = "up",
        value_name = "AXIS",
        value_parser = upward,
        allow_hyphen_values = true,
        help_heading = "Camera",
        hide_short_help = true
    )]
    look_up: Option<[f64; 3]>,
    /// Perspective, or parallel rays
    #[arg(long, value_enum, default_value = "perspective", help_heading = "Camera", hide_short_help = true)]
    camera: CameraName,
    /// Angle of view from the lower to the upper edge, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = Wish::default().fov_degrees, allow_negative_numbers = true,
          help_heading = "Camera", hide_short_help = true)]
    fov: f64,
    /// Height that an orthographic picture shows, in the unit of the file [default: that of the cloud]
    #[arg(
        long,
        value_name = "LENGTH",
        allow_negative_numbers = true,
        help_heading = "Camera",
        hide_short_help = true
    )]
    view_height: Option<f64>,
    #[command(flatten)]
    pub(super) common: Common,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ShadingName {
    /// Light on the surface, by its exact normal
    Surface,
    /// Light on the surface, by the normal of the fitted frame
    Frame,
    /// n·∇f/|∇f|, the cosine of the angle between the two, in colours
    Difference,
    /// Mean curvature in colours: positive where the surface bulges out
    Curvature,
    /// Distance to the surface of --to CLOUD in colours
    Distance,
    /// A column in colours: --attribute NAME
    Attribute,
    /// The samples' own colours: columns red green blue
    Colour,
    /// x y z of the normal as red green blue
    Normal,
    /// Depth in colours
    Depth,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ViewName {
    /// As iso, unless much more is seen from elsewhere; a survey from above with north up, tilted a little
    Auto,
    /// From the front: -y where z is up, z where y is up
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
    /// From the front, right and above alike
    Iso,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CameraName {
    Perspective,
    Orthographic,
}

impl RenderArguments {
    /// The cloud, and the one that distances are measured to.
    pub(crate) fn plan(&self) -> Result<RenderPlan, String> {
        if self.view_height.is_some() && self.camera == CameraName::Perspective {
            return Err("--view-height belongs to --camera orthographic".to_owned());
        }
        let wish = Wish {
            view: self.view.map_or(View::Auto, ViewName::meaning),
            from: self.look_from,
            at: self.look_at,
            up: self.look_up,
            parallel: self.camera == CameraName::Orthographic,
            fov_degrees: self.fov,
            height: self.view_height,
            ..Wish::default()
        };
        let usual = RenderPlan::default();
        Ok(RenderPlan {
            show: self.show()?,
            wish,
            canvas: self.size.map_or(usual.canvas, Canvas::Given),
            across: self.samples.isqrt(),
            background: self.background,
            relief: if self.flat { Relief::Flat } else { Relief::Lit },
            occlusion: self.occlusion,
            range: self.range,
            depth: self.depth.clone(),
            normals: self.normals.clone(),
            mask: self.mask.clone(),
        })
    }

    fn show(&self) -> Result<Show, String> {
        Ok(match (self.shading, &self.to, &self.attribute) {
            (None | Some(ShadingName::Distance), Some(cloud), _) => Show::Distance(cloud.clone()),
            (None | Some(ShadingName::Attribute), _, Some(name)) => Show::Attribute(name.clone()),
            (Some(_), Some(_), _) => return Err("--to belongs to --shading distance".to_owned()),
            (Some(_), _, Some(_)) => return Err("--attribute belongs to --shading attribute".to_owned()),
            (Some(ShadingName::Distance), ..) => {
                return Err("--shading distance needs --to CLOUD".to_owned());
            }
            (Some(ShadingName::Attribute), ..) => {
                return Err("--shading attribute needs --attribute NAME".to_owned());
            }
            (None | Some(ShadingName::Surface), ..) => Show::Surface,
            (Some(ShadingName::Frame), ..) => Show::Frame,
            (Some(ShadingName::Difference), ..) => Show::Difference,
            (Some(ShadingName::Curvature), ..) => Show::Curvature,
            (Some(ShadingName::Colour), ..) => Show::Colour,
            (Some(ShadingName::Normal), ..) => Show::Normal,
            (Some(ShadingName::Depth), ..) => Show::Depth,
        })
    }
}

impl ViewName {
    fn meaning(self) -> View {
        match self {
            Self::Auto => View::Auto,
            Self::Front => View::Front,
            Self::Back => View::Back,
            Self::Left => View::Left,
            Self::Right => View::Right,
            Self::Top => View::Top,
            Self::Bottom => View::Bottom,
            Self::Iso => View::Iso,
        }
    }
}

/// Numbers by commas.
fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let parsed: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    parsed?.try_into().ok()
}

fn pair(text: &str) -> Result<[f64; 2], String> {
    numbers(text).ok_or_else(|| "it must be two numbers, such as 0,1".to_owned())
}

fn vector(text: &str) -> Result<[f64; 3], String> {
    numbers(text).ok_or_else(|| "it must be three numbers, such as 0,0,1".to_owned())
}

/// The name of an axis, or numbers.
fn upward(text: &str) -> Result<[f64; 3], String> {
    let problem = || "it must be x, y or z, -y, or three numbers, such as 0,0,1".to_owned();
    axis(text).or_else(|| numbers(text)).ok_or_else(problem)
}

/// `1600x1200` or `1600`.
fn size(text: &str) -> Result<[usize; 2], String> {
    let problem = || "it must be pixels, such as 1600x1200 or 1600".to_owned();
    let number = |word: &str| word.parse::<usize>().map_err(|_| problem());
    match text.split_once(['x', 'X', '×']) {
        Some((width, height)) => Ok([number(width)?, number(height)?]),
        None => number(text).map(|width| [width, (width * 3).div_ceil(4)]),
    }
}

/// The square of a number from 1 to 16.
fn square(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(count) if (1..=256).contains(&count) && count.isqrt().pow(2) == count => Ok(count),
        _ => Err("it must be a square: 1, 4, 9, 16, … 256".to_owned()),
    }
}
