//! Reading Leica PTX: text of one or more gridded scans, each with a head of ten lines, then a line a grid cell.
//!
//! The head: columns, rows, the scanner's position, its three axes, and a 4×4 matrix that takes row vectors from
//! the scanner's frame to the common one. A cell without a return is `0 0 0`; it stays a row, with NaN for its
//! coordinates, so that grids keep their shape and its other values are not lost.

mod error;
mod pose;

use crate::excerpt::excerpt;
use crate::source::Source;
use crate::{Column, Data, ReadReport, Table};
pub use error::PtxError;
use pose::Pose;

/// Values of a cell: x y z, then intensity, red green blue, or all of these.
const MOST: usize = 7;
const NAMES: [&str; MOST] = ["x", "y", "z", "intensity", "red", "green", "blue"];
/// Numbers a line of the head has.
const HEAD: [usize; 10] = [1, 1, 3, 3, 3, 3, 4, 4, 4, 4];

/// Whether a file begins with the ten lines of a scan's head.
pub(crate) fn is_ptx(head: &[u8]) -> bool {
    let mut lines = head.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    HEAD.iter().all(|wanted| {
        lines.next().is_some_and(|line| values(0, line).is_ok_and(|(_, found)| found == *wanted))
    })
}

pub(crate) fn read(source: &mut Source<'_>) -> Result<(Table, ReadReport), PtxError> {
    let mut lines = Lines { source, number: 0 };
    let mut cells = Cells::default();
    let mut comments = Vec::new();
    let mut scans = Vec::new();
    while let Some(scan) = head(&mut lines, scans.len())? {
        let [x, y, z] = scan.position;
        let (columns, rows) = (scan.columns, scan.rows);
        comments
            .push(format!("scan {}: {columns} columns of {rows} rows, scanner at {x} {y} {z}", scans.len()));
        cells.read(&mut lines, &scan, scans.len())?;
        scans.push(cells.rows());
    }
    if scans.is_empty() {
        return Err(PtxError::NoScan);
    }
    Ok(cells.finish(comments, &scans))
}

/// The lines of a file that are not blank.
struct Lines<'s, 'w> {
    source: &'s mut Source<'w>,
    /// The line read last, from 1.
    number: u64,
}

impl Lines<'_, '_> {
    /// The numbers of the next line and how many they are; `None` at the end of the file.
    fn next(&mut self) -> Result<Option<([f64; MOST], usize)>, PtxError> {
        while let Some(line) = self.source.next_line(b'\n')? {
            self.number += 1;
            let line = line.trim_ascii();
            if !line.is_empty() {
                return values(self.number, line).map(Some);
            }
        }
        Ok(None)
    }
}

fn values(line: u64, content: &[u8]) -> Result<([f64; MOST], usize), PtxError> {
    let mut values = [0.0; MOST];
    let mut found = 0;
    for word in content.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
        let number =
            fast_float2::parse(word).map_err(|_| PtxError::NotANumber { line, content: excerpt(word) })?;
        if let Some(place) = values.get_mut(found) {
            *place = number;
        }
        found += 1;
    }
    Ok((values, found))
}

/// What a scan's head says.
struct Scan {
    columns: u64,
    rows: u64,
    position: [f64; 3],
    pose: Pose,
}

/// The next scan's head; `None` at the end of the file.
fn head(lines: &mut Lines<'_, '_>, scan: usize) -> Result<Option<Scan>, PtxError> {
    let mut numbers = [[0.0; MOST]; HEAD.len()];
    for (index, (place, wanted)) in numbers.iter_mut().zip(HEAD).enumerate() {
        let Some((values, found)) = lines.next()? else {
            return if index == 0 { Ok(None) } else { Err(PtxError::EndInHead { scan, line: lines.number }) };
        };
        if found != wanted {
            return Err(PtxError::HeadLine { line: lines.number, scan, part: index + 1, found, wanted });
        }
        *place = values;
    }
    let [[columns, ..], [rows, ..], [x, y, z, ..], _, _, _, matrix @ ..] = numbers;
    let line = lines.number;
    let count = |value: f64| {
        let whole = value.trunc() == value && (0.0..1e15).contains(&value);
        whole.then_some(value as u64).ok_or(PtxError::Count { line: line + 1 - HEAD.len() as u64, value })
    };
    let pose = Pose::new(matrix).ok_or(PtxError::Matrix { scan, line })?;
    Ok(Some(Scan { columns: count(columns)?, rows: count(rows)?, position: [x, y, z], pose }))
}

/// The cells of all scans, column by column.
#[derive(Default)]
struct Cells {
    columns: [Vec<f64>; MOST],
    /// Cells without a return.
    empty: u64,
}

impl Cells {
    fn rows(&self) -> usize {
        self.columns[0].len()
    }

    fn read(&mut self, lines: &mut Lines<'_, '_>, scan: &Scan, number: usize) -> Result<(), PtxError> {
        let cells = scan.columns.saturating_mul(scan.rows);
        let mut first = None;
        for cell in 0..cells {
            let Some((values, found)) = lines.next()? else {
                return Err(PtxError::EndInCells { scan: number, cell: cell + 1, cells });
            };
            let line = lines.number;
            let (first, wanted) = *first.get_or_insert((line, found));
            if found != wanted {
                return Err(PtxError::Width { line, found, first, wanted });
            }
            // Without the fourth of seven values, colours follow the coordinates.
            let places: &[usize] = match found {
                3 => &[0, 1, 2],
                4 => &[0, 1, 2, 3],
                6 => &[0, 1, 2, 4, 5, 6],
                MOST => &[0, 1, 2, 3, 4, 5, 6],
                _ => return Err(PtxError::Cell { line, found }),
            };
            self.push(values, places, &scan.pose);
        }
        // A scan may have fewer attributes than those before it.
        self.pad();
        Ok(())
    }

    fn push(&mut self, values: [f64; MOST], places: &[usize], pose: &Pose) {
        let row = self.rows();
        let [x, y, z, ..] = values;
        let point = if [x, y, z] == [0.0; 3] {
            self.empty += 1;
            [f64::NAN; 3]
        } else {
            pose.apply([x, y, z])
        };
        for (value, place) in values.into_iter().zip(places) {
            if let Some(column) = self.columns.get_mut(*place) {
                // The scans before may not have had this attribute.
                column.resize(row, f64::NAN);
                column.push(point.get(*place).copied().unwrap_or(value));
            }
        }
    }

    fn pad(&mut self) {
        let rows = self.rows();
        self.columns
            .iter_mut()
            .filter(|column| !column.is_empty())
            .for_each(|column| column.resize(rows, f64::NAN));
    }

    fn finish(self, comments: Vec<String>, ends: &[usize]) -> (Table, ReadReport) {
        let named = NAMES.into_iter().zip(self.columns).enumerate();
        let there = named.filter(|(index, (_, values))| *index < 3 || !values.is_empty());
        let mut columns: Vec<Column> =
            there.map(|(_, (name, values))| Column::new(name, Data::F64(values))).collect();
        if ends.len() > 1 {
            let mut scan = Vec::new();
            ends.iter().zip(0_u32..).for_each(|(end, index)| scan.resize(*end, index));
            columns.push(Column::new("scan", Data::U32(scan)));
        }
        let mut report = ReadReport::default();
        if self.empty > 0 {
            report.notes.push(format!("{} grid cells without a return have nan for coordinates", self.empty));
        }
        (Table { columns, comments, ..Table::default() }, report)
    }
}
