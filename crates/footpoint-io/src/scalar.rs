//! The ten number types a column can have, with their PLY names and sizes.

use crate::Data;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Both name families that PLY files use, for error messages.
pub(crate) const PLY_TYPE_NAMES: &str = "char uchar short ushort int uint float double \
     int8 uint8 int16 uint16 int32 uint32 float32 float64";

impl Scalar {
    pub(crate) fn from_ply_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// The older name family: every PLY reader knows it. PLY has no wide integers; doubles hold those up to 2⁵³.
    pub(crate) fn ply_name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::I64 | Self::U64 | Self::F64 => "double",
        }
    }

    /// Bytes of one value in a binary file.
    pub(crate) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(crate) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// An empty column of this type with room for `rows` values.
    pub(crate) fn column(self, rows: usize) -> Data {
        match self {
            Self::I8 => Data::I8(Vec::with_capacity(rows)),
            Self::U8 => Data::U8(Vec::with_capacity(rows)),
            Self::I16 => Data::I16(Vec::with_capacity(rows)),
            Self::U16 => Data::U16(Vec::with_capacity(rows)),
            Self::I32 => Data::I32(Vec::with_capacity(rows)),
            Self::U32 => Data::U32(Vec::with_capacity(rows)),
            Self::I64 => Data::I64(Vec::with_capacity(rows)),
            Self::U64 => Data::U64(Vec::with_capacity(rows)),
            Self::F32 => Data::F32(Vec::with_capacity(rows)),
            Self::F64 => Data::F64(Vec::with_capacity(rows)),
        }
    }

    /// The type of a column's numbers, `None` for a text column.
    pub(crate) fn of(data: &Data) -> Option<Self> {
        Some(match data {
            Data::I8(_) => Self::I8,
            Data::U8(_) => Self::U8,
            Data::I16(_) => Self::I16,
            Data::U16(_) => Self::U16,
            Data::I32(_) => Self::I32,
            Data::U32(_) => Self::U32,
            Data::I64(_) => Self::I64,
            Data::U64(_) => Self::U64,
            Data::F32(_) => Self::F32,
            Data::F64(_) => Self::F64,
            Data::Text(_) => return None,
        })
    }
}
