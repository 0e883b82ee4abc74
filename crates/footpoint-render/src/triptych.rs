//! The paper's figure 3: one surface shaded by n, by ∇f, and the cosine of the angle between the two.

use crate::camera::Camera;
use crate::canvas::{Aim, Canvas};
use crate::colour::Background;
use crate::image::Image;
use crate::picture::{Keep, Plan, RenderError, render};
use crate::scale_bar;
use crate::shading::{Relief, Shading};
use crate::upright::Upright;
use crate::view::{Extent, Wish};
use footpoint::{Progress, Run, Surface};

/// Three pictures side by side and what is to be said of them.
#[derive(Clone, Debug)]
pub struct Triptych {
    /// The pictures: by n, by ∇f, and n·∇f/|∇f| with its scale bar.
    pub image: Image,
    /// The camera of all three.
    pub camera: Camera,
    /// What is up in the cloud.
    pub upright: Upright,
    /// Rays cast.
    pub rays: usize,
    /// Rays that met the surface.
    pub hits: usize,
    /// The cosines at the ends of the colours.
    pub range: [f64; 2],
}

/// Draws the three pictures, each of `panel` pixels without its caption, on white.
pub fn triptych(
    surface: &Surface<3>,
    wish: &Wish,
    (panel, across): ([usize; 2], usize),
    run: &Run<'_>,
) -> Result<Triptych, RenderError> {
    let Aim { camera, upright, .. } =
        Extent::new(surface).aim(wish, Canvas::Given(panel), &Shading::Surface)?;
    let height = scale_bar::rows_around(panel);
    let background = Background::default();
    let mut image = Image::new(3 * panel[0], height, background);
    let shown = [
        (Shading::Frame, "(a) shaded by n", panel),
        (Shading::Surface, "(b) shaded by ∇f", panel),
        (Shading::Difference, "(c) n·∇f/|∇f|", [panel[0], height]),
    ];
    let (mut rays, mut hits, mut range) = (0, 0, [f64::NAN; 2]);
    for (i, (shading, title, size)) in shown.into_iter().enumerate() {
        let plan = Plan {
            camera,
            size,
            across,
            shading,
            relief: Relief::Flat,
            background,
            occlusion: None,
            range: None,
            title: title.to_owned(),
            planes: Keep::No,
        };
        let progress =
            |p: Progress| run.announce(Progress { done: i * p.total + p.done, total: 3 * p.total });
        let picture = render(surface, &plan, &run.silent().progress(&progress))?;
        image.put(&picture.image, i * panel[0], 0);
        if picture.range.is_none() {
            let mut caption = Image::new(panel[0], height, background);
            scale_bar::caption(&mut caption, title, panel[1] as f64, background.ink());
            image.put(&caption, i * panel[0], panel[1]);
        }
        rays += picture.rays;
        hits += picture.hits;
        range = picture.range.unwrap_or(range);
    }
    Ok(Triptych { image, camera, upright, rays, hits, range })
}
