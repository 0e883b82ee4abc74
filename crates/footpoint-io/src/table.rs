//! Tables of named columns: what a point file holds, whatever its format.

use crate::{E57Kept, LasKept, PcdKept};

/// The points of one file: named columns of equal length, one row per point, in the file's order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns, in the file's order; all have the same length.
    pub columns: Vec<Column>,
    /// Comment lines without their mark; a PLY `obj_info` line keeps that word in front, so that it is
    /// written as `obj_info` again.
    pub comments: Vec<String>,
    /// What the file says of its coordinates.
    pub frame: Frame,
    /// What only a file of the same format can hold, and is written back there.
    pub kept: Option<Kept>,
}

/// What a file says of its coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// The coordinate reference system as the file states it: WKT, or `EPSG:` and a number.
    pub crs: Option<String>,
    /// The unit of `x` and `y`, where the file tells it.
    pub unit: Option<Unit>,
}

/// A unit of coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// The metre.
    Metre,
    /// 0.3048 m.
    Foot,
    /// 1200/3937 m.
    UsSurveyFoot,
    /// Degrees of longitude and latitude: no length.
    Degree,
}

/// What only a file of the same format can hold.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Kept {
    /// Of LAS, LAZ and COPC.
    Las(Box<LasKept>),
    /// Of an E57 file.
    E57(E57Kept),
    /// Of a PCD file.
    Pcd(PcdKept),
}

/// One named column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The name as the file spells it.
    pub name: String,
    /// One value per row.
    pub data: Data,
}

/// The values of a column, in the type the file gives them.
#[derive(Debug, Clone, PartialEq)]
pub enum Data {
    /// Signed 8-bit integers.
    I8(Vec<i8>),
    /// Unsigned 8-bit integers.
    U8(Vec<u8>),
    /// Signed 16-bit integers.
    I16(Vec<i16>),
    /// Unsigned 16-bit integers.
    U16(Vec<u16>),
    /// Signed 32-bit integers.
    I32(Vec<i32>),
    /// Unsigned 32-bit integers.
    U32(Vec<u32>),
    /// Signed 64-bit integers.
    I64(Vec<i64>),
    /// Unsigned 64-bit integers.
    U64(Vec<u64>),
    /// 32-bit floating point.
    F32(Vec<f32>),
    /// 64-bit floating point; every numeric column of a text file.
    F64(Vec<f64>),
    /// A column of a text file that holds no numbers.
    Text(Vec<String>),
}

impl Table {
    /// The number of rows, 0 without columns.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.data.len())
    }

    /// The column of exactly this name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Puts `column` in the place of the column of the same name, or behind the last one.
    ///
    /// Its length must be [`rows`](Self::rows) if the table has other columns; [`write`](crate::write)
    /// refuses a table of unequal columns.
    pub fn set(&mut self, column: Column) {
        match self.columns.iter_mut().find(|old| old.name == column.name) {
            Some(old) => *old = column,
            None => self.columns.push(column),
        }
    }
}

impl Column {
    /// A column of this name and these values.
    pub fn new(name: impl Into<String>, data: Data) -> Self {
        Self { name: name.into(), data }
    }
}

impl Data {
    /// The number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::I8(v) => v.len(),
            Self::U8(v) => v.len(),
            Self::I16(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::U32(v) => v.len(),
            Self::I64(v) => v.len(),
            Self::U64(v) => v.len(),
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::Text(v) => v.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Gives back the room behind the last value.
    pub(crate) fn shrink(&mut self) {
        match self {
            Self::I8(v) => v.shrink_to_fit(),
            Self::U8(v) => v.shrink_to_fit(),
            Self::I16(v) => v.shrink_to_fit(),
            Self::U16(v) => v.shrink_to_fit(),
            Self::I32(v) => v.shrink_to_fit(),
            Self::U32(v) => v.shrink_to_fit(),
            Self::I64(v) => v.shrink_to_fit(),
            Self::U64(v) => v.shrink_to_fit(),
            Self::F32(v) => v.shrink_to_fit(),
            Self::F64(v) => v.shrink_to_fit(),
            Self::Text(v) => v.shrink_to_fit(),
        }
    }

    /// Leaves out the values whose flag is not set.
    pub(crate) fn keep(&mut self, flags: &[bool]) {
        fn chosen<T>(values: &mut Vec<T>, flags: &[bool]) {
            let mut flags = flags.iter();
            values.retain(|_| flags.next().copied().unwrap_or(false));
        }
        match self {
            Self::I8(v) => chosen(v, flags),
            Self::U8(v) => chosen(v, flags),
            Self::I16(v) => chosen(v, flags),
            Self::U16(v) => chosen(v, flags),
            Self::I32(v) => chosen(v, flags),
            Self::U32(v) => chosen(v, flags),
            Self::I64(v) => chosen(v, flags),
            Self::U64(v) => chosen(v, flags),
            Self::F32(v) => chosen(v, flags),
            Self::F64(v) => chosen(v, flags),
            Self::Text(v) => chosen(v, flags),
        }
    }

    /// The values as 64-bit floating point, which holds every number exactly but integers beyond 2⁵³, and those to the
    /// nearest; `None` for text.
    pub fn to_f64(&self) -> Option<Vec<f64>> {
        Some(match self {
            Self::I8(v) => v.iter().copied().map(f64::from).collect(),
            Self::U8(v) => v.iter().copied().map(f64::from).collect(),
            Self::I16(v) => v.iter().copied().map(f64::from).collect(),
            Self::U16(v) => v.iter().copied().map(f64::from).collect(),
            Self::I32(v) => v.iter().copied().map(f64::from).collect(),
            Self::U32(v) => v.iter().copied().map(f64::from).collect(),
            Self::I64(v) => v.iter().map(|&n| n as f64).collect(),
            Self::U64(v) => v.iter().map(|&n| n as f64).collect(),
            Self::F32(v) => v.iter().copied().map(f64::from).collect(),
            Self::F64(v) => v.clone(),
            Self::Text(_) => return None,
        })
    }
}
