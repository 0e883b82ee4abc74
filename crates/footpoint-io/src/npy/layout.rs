//! Where the columns of an array lie in its bytes.

use npyz::{DType, Endianness, TypeChar, TypeStr};

use super::NpyError;
use super::header::Header;
use crate::rows::Order;
use crate::scalar::Scalar;
use crate::text::by_position;

/// Columns that are read; a claim of more is a broken file.
const MOST_COLUMNS: usize = 4096;

/// An array as rows of fields.
pub(super) struct Layout {
    pub(super) rows: u64,
    /// Bytes from row to row, at least one.
    pub(super) stride: u64,
    /// 1, or in Fortran's order the number of fields, whose columns then follow each other.
    pub(super) runs: u64,
    pub(super) fields: Vec<Field>,
    /// Whether nothing but their places names the columns.
    pub(super) by_position: bool,
    /// The shape, if rows were laid out in more than one dimension.
    grid: Option<Vec<u64>>,
}

pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) order: Order,
    /// Bytes from the start of a row.
    pub(super) offset: u64,
}

/// The type of a field.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Number(Scalar),
    /// Text of so many bytes.
    Bytes(u64),
    /// Text of so many characters of four bytes.
    Characters(u64),
}

/// How the columns of an array without records are called.
#[derive(Clone, Copy)]
pub(super) enum Names<'n> {
    /// By their places, as those of a text file; one-dimensional arrays are refused.
    ByPosition,
    /// By the array's own name.
    Of(&'n str),
}

impl Layout {
    pub(super) fn new(header: &Header, names: Names<'_>) -> Result<Self, NpyError> {
        if header.dtype.uses_pickled_array() {
            return Err(NpyError::Pickled);
        }
        let mut fields = Fields { list: Vec::new(), seen: 0, end: 0 };
        let records = matches!(header.dtype, DType::Record(_));
        let (lengths, width) = match (header.shape.as_slice(), names) {
            (lengths, _) if records => (lengths, None),
            ([], _) => return Err(NpyError::Single),
            (&[rows], Names::ByPosition) => return Err(NpyError::OneDimensional { rows }),
            (lengths @ [_], Names::Of(_)) => (lengths, None),
            ([lengths @ .., width], _) => (lengths, Some(*width)),
        };
        match width {
            None => fields.add(&header.dtype, if let Names::Of(name) = names { name } else { "" })?,
            Some(width) => {
                let width = usize::try_from(width).unwrap_or(usize::MAX);
                if width > MOST_COLUMNS {
                    return Err(NpyError::Columns { most: MOST_COLUMNS });
                }
                for name in columns(names, width) {
                    fields.add(&header.dtype, &name)?;
                }
            }
        }
        let runs = if header.fortran { width.unwrap_or(1).max(1) } else { 1 };
        if header.fortran && lengths.len() > 1 {
            return Err(NpyError::FortranGrid);
        }
        if fields.end == 0 {
            return Err(NpyError::NoFields);
        }
        let grid = (lengths.len() > 1).then(|| header.shape.clone());
        // In Fortran's order a row of a run is one number, and all of a plain array's have the same size.
        let stride = fields.end / runs;
        if runs > 1 {
            fields.list.iter_mut().for_each(|field| field.offset = 0);
        }
        let by_position = width.is_some() && matches!(names, Names::ByPosition);
        Ok(Self { rows: lengths.iter().product(), stride, runs, fields: fields.list, by_position, grid })
    }

    /// What the columns do not show of the array.
    pub(super) fn note(&self) -> Option<String> {
        self.grid.as_ref().map(|shape| format!("array of shape {shape:?} taken row by row"))
    }
}

/// The columns of a two-dimensional array.
fn columns(names: Names<'_>, width: usize) -> Vec<String> {
    let Names::Of(array) = names else { return by_position(width) };
    let known: &[&str] = match array.to_ascii_lowercase().as_str() {
        "points" | "xyz" | "positions" => return by_position(width),
        "normals" if width <= 3 => &["nx", "ny", "nz"],
        "colors" | "colours" | "rgb" if (3..=4).contains(&width) => &["red", "green", "blue", "alpha"],
        _ => &[],
    };
    (0..width).map(|i| known.get(i).map_or_else(|| format!("{array}_{i}"), ToString::to_string)).collect()
}

