//! The header of a PCD file: which fields its points have, how many there are, how they are stored.

use super::{PcdEncoding, PcdError};
use crate::excerpt::excerpt;
use crate::scalar::Scalar;
use crate::source::Source;

/// Columns of the widest files: descriptors have a few hundred.
const MOST_COLUMNS: u64 = 1 << 16;

pub(super) struct Header {
    pub(super) fields: Vec<Field>,
    pub(super) width: u64,
    pub(super) height: u64,
    pub(super) viewpoint: Option<[f64; 7]>,
    pub(super) points: u64,
    pub(super) encoding: PcdEncoding,
    /// Comment lines, but the one that names the format.
    pub(super) comments: Vec<String>,
    /// What was passed over or guessed.
    pub(super) notes: Vec<String>,
}

/// What a point has one or several values of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub(super) name: String,
    /// Bytes of one value.
    pub(super) size: u64,
    /// `None` for bytes without a meaning, named `_`.
    pub(super) scalar: Option<Scalar>,
    /// Values in a row.
    pub(super) count: u64,
    /// Whether it is a colour packed into four bytes.
    pub(super) is_packed_colour: bool,
}

impl Field {
    pub(super) fn bytes(&self) -> u64 {
        self.size.saturating_mul(self.count)
    }

    /// The name of one of its columns.
    pub(super) fn column_name(&self, index: u64) -> String {
        if self.count == 1 { self.name.clone() } else { format!("{}_{index}", self.name) }
    }
}

/// The lines of the header as they come.
#[derive(Default)]
struct Lines {
    names: Option<Vec<String>>,
    sizes: Option<Vec<u64>>,
    types: Option<Vec<String>>,
    counts: Option<Vec<u64>>,
    width: Option<u64>,
    height: Option<u64>,
    viewpoint: Option<[f64; 7]>,
    points: Option<u64>,
    comments: Vec<String>,
    notes: Vec<String>,
}

/// Whether a file of these first bytes claims to be PCD: by its first comment, or, without that, by a header from
/// `VERSION` or `FIELDS` to `DATA`.
pub(super) fn is_pcd(head: &[u8]) -> bool {
    if head.starts_with(b"# .PCD") {
        return true;
    }
    let key =
        |line: &[u8]| line.split(u8::is_ascii_whitespace).next().map(<[u8]>::to_vec).unwrap_or_default();
    let mut keys =
        head.split(|&b| b == b'\n').map(key).filter(|key| !key.is_empty() && !key.starts_with(b"#"));
    let first = keys.next().unwrap_or_default();
    matches!(first.as_slice(), b"VERSION" | b"FIELDS" | b"COLUMNS") && keys.any(|key| key == b"DATA")
}

/// Reads up to and with the line `DATA`.
pub(super) fn read(source: &mut Source<'_>) -> Result<Header, PcdError> {
    let mut lines = Lines::default();
    let mut line = Vec::new();
    while source.read_line(b'\n', &mut line)? {
        let wrong = |what| PcdError::Header { line: source.line_number(), what, content: excerpt(&line) };
        let text = str::from_utf8(&line).map_err(|_| wrong("not text"))?;
        let mut words = text.split_whitespace();
        if let Some(comment) = text.trim().strip_prefix('#') {
            let comment = comment.strip_prefix(' ').unwrap_or(comment);
            if !comment.starts_with(".PCD") {
                lines.comments.push(comment.to_owned());
            }
            continue;
        }
        let Some(key) = words.next() else { continue };
        let words: Vec<&str> = words.collect();
        if key == "DATA" {
            let encoding = match words.as_slice() {
                ["ascii"] => PcdEncoding::Ascii,
                ["binary"] => PcdEncoding::Binary,
                ["binary_compressed"] => PcdEncoding::Compressed,
                _ => return Err(wrong("PCD has DATA ascii, binary and binary_compressed")),
            };
            return lines.finish(encoding);
        }
        lines.take(key, &words).map_err(wrong)?;
    }
    Err(PcdError::HeaderEnd { line: source.line_number() })
}

