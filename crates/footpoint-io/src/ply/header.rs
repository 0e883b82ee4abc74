//! The header of a PLY file: encoding, comments, elements and their properties.

use std::collections::HashSet;

use super::PlyError;
use crate::Encoding;
use crate::excerpt::excerpt;
use crate::scalar::Scalar;
use crate::source::Source;

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) comments: Vec<String>,
    pub(super) elements: Vec<Element>,
    /// The last byte of each line: CR in files of the old Mac, else LF.
    pub(super) line_end: u8,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) rows: u64,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, value: Scalar },
}

impl Header {
    pub(super) fn element_names(&self) -> String {
        let names: Vec<&str> = self.elements.iter().map(|element| element.name.as_str()).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    }
}

impl Element {
    /// Bytes of a binary row, lists taken as empty.
    pub(super) fn least_row_bytes(&self) -> u64 {
        self.properties.iter().map(|p| p.kind.least_bytes()).sum()
    }

    /// The error that the file ends in `row`, from 1.
    pub(super) fn end_in_row(&self, row: u64) -> PlyError {
        PlyError::EndInRow { element: self.name.clone(), row, rows: self.rows }
    }

    pub(super) fn has_lists(&self) -> bool {
        self.properties.iter().any(|p| matches!(p.kind, Kind::List { .. }))
    }
}

impl Kind {
    fn least_bytes(self) -> u64 {
        match self {
            Self::Scalar(scalar) => scalar.size(),
            Self::List { count, .. } => count.size(),
        }
    }
}

pub(super) fn read(source: &mut Source<'_>, head: &[u8]) -> Result<Header, PlyError> {
    let line_end = line_end(head);
    let mut encoding = None;
    let mut comments = Vec::new();
    let mut elements: Vec<Element> = Vec::new();
    let mut vertex_names = HashSet::new();
    let mut line = Vec::new();
    loop {
        if !source.read_line(line_end, &mut line)? {
            return Err(PlyError::HeaderEnd { line: source.line_number() });
        }
        let number = source.line_number();
        let wrong = |what| PlyError::Header { line: number, what, content: excerpt(line.trim_ascii()) };
        let text = decode(line.trim_ascii());
        let mut words = text.split_ascii_whitespace();
        match words.next() {
            None => {}
            Some("ply") if number == 1 => {}
            Some("format") if encoding.is_some() => return Err(wrong("a second `format` line")),
            Some("format") => {
                encoding = Some(match (words.next(), words.next()) {
                    (Some("ascii"), Some("1.0")) => Encoding::Ascii,
                    (Some("binary_little_endian"), Some("1.0")) => Encoding::LittleEndian,
                    (Some("binary_big_endian"), Some("1.0")) => Encoding::BigEndian,
                    _ => return Err(wrong("unknown PLY format, only version 1.0 is known")),
                });
            }
            Some("comment") => comments.push(text.strip_prefix("comment").unwrap_or(&text).trim().to_owned()),
            // The word stays, so that the line can be written as what it was.
            Some("obj_info") => comments.push(text.clone()),
            Some("element") => {
                let (Some(name), Some(rows), None) = (words.next(), words.next(), words.next()) else {
                    return Err(wrong("an element wants a name and a count"));
                };
                let rows =
                    rows.parse().map_err(|_| wrong("the count of an element is a whole number from 0"))?;
                if name == "vertex" && elements.iter().any(|element| element.name == name) {
                    return Err(wrong("a second element `vertex`"));
                }
                elements.push(Element { name: name.to_owned(), rows, properties: Vec::new() });
            }
            Some("property") => {
                let property = property(number, words, &wrong)?;
                let element = elements.last_mut().ok_or_else(|| wrong("a property before any element"))?;
                if element.name == "vertex" && !vertex_names.insert(property.name.clone()) {
                    return Err(wrong("a second property of the same name"));
                }
                element.properties.push(property);
            }
            Some("end_header") => break,
            Some(_) => return Err(wrong("not a line of a PLY header")),
        }
    }
    let encoding = encoding.ok_or(PlyError::NoFormat)?;
    Ok(Header { encoding, comments, elements, line_end })
}

fn property<'a>(
    line: u64,
    mut words: impl Iterator<Item = &'a str>,
    wrong: &dyn Fn(&'static str) -> PlyError,
) -> Result<Property, PlyError> {
    let scalar = |name: &str| {
        Scalar::from_ply_name(name)
            .ok_or_else(|| PlyError::UnknownType { line, name: excerpt(name.as_bytes()) })
    };
    let mut word = || words.next().ok_or_else(|| wrong("a property wants a type and a name"));
    let kind = match word()? {
        "list" => {
            let (count, value) = (scalar(word()?)?, scalar(word()?)?);
            if !count.is_integer() {
                return Err(wrong("a list cannot be counted by a floating-point type"));
            }
            Kind::List { count, value }
        }
        name => Kind::Scalar(scalar(name)?),
    };
    let name = word()?.to_owned();
    if words.next().is_some() {
        return Err(wrong("words behind the name of a property"));
    }
    Ok(Property { name, kind })
}

fn line_end(head: &[u8]) -> u8 {
    let mut ends = head.iter().copied().skip_while(|b| !matches!(b, b'\n' | b'\r'));
    match (ends.next(), ends.next()) {
        (Some(b'\r'), next) if next != Some(b'\n') => b'\r',
        _ => b'\n',
    }
}

/// Header text; old tools wrote Latin-1, which maps to Unicode byte by byte.
fn decode(bytes: &[u8]) -> String {
    match str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}
