//! Reading text: rows of fields separated by blanks, tabs, commas or semicolons.

mod error;
mod fields;
mod names;
mod quick;

use crate::excerpt::excerpt;
use crate::format::TextKind;
use crate::source::Source;
use crate::{Column, Data, ReadReport, Table};
pub use error::TextError;
use fields::{Row, split};
use quick::Quick;

pub(crate) use fields::{is_comment, needs_quotes};

/// The customary names of columns that nothing names.
pub(crate) fn by_position(columns: usize) -> Vec<String> {
    names::by_position(columns, TextKind::Txt)
}

pub(crate) use names::recognise_colours;

/// Reads all rows; `kind` decides the names of columns that no header names.
pub(crate) fn read(
    source: &mut Source<'_>,
    head: &[u8],
    kind: TextKind,
) -> Result<(Table, ReadReport), TextError> {
    check_text(head)?;
    let line_end = if head.contains(&b'\r') && !head.contains(&b'\n') { b'\r' } else { b'\n' };
    let mut reader = Reader::new(kind);
    let mut row = Row::default();
    let mut number = 0;
    while let Some(line) = source.next_line(line_end)? {
        number += 1;
        if reader.quick(line) {
            continue;
        }
        let content = if number == 1 { line.strip_prefix(BOM).unwrap_or(line) } else { line }.trim_ascii();
        if content.is_empty() {
            continue;
        }
        if is_comment(content) {
            reader.comment(number, content)?;
            continue;
        }
        split(content, &mut row);
        reader.line(number, content, &mut row)?;
    }
    reader.finish()
}

const BOM: &[u8] = b"\xEF\xBB\xBF";

/// Refuses bytes that are not UTF-8 text; the head may end within a character.
fn check_text(head: &[u8]) -> Result<(), TextError> {
    let invalid = str::from_utf8(head).err().filter(|error| error.error_len().is_some());
    let bytes = [head.iter().position(|byte| *byte == 0), invalid.map(|error| error.valid_up_to())];
    match bytes.into_iter().flatten().min() {
        Some(byte) => Err(TextError::Binary { byte }),
        None => Ok(()),
    }
}

/// What has been understood of a file so far.
struct Reader {
    kind: TextKind,
    comments: Vec<String>,
    /// The first line of content, for the error that there are no rows.
    first: Option<String>,
    /// A lone number in the first line: the points of a PTS file, or the first row of a single column.
    count: Option<(u64, f64)>,
    header: Option<(u64, Vec<String>)>,
    body: Option<Body>,
}

/// The columns, from the first row on.
struct Body {
    first_line: u64,
    columns: Vec<Column>,
    positional: bool,
    quick: Option<Quick>,
    /// Empty fields and the line of the first.
    empty: usize,
    first_empty: u64,
}

impl Reader {
    fn new(kind: TextKind) -> Self {
        Self { kind, comments: Vec::new(), first: None, count: None, header: None, body: None }
    }

    /// Whether a line was a row of plain numbers, which is taken.
    fn quick(&mut self, line: &[u8]) -> bool {
        let Some(Body { quick: Some(quick), columns, .. }) = &mut self.body else { return false };
        quick.take(line, columns)
    }

    fn comment(&mut self, line: u64, content: &[u8]) -> Result<(), TextError> {
        let text = fields::comment_text(content);
        let text = str::from_utf8(text).map_err(|_| not_text(line, text))?;
        self.comments.push(text.trim().to_owned());
        Ok(())
    }

    fn line(&mut self, line: u64, content: &[u8], row: &mut Row) -> Result<(), TextError> {
        if let Some(body) = &mut self.body {
            return body.push(line, content, row, self.header.as_ref());
        }
        let opening = self.first.is_none();
        self.first.get_or_insert_with(|| excerpt(content));
        if self.header.is_none() {
            row.drop_empty_end();
        }
        let whole = |n: &f64| *n >= 0.0 && n.trunc() == *n;
        if opening
            && row.len() == 1
            && let Some(count) = row.number(content, 0).filter(whole)
        {
            self.count = Some((line, count));
            return Ok(());
        }
        if self.header.is_none() && names::is_header(content, row) {
            let header = names::header(line, content, row)?;
            self.header = Some((line, header));
            return Ok(());
        }
        self.start(line, content, row)
    }

    /// Takes the first row: it settles the number of columns, their names and which are numbers.
    fn start(&mut self, line: u64, content: &[u8], row: &mut Row) -> Result<(), TextError> {
        if row.has_decimal_comma(content) {
            return Err(TextError::DecimalComma { line });
        }
        let mut positional = false;
        let names = match &self.header {
            Some((header, names)) => {
                if !names::has_coordinates(names) && (0..row.len()).all(|i| row.is_word(content, i)) {
                    // Words above words: prose, not a table.
                    return Err(TextError::NoRows { first: self.first.take().unwrap_or_default() });
                }
                names::check_unique(*header, names)?;
                names.clone()
            }
            None => match self.comments.last().and_then(|comment| names::in_comment(comment, row.len())) {
                Some(names) => {
                    self.comments.pop();
                    names
                }
                None => {
                    positional = true;
                    names::by_position(row.len(), self.kind)
                }
            },
        };
        let columns = names.into_iter().enumerate().map(|(i, name)| {
            let is_text = !crate::roles::is_coordinate(&name) && row.is_word(content, i);
            Column::new(name, if is_text { Data::Text(Vec::new()) } else { Data::F64(Vec::new()) })
        });
        let columns: Vec<Column> = columns.collect();
        let quick = Quick::new(&columns);
        let mut body = Body { first_line: line, columns, positional, quick, empty: 0, first_empty: 0 };
        // A lone number above rows of one column is the first of them.
        if self.header.is_none()
            && let (Some((_, first)), [Column { data: Data::F64(values), .. }]) =
                (self.count, body.columns.as_mut_slice())
        {
            values.push(first);
            self.count = None;
        }
        body.push(line, content, row, self.header.as_ref())?;
        self.body = Some(body);
        Ok(())
    }

