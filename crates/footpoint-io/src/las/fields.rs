//! The fields of point records: one list per point format says where each value is, for reading and for writing.

use las::raw;

use crate::scalar::Scalar;

/// One value of a point record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    /// The name of its column.
    pub(super) name: String,
    /// The first byte within the record.
    pub(super) at: usize,
    pub(super) kind: Kind,
}

/// How a value is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// As a number of its own.
    Number(Scalar),
    /// As some bits of a byte.
    Bits { shift: u8, width: u8 },
    /// As a number that stands for `number · scale + offset`.
    Scaled { raw: Scalar, scale: f64, offset: f64 },
}

impl Kind {
    /// The type of the column.
    pub(super) fn column(self) -> Scalar {
        match self {
            Self::Number(scalar) => scalar,
            Self::Bits { .. } => Scalar::U8,
            Self::Scaled { .. } => Scalar::F64,
        }
    }

    /// The bytes in the record; bits of one byte share it.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Number(scalar) | Self::Scaled { raw: scalar, .. } => scalar.size() as usize,
            Self::Bits { .. } => 1,
        }
    }
}

/// The bytes that fields reach over.
pub(super) fn size(fields: &[Field]) -> usize {
    fields.iter().map(|field| field.at + field.kind.size()).max().unwrap_or(0)
}

/// Whether a point format has colours.
pub(super) fn has_colour(format: u8) -> bool {
    matches!(format, 2 | 3 | 5 | 7 | 8 | 10)
}

/// The fields of a point format (LAS 1.4 R15, tables 7 to 17), named as laspy does; `None` if there is no such format.
pub(super) fn standard(format: u8, header: &raw::Header) -> Option<Vec<Field>> {
    if format > 10 {
        return None;
    }
    let mut list = List::default();
    list.scaled("x", header.x_scale_factor, header.x_offset);
    list.scaled("y", header.y_scale_factor, header.y_offset);
    list.scaled("z", header.z_scale_factor, header.z_offset);
    list.number("intensity", Scalar::U16);
    if format < 6 {
        list.bits(&[
            ("return_number", 3),
            ("number_of_returns", 3),
            ("scan_direction_flag", 1),
            ("edge_of_flight_line", 1),
        ]);
        list.bits(&[("classification", 5), ("synthetic", 1), ("key_point", 1), ("withheld", 1)]);
        list.number("scan_angle_rank", Scalar::I8);
        list.number("user_data", Scalar::U8);
    } else {
        list.bits(&[("return_number", 4), ("number_of_returns", 4)]);
        list.bits(&[
            ("synthetic", 1),
            ("key_point", 1),
            ("withheld", 1),
            ("overlap", 1),
            ("scanner_channel", 2),
            ("scan_direction_flag", 1),
            ("edge_of_flight_line", 1),
        ]);
        list.number("classification", Scalar::U8);
        list.number("user_data", Scalar::U8);
        list.number("scan_angle", Scalar::I16);
    }
    list.number("point_source_id", Scalar::U16);
    if !matches!(format, 0 | 2) {
        list.number("gps_time", Scalar::F64);
    }
    if has_colour(format) {
        ["red", "green", "blue"].iter().for_each(|name| list.number(name, Scalar::U16));
    }
    if matches!(format, 8 | 10) {
        list.number("nir", Scalar::U16);
    }
    if matches!(format, 4 | 5 | 9 | 10) {
        list.number("wavepacket_index", Scalar::U8);
        list.number("wavepacket_offset", Scalar::U64);
        list.number("wavepacket_size", Scalar::U32);
        let places = ["return_point_wave_location", "x_t", "y_t", "z_t"];
        places.iter().for_each(|name| list.number(name, Scalar::F32));
    }
    Some(list.fields)
}

/// Fields put one behind the other.
#[derive(Default)]
struct List {
    fields: Vec<Field>,
    at: usize,
}

impl List {
    fn put(&mut self, name: &str, kind: Kind) {
        self.fields.push(Field { name: name.to_owned(), at: self.at, kind });
    }

    fn number(&mut self, name: &str, scalar: Scalar) {
        self.put(name, Kind::Number(scalar));
        self.at += scalar.size() as usize;
    }

    fn scaled(&mut self, name: &str, scale: f64, offset: f64) {
        self.put(name, Kind::Scaled { raw: Scalar::I32, scale, offset });
        self.at += 4;
    }

    /// One byte, its lowest bits first.
    fn bits(&mut self, parts: &[(&str, u8)]) {
        let mut shift = 0;
        for &(name, width) in parts {
            self.put(name, Kind::Bits { shift, width });
            shift += width;
        }
        self.at += 1;
    }
}

/// A name that is not `taken` yet: `name`, or `name_1`, `name_2` and so on.
pub(super) fn unique(name: &str, taken: &dyn Fn(&str) -> bool) -> String {
    if !taken(name) {
        return name.to_owned();
    }
    let numbered = (1_u64..).map(|number| format!("{name}_{number}"));
    numbered.into_iter().find(|name| !taken(name)).unwrap_or_default()
}
