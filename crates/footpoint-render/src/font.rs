//! A font of strokes, for the few words and numbers in a picture: legible at any size, and nobody's licence.

use crate::image::Image;

/// Height of capitals, and how thick strokes are, in units of the glyphs' grid.
const CAPITAL: f64 = 6.0;
const THICKNESS: f64 = 0.8;
/// Between two letters.
const GAP: f64 = 1.7;
/// Pieces that a bend is drawn in.
const PIECES: usize = 6;

/// A letter's width, and its strokes: points as two digits x y, capitals from y = 2 to 8; `~` begins a stroke whose points
/// are the controls of a smooth curve.
fn glyph(letter: char) -> &'static str {
    match letter {
        ' ' => "2",
        '0' | 'O' => "4 ~02 42 48 08 02",
        '1' => "2 07 28 22",
        '2' => "4 ~07 08 48 46 02 | 02 42",
        '3' => "4 ~07 08 48 45 25 ~25 45 42 02 03",
        '4' => "4 32 38 04 44",
        '5' => "4 48 08 05 ~05 26 46 42 02 03",
        '6' => "4 ~38 08 02 42 46 06 04",
        '7' => "4 08 48 12",
        '8' => "4 ~05 45 48 08 05 ~02 42 45 05 02",
        '9' => "4 ~12 42 48 08 04 44 46",
        '.' => "0 02 02",
        ',' => "1 12 01",
        ':' => "0 02 02 | 05 05",
        '-' | '−' => "3 05 35",
        '+' => "4 05 45 | 23 27",
        '=' => "4 04 44 | 06 46",
        '/' => "3 01 39",
        '%' => "4 02 48 ~07 17 18 08 07 ~32 42 43 33 32",
        '(' => "2 ~29 07 03 21",
        ')' => "2 ~09 27 23 01",
        '_' => "4 01 41",
        '|' => "0 01 09",
        '·' => "0 05 05",
        '∇' => "4 08 48 22 08",
        'A' => "4 02 28 42 | 14 34",
        'B' => "4 02 08 ~08 48 45 05 ~05 45 42 02",
        'C' => "4 ~47 48 08 02 42 43",
        'D' => "4 02 08 ~08 48 42 02",
        'E' => "4 48 08 02 42 | 05 35",
        'F' => "4 48 08 02 | 05 35",
        'G' => "4 ~47 48 08 02 42 44 | 44 24",
        'H' => "4 02 08 | 42 48 | 05 45",
        'I' => "0 02 08",
        'J' => "3 38 34 ~34 32 02 04",
        'K' => "4 02 08 | 48 05 42",
        'L' => "4 08 02 42",
        'M' => "4 02 08 24 48 42",
        'N' => "4 02 08 42 48",
        'P' => "4 02 08 ~08 48 45 05",
        'Q' => "4 ~02 42 48 08 02 | 24 42",
        'R' => "4 02 08 ~08 48 45 05 | 25 42",
        'S' => "4 ~47 48 08 05 45 42 02 03",
        'T' => "4 08 48 | 28 22",
        'U' => "4 08 04 ~04 02 42 44 | 44 48",
        'V' => "4 08 22 48",
        'W' => "4 08 12 26 32 48",
        'X' => "4 02 48 | 08 42",
        'Y' => "4 08 25 48 | 25 22",
        'Z' => "4 08 48 02 42",
        'a' => "3 ~02 32 36 06 02 | 36 32",
        'b' => "3 ~02 32 36 06 02 | 08 02",
        'c' => "3 ~35 36 06 02 32 33",
        'd' => "3 ~02 32 36 06 02 | 38 32",
        'e' => "3 04 34 ~34 36 06 02 32 33",
        'f' => "2 ~28 18 16 | 16 12 | 06 26",
        'g' => "3 ~02 32 36 06 02 | 36 32 ~32 30 00 01",
        'h' => "3 08 02 ~04 06 36 34 | 34 32",
        'i' => "0 06 02 | 08 08",
        'j' => "1 16 12 ~12 10 00 | 18 18",
        'k' => "3 08 02 | 36 04 32",
        'l' => "0 08 02",
        'm' => "4 06 02 ~04 06 26 24 | 24 22 ~24 26 46 44 | 44 42",
        'n' => "3 06 02 ~04 06 36 34 | 34 32",
        'o' => "3 ~02 32 36 06 02",
        'p' => "3 ~02 32 36 06 02 | 06 00",
        'q' => "3 ~02 32 36 06 02 | 36 30",
        'r' => "2 06 02 ~04 06 26",
        's' => "3 ~35 36 06 04 34 32 02 03",
        't' => "2 18 14 ~14 12 22 | 06 26",
        'u' => "3 06 04 ~04 02 32 34 | 36 32",
        'v' => "4 06 22 46",
        'w' => "4 06 12 25 32 46",
        'x' => "3 02 36 | 06 32",
        'y' => "4 06 22 | 46 10",
        'z' => "3 06 36 02 32",
        // What the font does not have is a box.
        _ => "4 02 42 48 08 02",
    }
}