impl Lines {
    fn take(&mut self, key: &str, words: &[&str]) -> Result<(), &'static str> {
        let whole = |word: &&str| word.parse::<u64>().map_err(|_| "a whole number is expected");
        let wholes = || words.iter().map(whole).collect::<Result<Vec<_>, _>>();
        let one = || match words {
            [word] => whole(word),
            _ => Err("one whole number is expected"),
        };
        let owned = || words.iter().map(|word| (*word).to_owned()).collect();
        match key {
            "VERSION" => {
                let version = words.first().map(|word| word.trim_start_matches('0'));
                if !matches!(version, Some(".5" | ".6" | ".7")) {
                    let found = excerpt(words.join(" ").as_bytes());
                    self.notes.push(format!("PCD version `{found}` is unknown; read like 0.7"));
                }
            }
            "FIELDS" | "COLUMNS" => self.names = Some(owned()),
            "SIZE" => self.sizes = Some(wholes()?),
            "TYPE" => self.types = Some(owned()),
            "COUNT" => self.counts = Some(wholes()?),
            "WIDTH" => self.width = Some(one()?),
            "HEIGHT" => self.height = Some(one()?),
            "POINTS" => self.points = Some(one()?),
            "VIEWPOINT" => {
                let numbers: Option<Vec<f64>> = words.iter().map(|word| word.parse().ok()).collect();
                let seven = numbers.and_then(|numbers| <[f64; 7]>::try_from(numbers).ok());
                self.viewpoint = Some(seven.ok_or("seven numbers are expected")?);
            }
            _ if key.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                self.notes.push(format!("header line `{}` was passed over", excerpt(key.as_bytes())));
            }
            _ => return Err("not a line of a PCD header; if the file is text, rename it to .txt or .xyz"),
        }
        Ok(())
    }

    fn finish(mut self, encoding: PcdEncoding) -> Result<Header, PcdError> {
        let fields = self.fields()?;
        let width = self.width.or(self.points).ok_or(PcdError::Missing("WIDTH"))?;
        let height = self.height.unwrap_or(1);
        let area = width.saturating_mul(height);
        let points = self.points.unwrap_or(area);
        if points != area {
            self.notes
                .push(format!("POINTS is {points}, WIDTH x HEIGHT is {width} x {height}; POINTS was taken"));
        }
        let Self { viewpoint, comments, notes, .. } = self;
        Ok(Header { fields, width, height, viewpoint, points, encoding, comments, notes })
    }

    fn fields(&mut self) -> Result<Vec<Field>, PcdError> {
        let names = self.names.take().ok_or(PcdError::Missing("FIELDS"))?;
        let sizes = self.sizes.take().ok_or(PcdError::Missing("SIZE"))?;
        let types = self.types.take().ok_or(PcdError::Missing("TYPE"))?;
        let counts = self.counts.take().unwrap_or_else(|| vec![1; names.len()]);
        let wanted = names.len();
        for (key, found) in [("SIZE", sizes.len()), ("TYPE", types.len()), ("COUNT", counts.len())] {
            if found != wanted {
                return Err(PcdError::Lengths { key, found, wanted });
            }
        }
        let columns = counts.iter().fold(0_u64, |sum, &count| sum.saturating_add(count));
        if columns > MOST_COLUMNS {
            return Err(PcdError::TooWide { columns, most: MOST_COLUMNS });
        }
        let mut fields = Vec::new();
        for (((name, size), kind), mut count) in names.into_iter().zip(sizes).zip(types).zip(counts) {
            if count == 0 {
                self.notes.push(format!("COUNT of field `{}` is 0; 1 was taken", excerpt(name.as_bytes())));
                count = 1;
            }
            let scalar = scalar(&kind, size);
            let is_padding = name == "_";
            if (scalar.is_none() && !is_padding) || size == 0 {
                return Err(PcdError::Type { name, kind: excerpt(kind.as_bytes()), size });
            }
            let is_packed_colour = matches!(name.as_str(), "rgb" | "rgba") && size == 4 && count == 1;
            let scalar = scalar.filter(|_| !is_padding);
            fields.push(Field { name, size, scalar, count, is_packed_colour });
        }
        Ok(fields)
    }
}

fn scalar(kind: &str, size: u64) -> Option<Scalar> {
    Some(match (kind, size) {
        ("I", 1) => Scalar::I8,
        ("U", 1) => Scalar::U8,
        ("I", 2) => Scalar::I16,
        ("U", 2) => Scalar::U16,
        ("I", 4) => Scalar::I32,
        ("U", 4) => Scalar::U32,
        ("I", 8) => Scalar::I64,
        ("U", 8) => Scalar::U64,
        ("F", 4) => Scalar::F32,
        ("F", 8) => Scalar::F64,
        _ => return None,
    })
}

/// The letter of a type in the line `TYPE`.
pub(super) fn type_letter(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::I8 | Scalar::I16 | Scalar::I32 | Scalar::I64 => "I",
        Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => "U",
        Scalar::F32 | Scalar::F64 => "F",
    }
}
