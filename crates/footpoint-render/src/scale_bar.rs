//! The scale bar below a picture: which colour stands for which number.

use crate::colour::{Colour, Colours, NO_NUMBER};
use crate::font;
use crate::image::Image;

/// Most numbers along the bar.
const MOST_TICKS: usize = 7;
/// Part of the picture's width that the bar takes.
const PART: f64 = 0.6;
/// Height of the strip in heights of its capitals.
const LINES: f64 = 5.6;

/// Rows that count for the size of text, in widths: a high picture has no room for large words.
const HIGHEST: f64 = 1.6;

/// Height of capitals in a picture of so many pixels.
pub(crate) fn text_size([width, rows]: [usize; 2]) -> f64 {
    ((rows as f64).min(HIGHEST * width as f64) / 44.0).clamp(6.0, 60.0)
}

/// Rows that the strip takes off a picture of so many pixels: less than half.
pub(crate) fn strip([width, rows]: [usize; 2]) -> usize {
    ((LINES * text_size([width, rows])).ceil() as usize).min(rows.saturating_sub(1) / 2)
}

/// Rows of a picture that leave so many to the surface. A strip is a share of the whole height, so they are
/// sought.
pub(crate) fn rows_around([width, view]: [usize; 2]) -> usize {
    (view..2 * view + 100).find(|&all| all - strip([width, all]) >= view).unwrap_or(view)
}

/// Whether some points have no number, so that the bar explains their colour too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Missing {
    None,
    Some,
}

/// What is written at a bar.
pub(crate) struct Words<'w> {
    pub(crate) title: &'w str,
    pub(crate) missing: Missing,
    pub(crate) ink: Colour,
}

/// Draws the bar into the lowest rows of a picture.
pub(crate) fn draw(image: &mut Image, colours: &Colours, words: &Words<'_>) {
    let size = text_size([image.width(), image.height()]);
    let top = (image.height() - strip([image.width(), image.height()])) as f64;
    let (wide, ink) = (image.width() as f64, words.ink);
    let left = (0.5 * (1.0 - PART) * wide).round();
    let right = (wide - left).max(left + 1.0);
    caption(image, words.title, top, ink);
    let (bar_top, bar_low) = ((top + 2.1 * size).round(), (top + 3.1 * size).round());
    let [low, high] = colours.range();
    for x in left as usize..(right as usize).min(image.width()) {
        let share = (x as f64 + 0.5 - left) / (right - left);
        let colour = colours.of(low + share * (high - low));
        for y in bar_top as usize..(bar_low as usize).min(image.height()) {
            image.paint(x, y, colour, 1.0);
        }
    }
    let step = step_of(high - low, most_ticks(low, high, (right - left) / size));
    let half = (0.06 * size).max(0.5);
    for value in ticks(low, high, step) {
        let share = if high > low { (value - low) / (high - low) } else { 0.5 };
        let at = left + share * (right - left);
        rectangle(image, [at - half, bar_low], [at + half, bar_low + 0.35 * size], ink);
        let text = label(value, step, low.abs().max(high.abs()));
        let start = at - 0.5 * font::width(&text, size);
        font::write(image, &text, [start, bar_low + 1.75 * size], size, ink);
    }
    if words.missing == Missing::Some {
        let start = right + size;
        rectangle(image, [start, bar_top], [start + size, bar_low], NO_NUMBER);
        font::write(image, "none", [start + 1.5 * size, bar_low], size, ink);
    }
}

/// Writes what a picture shows above its bar, or where that would be; `top` is the strip's first row.
pub(crate) fn caption(image: &mut Image, text: &str, top: f64, ink: Colour) {
    let size = text_size([image.width(), image.height()]);
    let start = 0.5 * (image.width() as f64 - font::width(text, size));
    font::write(image, text, [start.max(0.0), top + 1.5 * size], size, ink);
}

/// Fills a rectangle whose corners are in pixels, edges blended.
fn rectangle(image: &mut Image, low: [f64; 2], high: [f64; 2], ink: Colour) {
    let cover =
        |low: f64, high: f64, i: usize| (high.min(i as f64 + 1.0) - low.max(i as f64)).clamp(0.0, 1.0);
    let to = [image.width(), image.height()];
    let range = |k: usize| low[k].max(0.0) as usize..(high[k].max(0.0).ceil() as usize).min(to[k]);
    for y in range(1) {
        for x in range(0) {
            image.paint(x, y, ink, (cover(low[0], high[0], x) * cover(low[1], high[1], y)) as f32);
        }
    }
}

/// So many that the widest label leaves room for a blank between any two.
fn most_ticks(low: f64, high: f64, room: f64) -> usize {
    let step = step_of(high - low, MOST_TICKS);
    let largest = low.abs().max(high.abs());
    let widest = ticks(low, high, step)
        .iter()
        .map(|&v| font::width(&label(v, step, largest), 1.0))
        .fold(1.0, f64::max);
    ((room / (widest + 1.5)) as usize).clamp(1, MOST_TICKS)
}

/// 1, 2 or 5 times a power of ten, so that about as many as allowed fit into the width.
fn step_of(width: f64, most: usize) -> f64 {
    if !(width > 0.0 && width.is_finite()) {
        return 1.0;
    }
    let least = width / most as f64;
    let power = 10.0_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|&s| s >= least * (1.0 - 1e-9)).unwrap_or(least)
}

/// The multiples of the step in the range; the one number of a range without width.
fn ticks(low: f64, high: f64, step: f64) -> Vec<f64> {
    if high.partial_cmp(&low) != Some(std::cmp::Ordering::Greater) {
        return vec![low];
    }
    let first = (low / step - 1e-6).ceil();
    let count = ((high / step + 1e-6).floor() - first) as usize;
    (0..=count.min(2 * MOST_TICKS)).map(|i| (first + i as f64) * step).collect()
}

/// A number with the digits that its step needs.
fn label(value: f64, step: f64, largest: f64) -> String {
    let digits = |unit: f64| (unit.log10() - step.log10()).ceil().clamp(0.0, 12.0) as usize;
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&largest) {
        format!("{value:.*}", digits(1.0))
    } else {
        format!("{value:.*e}", digits(10.0_f64.powf(value.abs().log10().floor())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        let step = step_of(high - low, MOST_TICKS);
        ticks(low, high, step).into_iter().map(|v| label(v, step, low.abs().max(high.abs()))).collect()
    }

    #[test]
    fn numbers_along_the_bar_are_round() {
        assert_eq!(labels(-1.3, 1.3), ["-1.0", "-0.5", "0", "0.5", "1.0"]);
        assert_eq!(labels(0.93, 1.0), ["0.93", "0.94", "0.95", "0.96", "0.97", "0.98", "0.99", "1.00"]);
        assert_eq!(labels(0.0, 2.4e-5), ["0", "5e-6", "1.0e-5", "1.5e-5", "2.0e-5"]);
        assert_eq!(labels(3.0, 3.0), ["3"]);
        assert_eq!(labels(0.0, 4e6), ["0", "1e6", "2e6", "3e6", "4e6"]);
    }
}
