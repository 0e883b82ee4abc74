//! Reading Wavefront OBJ: the vertices with colours and normals; faces and all else are passed over and counted.
//!
//! Own reader: `tobj` gives every face corner a vertex of its own, drops vertices without a face, and takes
//! the fourth of four numbers for nothing, so that points would change in number and order.

mod error;

use crate::excerpt::excerpt;
use crate::source::Source;
use crate::{Column, Data, ReadReport, Table};
pub use error::ObjError;

/// Numbers of a `v` line: x y z, or x y z w, or x y z r g b, or x y z w r g b.
const MOST: usize = 7;

/// Whether a file of these first bytes is OBJ, for a name that does not say so: a vertex stands before anything else
/// but comments, names and normals.
pub(crate) fn is_obj(head: &[u8]) -> bool {
    let mut lines = head.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let other = |line: &[u8]| {
        line.is_empty()
            || line.starts_with(b"#")
            || matches!(words(line).next(), Some(b"vn" | b"vt" | b"o" | b"g" | b"mtllib" | b"usemtl" | b"s"))
    };
    lines.find(|line| !other(line)).is_some_and(|line| {
        let mut words = words(line);
        // A header may name a column `v`.
        words.next() == Some(b"v") && words.next().is_some_and(|x| fast_float2::parse::<f64, _>(x).is_ok())
    })
}

pub(crate) fn read(source: &mut Source<'_>, head: &[u8]) -> Result<(Table, ReadReport), ObjError> {
    if let Some(byte) = memchr::memchr(0, head) {
        return Err(ObjError::Binary { byte });
    }
    let line_end = if head.contains(&b'\r') && !head.contains(&b'\n') { b'\r' } else { b'\n' };
    let mut reader = Reader::default();
    let mut number = 0;
    // A line that goes on in the next one, which only long faces do.
    let mut begun: Vec<u8> = Vec::new();
    while let Some(line) = source.next_line(line_end)? {
        number += 1;
        let line = line.trim_ascii();
        if let Some(part) = line.strip_suffix(b"\\") {
            begun.extend_from_slice(part);
            begun.push(b' ');
        } else if begun.is_empty() {
            reader.line(number, line)?;
        } else {
            begun.extend_from_slice(line);
            reader.line(number, begun.trim_ascii())?;
            begun.clear();
        }
    }
    reader.line(number, begun.trim_ascii())?;
    reader.finish()
}

#[derive(Default)]
struct Reader {
    comments: Vec<String>,
    /// One column for each number of a vertex line, and the line of the first vertex.
    vertices: Vec<Vec<f64>>,
    first: u64,
    normals: [Vec<f64>; 3],
    /// Whether any corner of a face joins a vertex to the normal of another number.
    crossed: bool,
    textures: u64,
    faces: u64,
    curves: u64,
}

impl Reader {
    fn line(&mut self, number: u64, line: &[u8]) -> Result<(), ObjError> {
        let mut words = words(line);
        match words.next() {
            None => {}
            Some(b"v") => self.vertex(number, words)?,
            Some(b"vn") => {
                let mut values = [0.0; MOST];
                if numbers(number, words, &mut values)? != 3 {
                    return Err(ObjError::Normal { line: number });
                }
                self.normals.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
            }
            Some(b"vt") => self.textures += 1,
            Some(b"f") => {
                self.faces += 1;
                let (vertices, normals) = (self.rows(), self.normals[0].len());
                self.crossed |= words.any(|corner| is_crossed(corner, vertices, normals));
            }
            Some(b"l" | b"p") => self.faces += 1,
            Some(first) if first.starts_with(b"#") => {
                let text = String::from_utf8_lossy(line.get(1..).unwrap_or_default());
                self.comments.push(text.trim().to_owned());
            }
            // Names, groups, materials and smoothing say nothing of points.
            Some(
                b"o" | b"g" | b"s" | b"mtllib" | b"usemtl" | b"usemap" | b"maplib" | b"mg" | b"bevel"
                | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj",
            ) => {}
            // The free-form curves and surfaces of the format's description, appendix B1.
            Some(
                b"vp" | b"deg" | b"bmat" | b"step" | b"cstype" | b"curv" | b"curv2" | b"surf" | b"parm"
                | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech" | b"stech" | b"call"
                | b"csh",
            ) => self.curves += 1,
            Some(_) => return Err(ObjError::Keyword { line: number, content: excerpt(line) }),
        }
        Ok(())
    }

