//! Square cells over the supports of the samples, narrower where supports are.

/// Cells may be halved so many times after they are made.
pub(super) const HALVINGS: u32 = 4;
/// Halvings of the square around all samples, at most: so far doubles tell corners apart.
const DEEPEST: u32 = 46;

/// Where the corners of cells are: whole numbers of units from an origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    origin: [f64; 2],
    unit: f64,
}

pub(super) type Corner = [i64; 2];

/// A square, by its lower left corner and its side in units, a power of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) corner: Corner,
    pub(super) side: i64,
}

/// A side of a cell, or a part of one: from a corner to the right or upward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Edge {
    pub(super) from: Corner,
    pub(super) axis: usize,
    pub(super) length: i64,
}

impl Lattice {
    pub(super) fn at(&self, corner: Corner) -> [f64; 2] {
        std::array::from_fn(|k| self.origin[k] + corner[k] as f64 * self.unit)
    }

    pub(super) fn length(&self, units: i64) -> f64 {
        units as f64 * self.unit
    }
}

impl Cell {
    pub(super) fn corners(&self) -> [Corner; 4] {
        let ([x, y], side) = (self.corner, self.side);
        [[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    }

    pub(super) fn sides(&self) -> [Edge; 4] {
        let [low, right, _, upper] = self.corners();
        let edge = |from, axis| Edge { from, axis, length: self.side };
        [edge(low, 0), edge(right, 1), edge(upper, 0), edge(low, 1)]
    }

    pub(super) fn quarters(&self) -> [Self; 4] {
        let ([x, y], half) = (self.corner, self.side / 2);
        [[x, y], [x + half, y], [x, y + half], [x + half, y + half]].map(|corner| Self { corner, side: half })
    }
}

impl Edge {
    pub(super) fn to(&self) -> Corner {
        let mut to = self.from;
        to[self.axis] += self.length;
        to
    }

    pub(super) fn middle(&self) -> Corner {
        let mut middle = self.from;
        middle[self.axis] += self.length / 2;
        middle
    }

    pub(super) fn halves(&self) -> [Self; 2] {
        let length = self.length / 2;
        [Self { length, ..*self }, Self { from: self.middle(), axis: self.axis, length }]
    }
}

/// Cells that together cover the disc of its radius around every sample, none wider than `share` of a radius whose disc it
/// meets. None where there is no disc, or no double is as large as all together. Between them and around them are empty ones: together they tile a square, so that every corner on the side of a cell
/// is the corner of another.
pub(super) fn cover(discs: &[([f64; 2], f64)], share: f64) -> (Lattice, Vec<Cell>) {
    let (mut low, mut high, mut least) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2], f64::INFINITY);
    for (centre, radius) in discs {
        for k in 0..2 {
            low[k] = low[k].min(centre[k] - radius);
            high[k] = high[k].max(centre[k] + radius);
        }
        least = least.min(*radius);
    }
    let extent = (high[0] - low[0]).max(high[1] - low[1]);
    if !(extent.is_finite() && least > 0.0) {
        return (Lattice { origin: low, unit: 0.0 }, Vec::new());
    }
    let halvings = (extent / (share * least)).log2().ceil().clamp(0.0, f64::from(DEEPEST)) as u32;
    let side = 1_i64 << (halvings + HALVINGS);
    // A little more than needed, so that corners do not lie on the axes of symmetric clouds.
    let width = extent.max(share * least * f64::from(halvings).exp2()) * 1.017;
    let unit = width / side as f64;
    let lattice = Lattice { origin: [low[0] - 0.0071 * width, low[1] - 0.0043 * width], unit };
    let mut cells = Vec::new();
    let all: Vec<u32> = (0..discs.len() as u32).collect();
    divide((&lattice, discs, share), Cell { corner: [0, 0], side }, &all, &mut cells);
    (lattice, cells)
}

/// Halves a cell until it is narrow enough for the discs that meet it, which are among these.
fn divide(
    (lattice, discs, share): (&Lattice, &[([f64; 2], f64)], f64),
    cell: Cell,
    among: &[u32],
    cells: &mut Vec<Cell>,
) {
    let (low, width) = (lattice.at(cell.corner), lattice.length(cell.side));
    let meets = |&&i: &&u32| {
        let (centre, radius) = discs[i as usize];
        let away = |k: usize| (low[k] - centre[k]).max(centre[k] - low[k] - width).max(0.0);
        away(0) * away(0) + away(1) * away(1) <= radius * radius
    };
    let near: Vec<u32> = among.iter().filter(meets).copied().collect();
    let least = near.iter().map(|&i| discs[i as usize].1).fold(f64::INFINITY, f64::min);
    if width <= share * least || cell.side <= 1 << HALVINGS {
        cells.push(cell);
        return;
    }
    for quarter in cell.quarters() {
        divide((lattice, discs, share), quarter, &near, cells);
    }
}
