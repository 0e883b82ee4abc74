//! Colours of PCD files: blue, green, red and alpha as the four bytes of one number, lowest first.

use crate::scalar::Scalar;
use crate::{Column, Data};

/// The columns of a packed colour.
pub(super) const NAMES: [&str; 4] = ["red", "green", "blue", "alpha"];
const SHIFTS: [u32; 4] = [16, 8, 0, 24];

/// How a file packed its colours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Packed {
    pub(super) is_rgba: bool,
    pub(super) scalar: Scalar,
}

impl Packed {
    pub(super) fn of(name: &str, data: &Data) -> Self {
        Self { is_rgba: name == "rgba", scalar: Scalar::of(data).unwrap_or(Scalar::U32) }
    }
}

/// The columns of a packed colour; of `rgb`, `alpha` only if it is used.
pub(super) fn unpack(name: &str, data: &Data) -> Vec<Column> {
    let packed: Vec<u32> = match data {
        Data::F32(values) => values.iter().map(|value| value.to_bits()).collect(),
        Data::I32(values) => values.iter().map(|value| value.cast_unsigned()).collect(),
        Data::U32(values) => values.clone(),
        _ => Vec::new(),
    };
    let has_alpha = name == "rgba" || packed.iter().any(|value| value >> 24 != 0);
    let channel = |shift: u32| Data::U8(packed.iter().map(|value| (value >> shift) as u8).collect());
    let channels = NAMES.iter().zip(SHIFTS).take(if has_alpha { 4 } else { 3 });
    channels.map(|(name, shift)| Column::new(*name, channel(shift))).collect()
}

/// The packed colours of a table's columns `red green blue` (`alpha`).
pub(super) fn pack(channels: &[Column]) -> Vec<u32> {
    let mut packed = vec![0; channels.first().map_or(0, |column| column.data.len())];
    for (column, shift) in channels.iter().zip(SHIFTS) {
        let Data::U8(values) = &column.data else { continue };
        for (packed, value) in packed.iter_mut().zip(values) {
            *packed |= u32::from(*value) << shift;
        }
    }
    packed
}

/// How many of the first columns are the channels of one colour: 3, 4 with `alpha`, or 0.
pub(super) fn channels(columns: &[Column]) -> usize {
    let fits = |(column, name): (&Column, &&str)| column.name == **name && matches!(column.data, Data::U8(_));
    match columns.iter().zip(&NAMES).take_while(|pair| fits(*pair)).count() {
        found @ 3..=4 => found,
        _ => 0,
    }
}
