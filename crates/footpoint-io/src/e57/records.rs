//! Attributes of E57 points and the columns they are: names and types, both ways.

use e57::{Record, RecordDataType, RecordName, RecordValue};

use crate::roles::Roles;
use crate::scalar::Scalar;
use crate::{Data, Table};

/// Names of standard attributes that are columns as they stand.
const PLAIN: [(&str, RecordName); 16] = [
    ("intensity", RecordName::Intensity),
    ("intensity_invalid", RecordName::IsIntensityInvalid),
    ("red", RecordName::ColorRed),
    ("green", RecordName::ColorGreen),
    ("blue", RecordName::ColorBlue),
    ("color_invalid", RecordName::IsColorInvalid),
    ("row_index", RecordName::RowIndex),
    ("column_index", RecordName::ColumnIndex),
    ("return_index", RecordName::ReturnIndex),
    ("return_count", RecordName::ReturnCount),
    ("time_stamp", RecordName::TimeStamp),
    ("time_stamp_invalid", RecordName::IsTimeStampInvalid),
    ("spherical_range", RecordName::SphericalRange),
    ("spherical_azimuth", RecordName::SphericalAzimuth),
    ("spherical_elevation", RecordName::SphericalElevation),
    ("spherical_invalid_state", RecordName::SphericalInvalidState),
];

/// The extension of normals: <http://www.libe57.org/E57_NOR_surface_normals.txt>.
pub(super) const NORMALS: (&str, &str) = ("nor", "http://www.libe57.org/E57_NOR_surface_normals.txt");
const NORMAL_NAMES: [(&str, &str); 3] = [("nx", "normalX"), ("ny", "normalY"), ("nz", "normalZ")];
/// Our extension: all columns that no other has.
pub(super) const OURS: (&str, &str) = ("fp", "urn:footpoint:columns");

/// A column of another extension, to be written there again.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Extended {
    pub(super) column: String,
    pub(super) namespace: String,
    pub(super) name: String,
    pub(super) url: String,
}

/// The column of an attribute that is no coordinate and no state of one.
pub(super) fn column_name(name: &RecordName) -> String {
    if let RecordName::Unknown { namespace, name } = name {
        let normal = NORMAL_NAMES.iter().find(|(_, tag)| namespace == NORMALS.0 && name == tag);
        return normal.map_or(name.as_str(), |(column, _)| column).to_owned();
    }
    PLAIN.iter().find(|(_, plain)| plain == name).map_or("invalid_state", |(column, _)| column).to_owned()
}

/// The type of the column of an attribute.
pub(super) fn scalar(kind: &RecordDataType) -> Scalar {
    match kind {
        RecordDataType::Single { .. } => Scalar::F32,
        RecordDataType::Double { .. } | RecordDataType::ScaledInteger { .. } => Scalar::F64,
        RecordDataType::Integer { min, max } => smallest(*min, *max),
    }
}

fn smallest(min: i64, max: i64) -> Scalar {
    let fits = |low: i64, high: i64| low <= min && max <= high;
    if fits(0, u8::MAX.into()) {
        Scalar::U8
    } else if fits(i8::MIN.into(), i8::MAX.into()) {
        Scalar::I8
    } else if fits(0, u16::MAX.into()) {
        Scalar::U16
    } else if fits(i16::MIN.into(), i16::MAX.into()) {
        Scalar::I16
    } else if fits(0, u32::MAX.into()) {
        Scalar::U32
    } else if fits(i32::MIN.into(), i32::MAX.into()) {
        Scalar::I32
    } else if min >= 0 {
        Scalar::U64
    } else {
        Scalar::I64
    }
}

/// The type that holds the values of two scans.
pub(super) fn common(one: Scalar, other: Scalar) -> Scalar {
    match (range(one), range(other)) {
        _ if one == other => one,
        (Some((a, b)), Some((c, d))) => smallest(a.min(c), b.max(d)),
        _ => Scalar::F64,
    }
}

