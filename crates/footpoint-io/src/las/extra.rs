//! Extra bytes: values behind those of the point format, described by a record of 192 bytes each
//! (LAS 1.4 R15, table 24).

use std::collections::HashSet;

use super::fields::{Field, Kind, unique};
use super::record::{padded, part, text};
use crate::scalar::Scalar;

/// The bytes of one description.
pub(super) const DESCRIPTION: usize = 192;
/// The types by their numbers, from 1; 11 to 20 and 21 to 30 are two and three of them.
const TYPES: [Scalar; 10] = [
    Scalar::U8,
    Scalar::I8,
    Scalar::U16,
    Scalar::I16,
    Scalar::U32,
    Scalar::I32,
    Scalar::U64,
    Scalar::I64,
    Scalar::F32,
    Scalar::F64,
];
const HAS_SCALE: u8 = 8;
const HAS_OFFSET: u8 = 16;

/// The columns of one description.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Extra {
    /// The description as it stands in the file; `None` for bytes that none describes.
    pub(super) description: Option<Vec<u8>>,
    /// The values, from the first byte of this description's own on.
    pub(super) fields: Vec<Field>,
}

impl Extra {
    /// A description of a new column.
    pub(super) fn new(name: &str, scalar: Scalar) -> Self {
        let mut description = vec![0; 2];
        let number = TYPES.iter().position(|&t| t == scalar).map_or(0, |index| index as u8 + 1);
        description.extend([number, 0]);
        description.extend(padded::<32>(name));
        description.resize(160, 0);
        description.extend(padded::<32>("column of a footpoint table"));
        let field = Field { name: name.to_owned(), at: 0, kind: Kind::Number(scalar) };
        Self { description: Some(description), fields: vec![field] }
    }

    /// The bytes in a point record.
    pub(super) fn size(&self) -> usize {
        super::fields::size(&self.fields)
    }

    /// What a record of descriptions says of the `room` bytes behind the fields of the point format.
    ///
    /// Bytes left over, and those of no known type, become columns of their own, one per byte.
    pub(super) fn read(record: &[u8], room: usize, standard: &[Field], notes: &mut Vec<String>) -> Vec<Self> {
        let mut names: HashSet<String> = standard.iter().map(|field| field.name.clone()).collect();
        let mut extras = Vec::new();
        let mut left = room;
        for description in record.chunks_exact(DESCRIPTION) {
            let extra = Self::of(description, &mut names);
            if extra.size() > left {
                notes.push(format!(
                    "the extra bytes described are more than the {room} there are; the last are kept as bytes"
                ));
                break;
            }
            left -= extra.size();
            extras.push(extra);
        }
        if left > 0 {
            let mut extra = Self { description: None, fields: Vec::new() };
            // The name that laspy gives them.
            let name = |at| if left == 1 { "ExtraBytes".to_owned() } else { format!("ExtraBytes_{at}") };
            (0..left).for_each(|at| extra.put(at, &name(at), BYTE, &mut names));
            extras.push(extra);
        }
        extras
    }

    fn of(description: &[u8], names: &mut HashSet<String>) -> Self {
        let mut extra = Self { description: Some(description.to_vec()), fields: Vec::new() };
        let [number, options] = part(description, 2);
        let name = text(&part::<32>(description, 4));
        let name = if name.is_empty() { "extra".to_owned() } else { name };
        let scalar = TYPES.get(usize::from(number).wrapping_sub(1) % 10).copied();
        let (Some(scalar), 1..=30) = (scalar, number) else {
            // Of type 0, the options are the number of bytes; other numbers are not defined.
            let bytes = if number == 0 { options.into() } else { 0 };
            (0..bytes).for_each(|at| extra.put(at, &format!("{name}_{at}"), BYTE, names));
            return extra;
        };
        let count = (usize::from(number) - 1) / 10 + 1;
        for index in 0..count {
            let number = |at: usize| f64::from_le_bytes(part(description, at + 8 * index));
            let scale = if options & HAS_SCALE == 0 { 1.0 } else { number(112) };
            let offset = if options & HAS_OFFSET == 0 { 0.0 } else { number(136) };
            let is_plain =
                options & (HAS_SCALE | HAS_OFFSET) == 0 || !scale.is_normal() || !offset.is_finite();
            let kind = match is_plain {
                true => Kind::Number(scalar),
                false => Kind::Scaled { raw: scalar, scale, offset },
            };
            let name = if count == 1 { name.clone() } else { format!("{name}_{index}") };
            extra.put(index * kind.size(), &name, kind, names);
        }
        extra
    }

    fn put(&mut self, at: usize, name: &str, kind: Kind, names: &mut HashSet<String>) {
        let name = unique(name, &|name| names.contains(name));
        names.insert(name.clone());
        self.fields.push(Field { name, at, kind });
    }
}

const BYTE: Kind = Kind::Number(Scalar::U8);