type Point = [f64; 2];

/// Width of a letter and its strokes as broken lines.
fn strokes(letter: char) -> (f64, Vec<Vec<Point>>) {
    let mut words = glyph(letter).split(' ');
    let digit = |c: Option<char>| c.and_then(|c| c.to_digit(10)).map_or(0.0, f64::from);
    let width = digit(words.next().and_then(|w| w.chars().next()));
    // Each stroke with whether it is smooth.
    let mut found: Vec<(bool, Vec<Point>)> = Vec::new();
    for word in words {
        if word == "|" {
            found.push((false, Vec::new()));
            continue;
        }
        let smooth = word.starts_with('~');
        if smooth || found.is_empty() {
            found.push((smooth, Vec::new()));
        }
        let mut digits = word.trim_start_matches('~').chars();
        if let Some((_, points)) = found.last_mut() {
            points.push([digit(digits.next()), digit(digits.next())]);
        }
    }
    let lines = found.into_iter().map(|(smooth, points)| if smooth { bend(&points) } else { points });
    (width, lines.collect())
}

/// The quadratic spline with these controls: it begins and ends at the first and last, or is closed where they are the same.
fn bend(controls: &[Point]) -> Vec<Point> {
    let middle = |a: Point, b: Point| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    let count = controls.len();
    if count < 3 {
        return controls.to_vec();
    }
    let closed = controls[0] == controls[count - 1];
    let mut line = Vec::new();
    let mut arc = |from: Point, control: Point, to: Point| {
        for i in 0..=PIECES {
            let t = i as f64 / PIECES as f64;
            let (a, b, c) = ((1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t);
            line.push(std::array::from_fn(|k| a * from[k] + b * control[k] + c * to[k]));
        }
    };
    if closed {
        for i in 0..count - 1 {
            let (before, next) = (controls[(i + count - 2) % (count - 1)], controls[i + 1]);
            arc(middle(before, controls[i]), controls[i], middle(controls[i], next));
        }
        return line;
    }
    for i in 1..count - 1 {
        let from = if i == 1 { controls[0] } else { middle(controls[i - 1], controls[i]) };
        let to = if i == count - 2 { controls[count - 1] } else { middle(controls[i], controls[i + 1]) };
        arc(from, controls[i], to);
    }
    line
}

/// Width of a text in pixels, with capitals `size` high.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let units: f64 = text.chars().map(|c| strokes(c).0 + GAP).sum();
    (units - GAP).max(0.0) * size / CAPITAL
}

/// Writes a text whose baseline begins at a place in pixels.
pub(crate) fn write(image: &mut Image, text: &str, start: [f64; 2], size: f64, ink: [f32; 3]) {
    let unit = size / CAPITAL;
    let radius = (0.5 * THICKNESS * unit).max(0.45);
    let mut left = start[0];
    for letter in text.chars() {
        let (wide, lines) = strokes(letter);
        let place = |p: Point| [left + unit * p[0], start[1] - unit * (p[1] - 2.0)];
        let pieces: Vec<[Point; 2]> =
            lines.iter().flat_map(|line| line.windows(2).map(|w| [place(w[0]), place(w[1])])).collect();
        let [low, high] = [place([0.0, 9.0]), place([wide, 0.0])];
        let from = |v: f64| (v - radius - 1.0).floor().max(0.0) as usize;
        let to = |v: f64| (v + radius + 1.0).ceil().max(0.0) as usize;
        for y in from(low[1])..to(high[1]).min(image.height()) {
            for x in from(low[0])..to(high[0]).min(image.width()) {
                let here = [x as f64 + 0.5, y as f64 + 0.5];
                let nearest = pieces.iter().map(|p| distance(here, p)).fold(f64::INFINITY, f64::min);
                let cover = (radius + 0.5 - nearest).clamp(0.0, 1.0);
                image.paint(x, y, ink, cover as f32);
            }
        }
        left += unit * (wide + GAP);
    }
}

/// From a point to a straight piece.
fn distance(p: Point, [a, b]: &[Point; 2]) -> f64 {
    let (way, off) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = way[0] * way[0] + way[1] * way[1];
    let t = if squared > 0.0 { ((off[0] * way[0] + off[1] * way[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (off[0] - t * way[0]).hypot(off[1] - t * way[1])
}
