//! Tables of named columns: what a point file holds, whatever its format.

/// The points of one file: named columns of equal length, one row per point, in the file's order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The columns, in the file's order; all have the same length.
    pub columns: Vec<Column>,
    /// Comment lines without their mark; a PLY `obj_info` line keeps that word in front, so that it is
    /// written as `obj_info` again.
    pub comments: Vec<String>,
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
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::Text(v) => v.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values as 64-bit floating point, which holds each number type exactly; `None` for text.
    pub fn to_f64(&self) -> Option<Vec<f64>> {
        Some(match self {
            Self::I8(v) => v.iter().copied().map(f64::from).collect(),
            Self::U8(v) => v.iter().copied().map(f64::from).collect(),
            Self::I16(v) => v.iter().copied().map(f64::from).collect(),
            Self::U16(v) => v.iter().copied().map(f64::from).collect(),
            Self::I32(v) => v.iter().copied().map(f64::from).collect(),
            Self::U32(v) => v.iter().copied().map(f64::from).collect(),
            Self::F32(v) => v.iter().copied().map(f64::from).collect(),
            Self::F64(v) => v.clone(),
            Self::Text(_) => return None,
        })
    }
}