/// The integers that E57 can write of a type.
fn range(scalar: Scalar) -> Option<(i64, i64)> {
    Some(match scalar {
        Scalar::I8 => (i8::MIN.into(), i8::MAX.into()),
        Scalar::U8 => (0, u8::MAX.into()),
        Scalar::I16 => (i16::MIN.into(), i16::MAX.into()),
        Scalar::U16 => (0, u16::MAX.into()),
        Scalar::I32 => (i32::MIN.into(), i32::MAX.into()),
        Scalar::U32 => (0, u32::MAX.into()),
        Scalar::I64 => (i64::MIN, i64::MAX),
        Scalar::U64 => (0, i64::MAX),
        Scalar::F32 | Scalar::F64 => return None,
    })
}

/// Bits of a value in the file; 0 if all are equal.
pub(super) fn bits(kind: &RecordDataType) -> u64 {
    match kind {
        RecordDataType::Single { .. } => 32,
        RecordDataType::Double { .. } => 64,
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => {
            64 - u64::from(max.wrapping_sub(*min).cast_unsigned().leading_zeros())
        }
    }
}

/// The number that a value means.
pub(super) fn number(value: &RecordValue, kind: &RecordDataType) -> f64 {
    match (value, kind) {
        (RecordValue::Single(value), _) => (*value).into(),
        (RecordValue::Double(value), _) => *value,
        (RecordValue::ScaledInteger(value), RecordDataType::ScaledInteger { scale, offset, .. }) => {
            *value as f64 * scale + offset
        }
        (RecordValue::Integer(value) | RecordValue::ScaledInteger(value), _) => *value as f64,
    }
}

/// Appends a value; `None` if the column cannot hold it.
pub(super) fn push(data: &mut Data, value: &RecordValue, kind: &RecordDataType) -> Option<()> {
    let whole = || match value {
        RecordValue::Integer(value) => Some(*value),
        _ => None,
    };
    match data {
        Data::I8(v) => v.push(whole()?.try_into().ok()?),
        Data::U8(v) => v.push(whole()?.try_into().ok()?),
        Data::I16(v) => v.push(whole()?.try_into().ok()?),
        Data::U16(v) => v.push(whole()?.try_into().ok()?),
        Data::I32(v) => v.push(whole()?.try_into().ok()?),
        Data::U32(v) => v.push(whole()?.try_into().ok()?),
        Data::I64(v) => v.push(whole()?),
        Data::U64(v) => v.push(whole()?.try_into().ok()?),
        Data::F32(v) => match value {
            RecordValue::Single(value) => v.push(*value),
            _ => v.push(number(value, kind) as f32),
        },
        Data::F64(v) => v.push(number(value, kind)),
        Data::Text(_) => return None,
    }
    Some(())
}

/// The value of a column in a row.
pub(super) fn value(data: &Data, row: usize) -> Option<RecordValue> {
    Some(match data {
        Data::I8(v) => RecordValue::Integer((*v.get(row)?).into()),
        Data::U8(v) => RecordValue::Integer((*v.get(row)?).into()),
        Data::I16(v) => RecordValue::Integer((*v.get(row)?).into()),
        Data::U16(v) => RecordValue::Integer((*v.get(row)?).into()),
        Data::I32(v) => RecordValue::Integer((*v.get(row)?).into()),
        Data::U32(v) => RecordValue::Integer((*v.get(row)?).into()),
        Data::I64(v) => RecordValue::Integer(*v.get(row)?),
        Data::U64(v) => RecordValue::Integer((*v.get(row)?).try_into().ok()?),
        Data::F32(v) => RecordValue::Single(*v.get(row)?),
        Data::F64(v) => RecordValue::Double(*v.get(row)?),
        Data::Text(_) => return None,
    })
}