    fn vertex<'a>(&mut self, line: u64, words: impl Iterator<Item = &'a [u8]>) -> Result<(), ObjError> {
        let mut values = [0.0; MOST];
        let found = numbers(line, words, &mut values)?;
        if self.vertices.is_empty() {
            if !matches!(found, 3 | 4 | 6 | MOST) {
                return Err(ObjError::Vertex { line, found });
            }
            self.vertices = vec![Vec::new(); found];
            self.first = line;
        } else if found != self.vertices.len() {
            return Err(ObjError::Width { line, found, first: self.first, wanted: self.vertices.len() });
        }
        self.vertices.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        Ok(())
    }

    fn rows(&self) -> usize {
        self.vertices.first().map_or(0, Vec::len)
    }

    fn finish(self) -> Result<(Table, ReadReport), ObjError> {
        let (rows, normals) = (self.rows(), self.normals[0].len());
        if rows == 0 {
            return Err(ObjError::NoVertices);
        }
        let names: &[&str] = match self.vertices.len() {
            6 => &["x", "y", "z", "red", "green", "blue"],
            _ => &["x", "y", "z", "w", "red", "green", "blue"],
        };
        let column = |(name, values): (&&str, Vec<f64>)| Column::new(*name, Data::F64(values));
        let mut columns: Vec<Column> = names.iter().zip(self.vertices).map(column).collect();
        let mut report = ReadReport::default();
        if normals == rows && !self.crossed {
            columns.extend(["nx", "ny", "nz"].iter().zip(self.normals).map(column));
        } else if normals > 0 {
            report.notes.push(format!(
                "{normals} normals passed over: they belong to corners of faces, not one to each of {rows} vertices"
            ));
        }
        for (count, what) in [
            (self.faces, "faces, lines and points"),
            (self.textures, "texture coordinates"),
            (self.curves, "lines of curves"),
        ] {
            if count > 0 {
                report.notes.push(format!("{count} {what} passed over"));
            }
        }
        Ok((Table { columns, comments: self.comments, ..Table::default() }, report))
    }
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// The numbers of a line into `values`; how many there are, up to a comment.
fn numbers<'a>(
    line: u64,
    words: impl Iterator<Item = &'a [u8]>,
    values: &mut [f64; MOST],
) -> Result<usize, ObjError> {
    let mut found = 0;
    for word in words.take_while(|word| !word.starts_with(b"#")) {
        let number =
            fast_float2::parse(word).map_err(|_| ObjError::NotANumber { line, content: excerpt(word) })?;
        if let Some(place) = values.get_mut(found) {
            *place = number;
        }
        found += 1;
    }
    Ok(found)
}

/// Whether a corner `v/vt/vn` names a normal of another number than its vertex.
fn is_crossed(corner: &[u8], vertices: usize, normals: usize) -> bool {
    let mut parts = corner.split(|byte| *byte == b'/');
    // Numbers count from 1, negative ones from the last one so far.
    let place = |part: Option<&[u8]>, count: usize| {
        let number: i64 = str::from_utf8(part?).ok()?.parse().ok()?;
        Some(if number < 0 { number.wrapping_add(count as i64) + 1 } else { number })
    };
    let vertex = place(parts.next(), vertices);
    let normal = place(parts.nth(1), normals);
    normal.is_some() && normal != vertex
}
