//! PCD, the format of the point cloud library, versions 0.5 to 0.7: ascii, binary and compressed.
//!
//! Own reader: `pcd-rs` gives a vector of values per point instead of columns, reads no more than the header states
//! or fails, takes no commas, and unpacks a block of any size a file states; header and three bodies are short.

mod body;
mod colour;
mod error;
mod header;
mod lzf;
mod write;

use std::collections::HashSet;

use crate::source::Source;
use crate::{Column, Kept, ReadReport, Table};
pub use error::PcdError;
pub(crate) use write::{check, write};

/// How a PCD file stores its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PcdEncoding {
    /// As decimal text, one point a line.
    Ascii,
    /// As bytes, point by point.
    #[default]
    Binary,
    /// As bytes, field by field, compressed by LZF; at most 4 GiB.
    Compressed,
}

/// What only a PCD file can hold.
#[derive(Debug, Clone, PartialEq)]
pub struct PcdKept {
    width: u64,
    height: u64,
    viewpoint: Option<[f64; 7]>,
    colour: Option<colour::Packed>,
    /// Fields of several values, which are as many columns.
    groups: Vec<(String, u64)>,
}

impl PcdKept {
    /// The points in a row of an organised cloud; the number of points of any other.
    pub fn width(&self) -> u64 {
        self.width
    }

    /// The rows of an organised cloud; 1 for any other.
    pub fn height(&self) -> u64 {
        self.height
    }

    /// Where the points were seen from: a translation, and a rotation as quaternion `w x y z`. The points are not
    /// moved by it.
    pub fn viewpoint(&self) -> Option<[f64; 7]> {
        self.viewpoint
    }
}

/// Whether a file of these first bytes claims to be PCD.
pub(crate) fn is_pcd(head: &[u8]) -> bool {
    header::is_pcd(head)
}

/// Reads a PCD file: columns in their own types, several values of a field as `name_0`, `name_1`, .., packed colours
/// as `red green blue` (`alpha`), padding left out. Where an ascii or binary file ends early, what is there is given
/// with a note.
pub(crate) fn read(source: &mut Source<'_>) -> Result<(Table, PcdEncoding, ReadReport), PcdError> {
    let mut header = header::read(source)?;
    let mut data = body::read(source, &mut header)?.into_iter();
    let names: HashSet<String> = header.fields.iter().map(|field| field.name.clone()).collect();
    let mut columns: Vec<Column> = Vec::new();
    let mut packed = None;
    let mut groups = Vec::new();
    for field in header.fields.iter().filter(|field| field.scalar.is_some()) {
        if field.count > 1 {
            groups.push((field.name.clone(), field.count));
        }
        let is_colour = field.is_packed_colour
            && packed.is_none()
            && !colour::NAMES.iter().any(|name| names.contains(*name));
        for (index, data) in (0..field.count).zip(data.by_ref()) {
            if is_colour {
                packed = Some(colour::Packed::of(&field.name, &data));
                columns.extend(colour::unpack(&field.name, &data));
            } else {
                columns.push(Column::new(field.column_name(index), data));
            }
        }
    }
    let mut seen = HashSet::new();
    if let Some(twice) = columns.iter().find(|column| !seen.insert(&column.name)) {
        return Err(PcdError::DuplicateName(twice.name.clone()));
    }
    let (width, height, viewpoint) = (header.width, header.height, header.viewpoint);
    let kept = PcdKept { width, height, viewpoint, colour: packed, groups };
    let comments = header.comments;
    let table = Table { columns, comments, kept: Some(Kept::Pcd(kept)), ..Table::default() };
    Ok((
        table,
        header.encoding,
        ReadReport { notes: header.notes, stated_rows: Some(header.points), ..ReadReport::default() },
    ))
}
