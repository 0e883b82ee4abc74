//! A page to draw on: shapes in the coordinates of the samples, sizes in pixels, written as SVG.

use super::style::{CORNER, FONT, HEAD, LETTERS, POINT, Pen, REMARKS, WIDTH};
use kurbo::{Affine, Arc, Point, Rect, Vec2};
use svg::Node;
use svg::node::Text;
use svg::node::element::Element;

/// One figure while it is drawn; later shapes cover earlier ones.
pub(super) struct Canvas {
    to_page: Affine,
    height: f64,
    title: &'static str,
    shapes: Vec<Element>,
}

impl Canvas {
    /// A page that shows the rectangle between two corners, y upward.
    pub(super) fn new(title: &'static str, low: [f64; 2], high: [f64; 2]) -> Self {
        let scale = WIDTH / (high[0] - low[0]);
        let height = ((high[1] - low[1]) * scale).ceil();
        let to_page = Affine::new([scale, 0.0, 0.0, -scale, -low[0] * scale, high[1] * scale]);
        Self { to_page, height, title, shapes: Vec::new() }
    }

    fn place(&self, at: [f64; 2]) -> Point {
        self.to_page * Point::new(at[0], at[1])
    }

    /// The direction on the page, a unit vector.
    fn heading(&self, direction: [f64; 2]) -> Vec2 {
        Vec2::new(direction[0], -direction[1]).normalize()
    }

    /// So many pixels in the coordinates of the samples.
    pub(super) fn pixels(&self, count: f64) -> f64 {
        count / self.to_page.as_coeffs()[0]
    }

    fn add(&mut self, name: &str, attributes: &[(&str, String)]) -> &mut Element {
        let mut element = Element::new(name);
        for (key, value) in attributes {
            element.assign(*key, value.as_str());
        }
        self.shapes.push(element);
        let last = self.shapes.len() - 1;
        &mut self.shapes[last]
    }

    fn path(&mut self, way: String, pen: Pen) {
        let path = self.add("path", &[("d", way), ("fill", "none".into())]);
        stroke(path, pen);
    }

    /// A chain of segments.
    pub(super) fn polyline(&mut self, points: &[[f64; 2]], closed: bool, pen: Pen) {
        let mut way = String::new();
        for (i, &point) in points.iter().enumerate() {
            way += &format!("{}{}", if i == 0 { "M" } else { "L" }, pair(self.place(point)));
        }
        self.path(way + if closed { "Z" } else { "" }, pen);
    }

    /// A segment.
    pub(super) fn segment(&mut self, from: [f64; 2], to: [f64; 2], pen: Pen) {
        self.polyline(&[from, to], false, pen);
    }

    /// An arrow whose tip is at `to`.
    pub(super) fn arrow(&mut self, from: [f64; 2], to: [f64; 2], pen: Pen) {
        let (start, tip) = (self.place(from), self.place(to));
        let along = (tip - start).normalize();
        let (length, half) = HEAD;
        let length = length.min(0.6 * (tip - start).hypot());
        let base = tip - along * length;
        let side = along.turn_90() * half;
        // The shaft ends inside the head, so that its square end does not blunt the tip.
        let way = format!("M{}L{}", pair(start), pair(base + along));
        self.path(way, pen);
        let head = format!("M{}L{}L{}Z", pair(tip), pair(base + side), pair(base - side));
        self.add("path", &[("d", head), ("fill", pen.colour.into())]);
    }

    /// An arrow to a marked point: its tip touches the mark.
    pub(super) fn step(&mut self, from: [f64; 2], to: [f64; 2], pen: Pen) {
        let back = self.pixels(POINT + 1.0);
        let (x, y) = (from[0] - to[0], from[1] - to[1]);
        let length = x.hypot(y);
        self.arrow(from, [to[0] + back * x / length, to[1] + back * y / length], pen);
    }

    /// Discs of this radius in pixels, without those beside the page.
    pub(super) fn dots(&mut self, points: &[[f64; 2]], radius: f64, fill: &str) {
        let mut group = Element::new("g");
        group.assign("fill", fill);
        let page = Rect::new(0.0, 0.0, WIDTH, self.height).inflate(radius, radius);
        for centre in points.iter().map(|&point| self.place(point)).filter(|&centre| page.contains(centre)) {
            let mut dot = Element::new("circle");
            dot.assign("cx", rounded(centre.x));
            dot.assign("cy", rounded(centre.y));
            dot.assign("r", rounded(radius));
            group.append(dot);
        }
        self.shapes.push(group);
    }

    /// A point that the text speaks of.
    pub(super) fn point(&mut self, at: [f64; 2], fill: &str) {
        let centre = self.place(at);
        let [x, y] = [centre.x, centre.y].map(rounded);
        let rim = [("cx", x), ("cy", y), ("r", rounded(POINT)), ("fill", fill.into())];
        let dot = self.add("circle", &rim);
        dot.assign("stroke", "#fff");
        dot.assign("stroke-width", 1);
    }

