//! Reading `.npz`: a zip archive of arrays, each a column or a few.

use std::collections::HashSet;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use zip::ZipArchive;

use super::header::Header;
use super::layout::{Layout, Names};
use super::{NpyError, name_by_position, read_columns};
use crate::source::{Counted, Source, Unpacked};
use crate::{ReadProblem, ReadReport, Table, Watch};

/// Whether a file of these first bytes is a zip archive, an empty one too.
pub(crate) fn is_npz(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06")
}

/// Reads all arrays of numbers and of text; those of other kinds are noted.
pub(crate) fn read(path: &Path, watch: Option<&dyn Watch>) -> Result<(Table, ReadReport), ReadProblem> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    let counted = Counted::new(file);
    let passed = counted.passed();
    let mut archive = ZipArchive::new(BufReader::new(counted)).map_err(NpyError::Archive)?;
    let names = archive.file_names().map(|name| name.map(Into::into));
    let names: Vec<String> = names.collect::<Result<_, _>>().map_err(NpyError::Archive)?;
    let arrays = names.iter().filter(|name| name.ends_with(".npy")).count();
    if arrays == 0 {
        return Err(NpyError::NoArray.into());
    }
    let mut all = Arrays { alone: arrays == 1, ..Arrays::default() };
    for (index, name) in names.iter().enumerate() {
        let Some(array) = name.strip_suffix(".npy") else {
            all.report.notes.push(format!("`{name}` in the archive is no array: passed over"));
            continue;
        };
        let entry = archive.by_index(index).map_err(|error| NpyError::Archive(error).of(array))?;
        let unpacked = Unpacked::new(entry, passed.clone(), Some(size)).after(all.unpacked);
        let mut source = Source::part(unpacked, watch);
        let read = all.read(array, &mut source);
        if source.is_stopped() {
            return Err(ReadProblem::Stopped);
        }
        read.map_err(|error| error.of(array))?;
    }
    if all.table.columns.is_empty() {
        return Err(NpyError::NoArray.into());
    }
    Ok((all.table, all.report))
}

#[derive(Default)]
struct Arrays {
    /// Whether the archive holds a single array, which then is read as a file of its own would be.
    alone: bool,
    table: Table,
    report: ReadReport,
    /// The first array that has rows, and their number.
    first: Option<(String, u64)>,
    names: HashSet<String>,
    unpacked: u64,
}

impl Arrays {
    fn read(&mut self, array: &str, source: &mut Source<'_>) -> Result<(), NpyError> {
        let header = Header::read(source)?;
        let names = if self.alone && header.shape.len() != 1 { Names::ByPosition } else { Names::Of(array) };
        let layout = match Layout::new(&header, names) {
            Ok(layout) => layout,
            // Single values and Python objects tell of the points, but are none of their columns.
            Err(problem @ (NpyError::Single | NpyError::Pickled)) if !self.alone => {
                self.report.notes.push(format!("array `{array}` passed over: {problem}"));
                return Ok(());
            }
            Err(problem) => return Err(problem),
        };
        let (first, wanted) = self.first.get_or_insert_with(|| (array.to_owned(), layout.rows));
        if layout.rows != *wanted {
            return Err(NpyError::Lengths { found: layout.rows, first: first.clone(), wanted: *wanted });
        }
        for field in &layout.fields {
            if !self.names.insert(field.name.clone()) {
                return Err(NpyError::Duplicate { name: field.name.clone() });
            }
        }
        let mut columns = read_columns(source, &layout)?;
        self.report.notes.extend(name_by_position(&layout, &mut columns));
        self.table.columns.append(&mut columns);
        self.unpacked += layout.rows.saturating_mul(layout.stride * layout.runs);
        // The archive's checksum is compared at the end.
        if !source.at_end()? {
            self.report.notes.push(format!("data behind array `{array}` were not read"));
        }
        self.report.notes.extend(layout.note().map(|note| format!("`{array}`: {note}")));
        Ok(())
    }
}
