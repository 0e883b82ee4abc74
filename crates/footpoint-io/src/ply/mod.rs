//! Reading PLY: the header, then the elements one after the other, of which `vertex` is kept.
//!
//! Own reader: `ply-rs-bw` builds one struct per row through `new()` and named setters, so columns whose
//! names and types only the header knows would be a map per row, and it takes no CR-only header.

mod ascii;
mod binary;
mod error;
mod header;

use std::io::ErrorKind;

use crate::rows::Order;
use crate::source::Source;
use crate::{Column, Encoding, OtherElement, ReadReport, Table};
pub(crate) use ascii::push;
pub use error::PlyError;
use header::{Element, Header, Kind};

/// Whether a file of these first bytes claims to be PLY.
pub(crate) fn is_ply(head: &[u8]) -> bool {
    let end = head.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(head.len());
    head.get(..end).is_some_and(|line| line.trim_ascii() == b"ply")
}

pub(crate) fn read(source: &mut Source<'_>, head: &[u8]) -> Result<(Table, Encoding, ReadReport), PlyError> {
    let header = header::read(source, head)?;
    let others = header.elements.iter().filter(|element| element.name != "vertex");
    let others = others.map(|element| OtherElement { name: element.name.clone(), rows: element.rows });
    let mut report = ReadReport { other_elements: others.collect(), ..ReadReport::default() };
    let mut table = None;
    for element in &header.elements {
        if element.name == "vertex" {
            table = Some(read_vertices(source, &header, element, &mut report)?);
        } else if let Err(error) = pass_over(source, &header, element) {
            if table.is_none() || !is_harmless(&error) {
                return Err(error);
            }
            report.notes.push(format!("the vertices are complete, but behind them: {error}"));
            break;
        }
    }
    let Some(table) = table else {
        return Err(PlyError::NoVertex { found: header.element_names() });
    };
    if report.notes.is_empty() && has_more(source, &header)? {
        report.notes.push("data behind the last element were not read".to_owned());
    }
    Ok((table, header.encoding, report))
}

/// Whether an error behind the vertices leaves them as they are. A disk or a gzip checksum that fails
/// there casts doubt on all that was read before.
fn is_harmless(error: &PlyError) -> bool {
    !matches!(error, PlyError::Io(error) if error.kind() != ErrorKind::UnexpectedEof)
}

/// Whether anything but blank lines follows the last element.
fn has_more(source: &mut Source<'_>, header: &Header) -> Result<bool, PlyError> {
    match header.encoding {
        Encoding::Ascii => ascii::next_row(source, header.line_end, &mut Vec::new()),
        Encoding::LittleEndian | Encoding::BigEndian => Ok(!source.at_end()?),
    }
}

fn read_vertices(
    source: &mut Source<'_>,
    header: &Header,
    element: &Element,
    report: &mut ReadReport,
) -> Result<Table, PlyError> {
    let columns = match header.encoding {
        Encoding::Ascii => ascii::read(source, header.line_end, element)?,
        Encoding::LittleEndian => binary::read(source, Order::Little, element)?,
        Encoding::BigEndian => binary::read(source, Order::Big, element)?,
    };
    let lists = element.properties.iter().filter(|p| matches!(p.kind, Kind::List { .. }));
    report.skipped_lists = lists.map(|p| p.name.clone()).collect();
    let names = element.properties.iter().filter(|p| matches!(p.kind, Kind::Scalar(_)));
    let columns = names.zip(columns).map(|(p, data)| Column::new(p.name.clone(), data)).collect();
    Ok(Table { columns, comments: header.comments.clone(), ..Table::default() })
}

fn pass_over(source: &mut Source<'_>, header: &Header, element: &Element) -> Result<(), PlyError> {
    match header.encoding {
        Encoding::Ascii => ascii::pass_over(source, header.line_end, element),
        Encoding::LittleEndian => binary::pass_over(source, Order::Little, element),
        Encoding::BigEndian => binary::pass_over(source, Order::Big, element),
    }
}