/// Fields one behind the other.
struct Fields {
    list: Vec<Field>,
    /// Fields and padding so far.
    seen: usize,
    end: u64,
}

impl Fields {
    fn add(&mut self, dtype: &DType, name: &str) -> Result<(), NpyError> {
        self.seen += 1;
        if self.seen > MOST_COLUMNS {
            return Err(NpyError::Columns { most: MOST_COLUMNS });
        }
        match dtype {
            DType::Plain(kind) => self.add_plain(kind, name),
            DType::Array(length, inner) => {
                (0..*length).try_for_each(|index| self.add(inner, &format!("{name}_{index}")))
            }
            DType::Record(fields) => fields.iter().enumerate().try_for_each(|(index, field)| {
                // NumPy writes padding without a name, and gives fields without one the name of their place.
                let padding =
                    matches!(&field.dtype, DType::Plain(kind) if kind.type_char() == TypeChar::RawData);
                let own =
                    if field.name.is_empty() && !padding { format!("f{index}") } else { field.name.clone() };
                let within = !name.is_empty() && self.seen > 1 && !padding;
                self.add(&field.dtype, &if within { format!("{name}_{own}") } else { own })
            }),
        }
    }

    fn add_plain(&mut self, dtype: &TypeStr, name: &str) -> Result<(), NpyError> {
        let size = dtype.size_field();
        let kind = match (dtype.type_char(), size) {
            (TypeChar::Bool, 1) | (TypeChar::Uint, 1) => Some(Kind::Number(Scalar::U8)),
            (TypeChar::Int, 1) => Some(Kind::Number(Scalar::I8)),
            (TypeChar::Int, 2) => Some(Kind::Number(Scalar::I16)),
            (TypeChar::Uint, 2) => Some(Kind::Number(Scalar::U16)),
            (TypeChar::Int, 4) => Some(Kind::Number(Scalar::I32)),
            (TypeChar::Uint, 4) => Some(Kind::Number(Scalar::U32)),
            (TypeChar::Int, 8) => Some(Kind::Number(Scalar::I64)),
            (TypeChar::Uint, 8) => Some(Kind::Number(Scalar::U64)),
            (TypeChar::Float, 4) => Some(Kind::Number(Scalar::F32)),
            (TypeChar::Float, 8) => Some(Kind::Number(Scalar::F64)),
            (TypeChar::ByteStr, _) => Some(Kind::Bytes(size)),
            (TypeChar::UnicodeStr, _) => Some(Kind::Characters(size)),
            (TypeChar::RawData, _) if name.is_empty() => None,
            _ => return Err(NpyError::Type { column: name.to_owned(), kind: dtype.to_string() }),
        };
        let order = if dtype.endianness() == Endianness::Big { Order::Big } else { Order::Little };
        if let Some(kind) = kind {
            self.list.push(Field { name: name.to_owned(), kind, order, offset: self.end });
        }
        let bytes = dtype.num_bytes().and_then(|bytes| u64::try_from(bytes).ok());
        let end = bytes.and_then(|bytes| self.end.checked_add(bytes));
        self.end = end.filter(|end| usize::try_from(*end).is_ok()).ok_or(NpyError::NoFields)?;
        Ok(())
    }
}

impl Kind {
    /// The text at the front of `bytes`, up to the zeros that fill it.
    pub(super) fn text(self, bytes: &[u8], order: Order) -> String {
        let front =
            |size: u64| usize::try_from(size).ok().and_then(|size| bytes.get(..size)).unwrap_or_default();
        match self {
            Self::Number(_) => String::new(),
            Self::Bytes(size) => {
                let field = front(size);
                let end = field.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
                String::from_utf8_lossy(field.get(..end).unwrap_or_default()).into_owned()
            }
            Self::Characters(size) => {
                let codes = front(size.saturating_mul(4)).as_chunks::<4>().0.iter();
                let codes = codes.map(|code| match order {
                    Order::Big => u32::from_be_bytes(*code),
                    Order::Little => u32::from_le_bytes(*code),
                });
                let text: String =
                    codes.map(|c| char::from_u32(c).unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
                text.trim_end_matches('\0').to_owned()
            }
        }
    }
}
