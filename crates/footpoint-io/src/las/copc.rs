//! The octree of a COPC file (COPC 1.0): which chunks hold the points of a box.

use std::collections::HashSet;

use super::header::Head;
use super::record::{COPC, part};
use super::unpack::Chunk;
use crate::Bounds;

/// The bytes of one entry of the hierarchy.
const ENTRY: usize = 32;
/// A deeper tree would have cells smaller than the steps of the coordinates.
const DEEPEST: i32 = 31;

/// The chunks whose cells meet the box, in the file's order; `None` if the hierarchy is broken.
///
/// The hierarchy is read here: the `las` crate follows pages that name each other without end.
pub(super) fn chunks_within(head: &Head, bounds: &Bounds) -> Option<Vec<Chunk>> {
    let info = &head.vlrs.iter().find(|record| record.is(COPC, 1))?.data;
    let pages = &head.evlrs.iter().find(|record| record.is(COPC, 1000))?.data;
    let number = |at: usize| f64::from_le_bytes(part(info, at));
    let (centre, half) = ([number(0), number(8), number(16)], number(24));
    let root = (u64::from_le_bytes(part(info, 40)), u64::from_le_bytes(part(info, 48)));
    if info.len() < 160 || !half.is_finite() || centre.iter().any(|c| !c.is_finite()) {
        return None;
    }
    let header = &head.header;
    // Coordinates are rounded to steps after they have been sorted into cells.
    let steps = [header.x_scale_factor, header.y_scale_factor, header.z_scale_factor].map(f64::abs);
    let mut chunks = Vec::new();
    let mut seen = HashSet::new();
    let mut pending = vec![root];
    let mut points = 0_u64;
    while let Some(page) = pending.pop() {
        if !seen.insert(page) {
            continue;
        }
        let start = usize::try_from(page.0.checked_sub(root.0)?).ok()?;
        let length = usize::try_from(page.1).ok()?;
        for entry in pages.get(start..start.checked_add(length)?)?.chunks_exact(ENTRY) {
            let key = [0, 4, 8, 12].map(|at| i32::from_le_bytes(part(entry, at)));
            let at = u64::from_le_bytes(part(entry, 16));
            let bytes = i32::from_le_bytes(part(entry, 24));
            let count = i32::from_le_bytes(part(entry, 28));
            let bytes = u64::try_from(bytes).ok()?;
            match u64::try_from(count) {
                Err(_) if count == -1 => pending.push((at, bytes)),
                Err(_) => return None,
                Ok(0) => {}
                Ok(count) => {
                    at.checked_add(bytes).filter(|&end| end <= head.size)?;
                    points += count;
                    if cell_meets(key, (centre, half), steps, bounds)? {
                        chunks.push(Chunk { at, bytes, points: count });
                    }
                }
            }
        }
    }
    chunks.sort_by_key(|chunk| chunk.at);
    // A hierarchy that names other points than the file has would leave some out in silence.
    (points == head.points).then_some(chunks)
}

fn cell_meets(
    [level, cell @ ..]: [i32; 4],
    (centre, half): ([f64; 3], f64),
    steps: [f64; 3],
    bounds: &Bounds,
) -> Option<bool> {
    if !(0..=DEEPEST).contains(&level) {
        return None;
    }
    let side = 2.0 * half / (1_u64 << level) as f64;
    Some((0..3).all(|k| {
        let low = centre[k] - half + side * f64::from(cell[k]);
        low - steps[k] <= bounds.high[k] && bounds.low[k] <= low + side + steps[k]
    }))
}