/// The type to write a column in, which reads back as the column's type; `None` for text and for integers that the
/// crate cannot write: it takes the difference to the least one in 64 bits.
pub(super) fn data_type(data: &Data) -> Option<RecordDataType> {
    const HALF: i64 = 1 << 62;
    let (min, max) = match data {
        Data::F32(_) => return Some(RecordDataType::F32),
        Data::F64(_) => return Some(RecordDataType::F64),
        Data::U64(values) => {
            i64::try_from(values.iter().copied().max().unwrap_or(0)).ok()?;
            (0, i64::MAX)
        }
        Data::I64(values) => {
            let low = values.iter().copied().min().unwrap_or(0);
            let high = values.iter().copied().max().unwrap_or(0);
            let min = if low < -HALF { low } else { -HALF.min(i64::MAX - high.max(0)).max(1) };
            let max = min.checked_add(i64::MAX)?;
            (min <= low && high <= max).then_some((min, max))?
        }
        other => range(Scalar::of(other)?)?,
    };
    Some(RecordDataType::Integer { min, max })
}

/// The attribute of a column that is no coordinate: a standard one, as far as the standard allows it with the columns
/// there are, or one of an extension.
pub(super) fn record_name(table: &Table, column: &str, extensions: &[Extended]) -> RecordName {
    let has = |names: &[&str]| {
        names.iter().all(|name| table.column(name).is_some_and(|c| Scalar::of(&c.data).is_some()))
    };
    let is_whole =
        |name: &str| table.column(name).and_then(|c| Scalar::of(&c.data)).is_some_and(Scalar::is_integer);
    let is_state = |most: u8| match table.column(column).map(|column| &column.data) {
        Some(Data::U8(values)) => values.iter().all(|&value| value <= most),
        _ => false,
    };
    let plain = match column {
        "intensity" | "time_stamp" => true,
        "intensity_invalid" => is_state(1) && has(&["intensity"]),
        "red" | "green" | "blue" => has(&["red", "green", "blue"]),
        "color_invalid" => is_state(1) && has(&["red", "green", "blue"]),
        "row_index" | "column_index" => is_whole(column),
        "return_index" | "return_count" => is_whole("return_index") && is_whole("return_count"),
        "time_stamp_invalid" => is_state(1) && has(&["time_stamp"]),
        "invalid_state" if is_state(2) => return RecordName::CartesianInvalidState,
        _ => false,
    };
    if let Some((_, name)) = PLAIN.iter().find(|(name, _)| plain && *name == column) {
        return name.clone();
    }
    let of = |namespace: &str, name: &str| RecordName::Unknown {
        namespace: namespace.to_owned(),
        name: name.to_owned(),
    };
    let normal = NORMAL_NAMES.iter().find(|(name, _)| *name == column && has(&["nx", "ny", "nz"]));
    if let Some((_, tag)) = normal {
        return of(NORMALS.0, tag);
    }
    match extensions.iter().find(|extended| extended.column == column) {
        Some(extended) => of(&extended.namespace, &extended.name),
        None => of(OURS.0, column),
    }
}

/// Whether a column's name can be the name of an attribute of an extension: of XML, and not one of the standard, which
/// the crate takes for those whatever their namespace.
pub(super) fn is_name(name: &str) -> bool {
    const STANDARD: [&str; 5] = ["cartesian", "spherical", "color", "is", "return"];
    let camel = |rest: &str| rest.starts_with(|c: char| c.is_ascii_uppercase());
    let is_standard = STANDARD.iter().any(|start| name.strip_prefix(start).is_some_and(camel))
        || matches!(name, "rowIndex" | "columnIndex" | "timeStamp");
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
        && !name.get(..3).is_some_and(|start| start.eq_ignore_ascii_case("xml"))
        && !is_standard
}

/// The state attribute of coordinates that are not all finite.
pub(super) fn state_record() -> Record {
    Record { name: RecordName::CartesianInvalidState, data_type: RecordDataType::Integer { min: 0, max: 2 } }
}

/// The coordinate columns of a table, if it has points in space.
pub(super) fn coordinates(table: &Table) -> Option<[usize; 3]> {
    Roles::find(table).ok()?.coordinates.try_into().ok()
}
