//! LAS, LAZ and COPC: one table from the point records, with everything beside them kept for writing.
//!
//! Header and keys are read through the `las` crate, packed points through `laz`.

mod copc;
mod crs;
mod error;
mod extra;
mod fields;
mod fit;
mod grid;
mod header;
mod layout;
mod points;
mod record;
mod unpack;
mod wkt;
mod write;

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use las::raw;

use crate::{Format, Frame, Input, Kept, ReadOptions, ReadProblem, ReadReport, Table};
pub use error::{LasError, LasMisfit};
use extra::Extra;
use header::Head;
pub(crate) use layout::check;
use points::{BLOCK, Points};
use record::Record;
use unpack::Packing;
pub use unpack::UNPACKING;
pub(crate) use write::write;

/// What a LAS file holds beside its points, and how it stores them: point format, scale and offset, header
/// fields, variable length records and the descriptions of its extra bytes. All of it is written again, but
/// the octree of COPC and LAStools' index of the points, and with a point format that has fields for new
/// colours or times. Colours of 8 bits are spread over 16. Columns without a field, or with values that it
/// cannot hold, become extra bytes of their own type, and of their own name, or with `_1` where it is taken.
///
/// Coordinates are integers on a grid in LAS. Each axis keeps its scale and offset where every coordinate
/// lies on them. Otherwise, and for tables of other formats, the offset is the least coordinate, rounded
/// down to the power of ten below the extent, and the scale the coarsest power of ten up to 1 that loses
/// nothing; where none does, the finest that 32 bits hold, which rounds by less than 5e-9 of the extent.
#[derive(Debug, Clone, PartialEq)]
pub struct LasKept {
    header: raw::Header,
    format: u8,
    vlrs: Vec<Record>,
    evlrs: Vec<Record>,
    extras: Vec<Extra>,
    /// What the records say of the coordinates.
    frame: Frame,
}

/// Whether a file of these first bytes, or of this extension, is to be read as LAS.
pub(crate) fn is_las(head: &[u8], extension: &str) -> bool {
    head.starts_with(&raw::LASF) || matches!(extension, "las" | "laz")
}

/// Reads a file of any LAS version, packed or not.
///
/// An unpacked file that ends early gives the points it has, with a note; a packed one is refused.
pub(crate) fn read(path: &Path, options: &ReadOptions<'_>) -> Result<Input, ReadProblem> {
    read_file(path, options).map_err(|error| match error {
        LasError::Io(error) => ReadProblem::Io(error),
        LasError::Stopped => ReadProblem::Stopped,
        error => ReadProblem::Las(error),
    })
}

fn read_file(path: &Path, options: &ReadOptions<'_>) -> Result<Input, LasError> {
    let file = File::open(path)?;
    let metadata = file.metadata()?;
    if !metadata.is_file() {
        return Err(LasError::NotSeekable);
    }
    let mut file = BufReader::new(file);
    let mut report = ReadReport::default();
    let notes = &mut report.notes;
    let head = Head::read(&mut file, metadata.len(), notes)?;
    let own = fields::standard(head.format, &head.header).unwrap_or_default();
    let base = fields::size(&own);
    let extras = Extra::read(head.extra_bytes(), head.record_size() - base, &own, notes);
    let mut all = own;
    let mut start = base;
    for extra in &extras {
        all.extend(extra.fields.iter().map(|field| fields::Field { at: start + field.at, ..field.clone() }));
        start += extra.size();
    }
    let columns = if head.is_packed {
        read_packed(&mut file, &head, all, options, notes)?
    } else {
        read_plain(&mut file, &head, all, options, notes)?
    };
    let format = match (head.is_packed, head.is_copc()) {
        (true, true) => Format::Copc,
        (true, false) => Format::Laz,
        _ => Format::Las,
    };
    let frame = crs::frame(&head, notes);
    report.stated_rows = options.within.is_none().then_some(head.points);
    let Head { header, vlrs, evlrs, format: point_format, .. } = head;
    let kept = LasKept { header, format: point_format, vlrs, evlrs, extras, frame: frame.clone() };
    let table = Table { columns, comments: Vec::new(), frame, kept: Some(Kept::Las(Box::new(kept))) };
    Ok(Input { table, format, report })
}

fn read_packed(
    file: &mut (impl Read + Seek + Send),
    head: &Head,
    fields: Vec<fields::Field>,
    options: &ReadOptions<'_>,
    notes: &mut Vec<String>,
) -> Result<Vec<crate::Column>, LasError> {
    let packing = Packing::of(head)?;
    let mut chosen = None;
    if let Some(bounds) = options.within.filter(|_| head.is_copc()) {
        chosen = copc::chunks_within(head, &bounds);
        if chosen.is_none() {
            notes.push("the octree of this COPC file is broken; all points were looked through".to_owned());
        }
    }
    let chunks = match chosen {
        Some(chunks) => chunks,
        None => packing.chunks(file, head)?,
    };
    let all = chunks.iter().map(|chunk| chunk.points).sum();
    // Hardly any file packs a point into less than two bytes; for those that do, the columns grow.
    let mut points = Points::new(fields, head.record_size(), (all, head.size / 2), options);
    packing.unpack(file, &chunks, &mut points)?;
    points.finish()
}

fn read_plain(
    file: &mut impl Read,
    head: &Head,
    fields: Vec<fields::Field>,
    options: &ReadOptions<'_>,
    notes: &mut Vec<String>,
) -> Result<Vec<crate::Column>, LasError> {
    let record = head.record_size();
    let held = head.size.saturating_sub(head.start()) / record.max(1) as u64;
    let all = head.points.min(held);
    if all < head.points {
        notes.push(format!("the file is cut: its header says {} points, {held} are there", head.points));
    }
    let mut points = Points::new(fields, record, (all, held), options);
    let mut block = Vec::new();
    let mut left = all;
    while left > 0 {
        let now = left.min(BLOCK as u64);
        block.resize(now as usize * record, 0);
        file.read_exact(&mut block)?;
        points.take(&mut block)?;
        left -= now;
    }
    points.finish()
}