    /// A disc whose radius is a length of the samples.
    pub(super) fn disc(&mut self, centre: [f64; 2], radius: f64, fill: &str) {
        let at = self.place(centre);
        let radius = radius * self.to_page.as_coeffs()[0];
        let [x, y, r] = [at.x, at.y, radius].map(rounded);
        self.add("circle", &[("cx", x), ("cy", y), ("r", r), ("fill", fill.into())]);
    }

    /// The mark of a right angle between two directions.
    pub(super) fn right_angle(&mut self, corner: [f64; 2], one: [f64; 2], other: [f64; 2], pen: Pen) {
        let corner = self.place(corner);
        let (one, other) = (self.heading(one) * CORNER, self.heading(other) * CORNER);
        let way = format!("M{}L{}L{}", pair(corner + one), pair(corner + one + other), pair(corner + other));
        self.path(way, Pen { width: 0.8, dashes: "", ..pen });
    }

    /// The arc from one direction to another, the shorter way around.
    pub(super) fn angle(&mut self, (corner, radius): ([f64; 2], f64), ends: [[f64; 2]; 2], pen: Pen) {
        let [from, to] = ends.map(|direction| self.heading(direction));
        let turn = from.cross(to).atan2(from.dot(to));
        let arc = Arc::new(self.place(corner), (radius, radius), from.atan2(), turn, 0.0);
        let (start, end) = (arc.center + from * radius, arc.center + to * radius);
        let size = rounded(radius);
        let sweep = u8::from(arc.sweep_angle > 0.0);
        self.path(format!("M{}A{size} {size} 0 0 {sweep} {}", pair(start), pair(end)), pen);
    }

    /// Letters in italics, so many pixels to the right of a place and above it.
    pub(super) fn letters(&mut self, at: [f64; 2], offset: [f64; 2], text: &str, fill: &str) {
        self.text((at, offset), text, (LETTERS, "italic", fill));
    }

    /// A remark in upright letters.
    pub(super) fn remark(&mut self, at: [f64; 2], offset: [f64; 2], text: &str, fill: &str) {
        self.text((at, offset), text, (REMARKS, "normal", fill));
    }

    /// Text about its middle; drawn twice, white and wider first, so that lines do not run through it.
    fn text(
        &mut self,
        (at, offset): ([f64; 2], [f64; 2]),
        words: &str,
        (size, style, fill): (f64, &str, &str),
    ) {
        let at = self.place(at) + Vec2::new(offset[0], -offset[1]);
        for halo in [true, false] {
            let mut text = Element::new("text");
            text.assign("x", rounded(at.x));
            // Letters without tails look centred a third of their size above the line they stand on.
            text.assign("y", rounded(at.y + 0.32 * size));
            text.assign("font-size", rounded(size));
            text.assign("font-style", style);
            text.assign("fill", if halo { "#fff" } else { fill });
            if halo {
                text.assign("stroke", "#fff");
                text.assign("stroke-width", 3);
                text.assign("stroke-linejoin", "round");
                text.assign("aria-hidden", "true");
            }
            text.append(Text::new(words));
            self.shapes.push(text);
        }
    }

    /// The file.
    pub(super) fn finish(self) -> String {
        let [width, height] = [WIDTH, self.height].map(rounded);
        let mut root = Element::new("svg");
        root.assign("xmlns", "http://www.w3.org/2000/svg");
        root.assign("viewBox", format!("0 0 {width} {height}"));
        root.assign("width", width.as_str());
        root.assign("height", height.as_str());
        root.assign("font-family", FONT);
        root.assign("text-anchor", "middle");
        root.assign("role", "img");
        let mut title = Element::new("title");
        title.append(Text::new(self.title));
        root.append(title);
        // White of its own: pages may be dark.
        let mut page = Element::new("rect");
        page.assign("width", width.as_str());
        page.assign("height", height.as_str());
        page.assign("fill", "#fff");
        root.append(page);
        for shape in self.shapes {
            root.append(shape);
        }
        format!("{root}\n")
    }
}

fn stroke(element: &mut Element, pen: Pen) {
    element.assign("stroke", pen.colour);
    element.assign("stroke-width", rounded(pen.width));
    element.assign("stroke-linejoin", "round");
    if !pen.dashes.is_empty() {
        element.assign("stroke-dasharray", pen.dashes);
    }
}

/// A number to a hundredth.
fn rounded(value: f64) -> String {
    // Adding zero turns −0 into 0.
    format!("{}", (value * 100.0).round() / 100.0 + 0.0)
}

fn pair(point: Point) -> String {
    format!("{} {}", rounded(point.x), rounded(point.y))
}