    fn finish(mut self) -> Result<(Table, ReadReport), TextError> {
        let mut report = ReadReport::default();
        let Some(mut body) = self.body.take() else { return self.finish_without_rows(report) };
        body.flush();
        let rows = body.columns.first().map_or(0, |column| column.data.len());
        if let Some((line, count)) = self.count.filter(|(_, count)| *count != rows as f64) {
            if self.kind != TextKind::Pts {
                let (first, wanted) = (line, 1);
                return Err(TextError::RowLength {
                    line: body.first_line,
                    found: body.columns.len(),
                    first,
                    wanted,
                });
            }
            report.stated_rows = Some(count as u64);
            report.notes.push(format!("PTS count says {count}, file has {rows} rows"));
        }
        if body.positional {
            recognise_colours(&mut body.columns);
            let names: Vec<&str> = body.columns.iter().map(|column| column.name.as_str()).collect();
            report.notes.push(format!("no header: columns taken by position as {}", names.join(" ")));
        }
        if body.empty > 0 {
            report.notes.push(format!(
                "{} empty fields read as nan, the first in line {}",
                body.empty, body.first_empty
            ));
        }
        for column in body.columns.iter().filter(|column| matches!(column.data, Data::Text(_))) {
            report.notes.push(format!("column `{}` holds no numbers: kept as text", column.name));
        }
        Ok((Table { columns: body.columns, comments: self.comments, ..Table::default() }, report))
    }

    /// A file of a header alone is an empty table if the header names coordinates, as our own writer's does.
    fn finish_without_rows(mut self, mut report: ReadReport) -> Result<(Table, ReadReport), TextError> {
        let empty = |names: Vec<String>| {
            names.into_iter().map(|name| Column::new(name, Data::F64(Vec::new()))).collect::<Vec<_>>()
        };
        let from_comment = self.comments.last().and_then(|comment| names::coordinates_in(comment));
        let columns = match (self.header, self.count, from_comment) {
            (Some((line, names)), None, _) if names::has_coordinates(&names) => {
                names::check_unique(line, &names)?;
                empty(names)
            }
            (None, None, Some(names)) if self.first.is_none() => {
                self.comments.pop();
                empty(names)
            }
            (None, Some((_, 0.0)), _) if self.kind == TextKind::Pts => {
                empty(names::by_position(3, self.kind))
            }
            (None, Some((_, value)), _) if self.kind != TextKind::Pts => {
                report.notes.push("no header: columns taken by position as column_1".to_owned());
                vec![Column::new("column_1", Data::F64(vec![value]))]
            }
            _ => return Err(TextError::NoRows { first: self.first.unwrap_or_default() }),
        };
        Ok((Table { columns, comments: self.comments, ..Table::default() }, report))
    }
}

impl Body {
    fn flush(&mut self) {
        if let Some(quick) = &mut self.quick {
            quick.flush(&mut self.columns);
        }
    }

    fn push(
        &mut self,
        line: u64,
        content: &[u8],
        row: &mut Row,
        header: Option<&(u64, Vec<String>)>,
    ) -> Result<(), TextError> {
        self.flush();
        let wanted = self.columns.len();
        if row.len() == wanted + 1 {
            row.drop_empty_end();
        }
        let found = row.len();
        if found != wanted {
            return Err(match header {
                Some((header, _)) => TextError::HeaderLength { line, found, header: *header, wanted },
                None => TextError::RowLength { line, found, first: self.first_line, wanted },
            });
        }
        for (index, column) in self.columns.iter_mut().enumerate() {
            match &mut column.data {
                Data::Text(values) => {
                    values.push(row.text(content, index).map_err(|field| not_text(line, field))?);
                }
                Data::F64(values) if row.is_empty(content, index) => {
                    values.push(f64::NAN);
                    self.first_empty = if self.empty == 0 { line } else { self.first_empty };
                    self.empty += 1;
                }
                Data::F64(values) => match row.number(content, index) {
                    Some(number) => values.push(number),
                    None => {
                        let (name, content) = (column.name.clone(), excerpt(row.raw(content, index)));
                        return Err(TextError::NotANumber { line, column: index + 1, name, content });
                    }
                },
                _ => {}
            }
        }
        Ok(())
    }
}

/// The error for a field or comment of bytes that are no text, far behind the checked head.
fn not_text(line: u64, content: &[u8]) -> TextError {
    TextError::NotText { line, content: excerpt(content) }
}
