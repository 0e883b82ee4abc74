//! Pictures as PNG: 8 bits with alpha, and 16 bits for depth and normals.

use crate::image::Image;
use crate::picture::Planes;
use png::{BitDepth, ColorType, Encoder, SrgbRenderingIntent};
use std::io::{self, Write};

/// The picture: 8 bits, sRGB with alpha.
pub fn write_image(image: &Image, out: impl Write) -> io::Result<()> {
    let mut encoder = encoder(out, [image.width(), image.height()]);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    finish(encoder, image.pixels().as_flattened())
}

/// Depths: 16 bits of grey, 0 where nothing was hit, else 1 for the nearest to 65535 for the farthest, evenly. The text chunks
/// `near` and `far` of the file say which depths these are.
pub fn write_depth(planes: &Planes, size: [usize; 2], out: impl Write) -> io::Result<()> {
    let [near, far] = planes.depth_range();
    let mut encoder = encoder(out, size);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    for (name, depth) in [("near", near), ("far", far)] {
        encoder.add_text_chunk(name.to_owned(), depth.to_string())?;
    }
    let grey = |&depth: &f32| {
        if depth.is_nan() {
            return 0;
        }
        let share = if far > near { (depth - near) / (far - near) } else { 0.0 };
        1 + (65_534.0 * share).round() as u16
    };
    let bytes: Vec<u8> = planes.depth.iter().flat_map(|depth| grey(depth).to_be_bytes()).collect();
    finish(encoder, &bytes)
}

/// Normals in the cloud's axes: 16 bits of red green blue for x y z, 0 for −1 and 65535 for 1; all 0 where nothing was hit.
pub fn write_normals(planes: &Planes, size: [usize; 2], out: impl Write) -> io::Result<()> {
    let mut encoder = encoder(out, size);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Sixteen);
    // A number that does not exist becomes 0.
    let level = |c: f32| (65_535.0 * (0.5 + 0.5 * c)).round() as u16;
    let bytes: Vec<u8> = planes.normal.iter().flatten().flat_map(|&c| level(c).to_be_bytes()).collect();
    finish(encoder, &bytes)
}

/// Which pixels' middles hit: 8 bits of grey, 255 for a hit and 0 for none.
pub fn write_mask(planes: &Planes, size: [usize; 2], out: impl Write) -> io::Result<()> {
    let mut encoder = encoder(out, size);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    let bytes: Vec<u8> = planes.depth.iter().map(|depth| if depth.is_nan() { 0 } else { 255 }).collect();
    finish(encoder, &bytes)
}

fn encoder<'a, W: Write>(out: W, [width, height]: [usize; 2]) -> Encoder<'a, W> {
    // Pictures have at most 65,535 pixels a side.
    Encoder::new(out, width as u32, height as u32)
}

fn finish(encoder: Encoder<'_, impl Write>, bytes: &[u8]) -> io::Result<()> {
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    Ok(writer.finish()?)
}
