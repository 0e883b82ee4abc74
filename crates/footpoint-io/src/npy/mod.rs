//! Reading NumPy files: one array (`.npy`) or an archive of named ones (`.npz`), into columns.
//!
//! `npyz` reads the headers; rows of types that only a header knows are taken apart by `rows`, as those of PLY are.

mod archive;
mod error;
mod header;
mod layout;

use crate::rows::append;
use crate::source::Source;
use crate::text::recognise_colours;
use crate::{Column, Data, ReadReport, Table};
pub use error::NpyError;
use header::Header;
use layout::{Kind, Layout, Names};

pub(crate) use archive::{is_npz, read as read_archive};

const MAGIC: &[u8] = b"\x93NUMPY";
/// Bytes of rows held at a time; they should stay in the processor's cache.
const BLOCK: u64 = 128 * 1024;
/// Rows to make room for where the size of the file does not bound them.
const BLIND_ROOM: u64 = 1 << 16;

pub(crate) fn is_npy(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// Reads a file of one array: two-dimensional as rows of points, or of records.
pub(crate) fn read(source: &mut Source<'_>) -> Result<(Table, ReadReport), NpyError> {
    let header = Header::read(source)?;
    let layout = Layout::new(&header, Names::ByPosition)?;
    let mut columns = read_columns(source, &layout)?;
    let mut report = ReadReport::default();
    report.notes.extend(layout.note());
    report.notes.extend(name_by_position(&layout, &mut columns));
    if !source.at_end()? {
        report.notes.push("data behind the array were not read".to_owned());
    }
    Ok((Table { columns, ..Table::default() }, report))
}

/// Takes columns for colours rather than normals by their values, and says so where names are a guess.
fn name_by_position(layout: &Layout, columns: &mut [Column]) -> Option<String> {
    if !layout.by_position || matches!(columns.len(), 2 | 3) {
        return None;
    }
    recognise_colours(columns);
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    Some(format!("no names: columns taken by position as {}", names.join(" ")))
}

/// Reads the rows of an array whose header has been read.
fn read_columns(source: &mut Source<'_>, layout: &Layout) -> Result<Vec<Column>, NpyError> {
    let wanted = u128::from(layout.rows) * u128::from(layout.stride) * u128::from(layout.runs);
    if let Some(found) = source.remaining().filter(|&found| u128::from(found) < wanted) {
        return Err(NpyError::EndInRows { wanted, found });
    }
    let room = if source.remaining().is_some() { layout.rows } else { layout.rows.min(BLIND_ROOM) };
    let room = usize::try_from(room).unwrap_or(0);
    let mut columns: Vec<Column> = Vec::new();
    for field in &layout.fields {
        let data = match field.kind {
            Kind::Number(scalar) => scalar.column(room),
            Kind::Bytes(_) | Kind::Characters(_) => Data::Text(Vec::new()),
        };
        columns.push(Column::new(field.name.clone(), data));
    }
    // In Fortran's order each column is a run of its own, else all rows are one.
    for run in 0..layout.runs {
        let (first, last) =
            if layout.runs > 1 { (run as usize, run as usize + 1) } else { (0, layout.fields.len()) };
        let fields = layout.fields.get(first..last).unwrap_or_default();
        let columns = columns.get_mut(first..last).unwrap_or_default();
        let mut block = Vec::new();
        let mut done = 0;
        while done < layout.rows {
            let now = (BLOCK / layout.stride).max(1).min(layout.rows - done);
            let bytes = now.saturating_mul(layout.stride);
            let filled = fill(source, bytes, &mut block)?;
            if filled < bytes {
                let found = (run * layout.rows + done) * layout.stride + filled;
                return Err(NpyError::EndInRows { wanted, found });
            }
            for (column, field) in columns.iter_mut().zip(fields) {
                let (stride, offset) = (layout.stride as usize, field.offset as usize);
                match (&mut column.data, field.kind) {
                    (Data::Text(values), kind) => {
                        let fields =
                            block.chunks_exact(stride).map(|row| row.get(offset..).unwrap_or_default());
                        values.extend(fields.map(|bytes| kind.text(bytes, field.order)));
                    }
                    (numbers, _) => append(numbers, &block, stride, offset, field.order),
                }
            }
            done += now;
        }
    }
    Ok(columns)
}

/// Fills the block with so many bytes, growing it no faster than bytes come: a row may claim any length.
fn fill(source: &mut Source<'_>, bytes: u64, block: &mut Vec<u8>) -> Result<u64, NpyError> {
    let mut filled = 0;
    block.clear();
    while filled < bytes {
        let now = BLOCK.min(bytes - filled);
        block.resize(block.len() + now as usize, 0);
        let read = source.fill(block.get_mut(filled as usize..).unwrap_or_default())? as u64;
        filled += read;
        if read < now {
            break;
        }
    }
    Ok(filled)
}
