//! Names for the columns of a text file: from a header, from a comment, or by position.

use std::collections::HashSet;

use super::TextError;
use super::fields::{Row, split};
use crate::format::TextKind;
use crate::{Column, Data};

/// Whether a line that could be the first row is a header: no number in it, or `x` and `y` among its words.
pub(super) fn is_header(line: &[u8], row: &Row) -> bool {
    let words = (0..row.len()).filter(|&i| row.number(line, i).is_none());
    let names: Vec<String> = words.filter_map(|i| row.text(line, i).ok()).collect();
    has_coordinates(&names) || names.len() == row.len() && names.iter().any(|name| !name.is_empty())
}

/// The names of a header line; a nameless column is called by its place.
pub(super) fn header(line: u64, content: &[u8], row: &Row) -> Result<Vec<String>, TextError> {
    let name = |index| {
        let name = row.text(content, index).map_err(|field| super::not_text(line, field))?;
        Ok(if name.trim().is_empty() { numbered(index) } else { name.trim().to_owned() })
    };
    (0..row.len()).map(name).collect()
}

/// Refuses a header that gives two columns one name.
pub(super) fn check_unique(line: u64, names: &[String]) -> Result<(), TextError> {
    let mut seen = HashSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(name) => Err(TextError::DuplicateName { line, name: name.clone() }),
        None => Ok(()),
    }
}

/// The names in a comment such as `x y z`, if they fit the columns.
pub(super) fn in_comment(comment: &str, columns: usize) -> Option<Vec<String>> {
    coordinates_in(comment).filter(|names| names.len() == columns)
}

/// The names in a comment, if `x` and `y` are among them; a sentence must not be taken for a header.
pub(super) fn coordinates_in(comment: &str) -> Option<Vec<String>> {
    let content = comment.trim().as_bytes();
    let mut row = Row::default();
    split(content, &mut row);
    row.drop_empty_end();
    let names = header(0, content, &row).ok()?;
    (has_coordinates(&names) && check_unique(0, &names).is_ok()).then_some(names)
}

pub(super) fn has_coordinates(names: &[String]) -> bool {
    let has = |wanted: &str| names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
    has("x") && has("y")
}

/// The customary names of `columns` columns without a header.
pub(super) fn by_position(columns: usize, kind: TextKind) -> Vec<String> {
    let known: &[&str] = match (kind, columns) {
        (_, 0 | 1) => &[],
        (TextKind::Xy, _) | (_, 2) => &["x", "y"],
        (TextKind::Pts, 4) => &["x", "y", "z", "intensity"],
        (TextKind::Pts, 7) => &["x", "y", "z", "intensity", "red", "green", "blue"],
        (_, 6) => &["x", "y", "z", "nx", "ny", "nz"],
        _ => &["x", "y", "z"],
    };
    (0..columns).map(|i| known.get(i).map_or_else(|| numbered(i), |&name| name.to_owned())).collect()
}

/// Renames columns taken for normals by position if they hold colours: whole numbers from 0 to 255, not
/// all of them 0 or 1.
pub(crate) fn recognise_colours(columns: &mut [Column]) {
    let [_, _, _, normals @ ..] = columns else { return };
    if !normals.iter().map(|column| column.name.as_str()).eq(["nx", "ny", "nz"]) {
        return;
    }
    let kinds: Option<Vec<Level>> = normals.iter().map(|column| Level::of(&column.data)).collect();
    if kinds.is_some_and(|kinds| kinds.contains(&Level::Byte)) {
        for (column, name) in normals.iter_mut().zip(["red", "green", "blue"]) {
            column.name = name.to_owned();
        }
    }
}

/// What whole numbers from 0 to 255 can be.
#[derive(PartialEq)]
enum Level {
    /// A component of an axis, or a dark colour.
    Bit,
    /// More than 1: a colour.
    Byte,
}

impl Level {
    /// The level of a column; `None` if it has any other number.
    fn of(data: &Data) -> Option<Self> {
        fn level(values: impl Iterator<Item = f64> + Clone) -> Option<Level> {
            let whole = values.clone().all(|v| v.trunc() == v && (0.0..=255.0).contains(&v));
            whole.then(|| if values.clone().any(|v| v > 1.0) { Level::Byte } else { Level::Bit })
        }
        match data {
            Data::F64(values) => level(values.iter().copied()),
            Data::F32(values) => level(values.iter().copied().map(f64::from)),
            others => level(others.to_f64()?.iter().copied()),
        }
    }
}

fn numbered(index: usize) -> String {
    format!("column_{}", index + 1)
}
