//! Point records into columns, block by block.

use std::ops::ControlFlow;

use super::LasError;
use super::fields::{Field, Kind};
use super::record::part;
use crate::scalar::Scalar;
use crate::{Bounds, Column, Data, ReadOptions, Watch};

/// Points unpacked at a time; their bytes should stay in the processor's cache.
pub(super) const BLOCK: usize = 4096;
/// Points from one word to the watch to the next.
const TOLD: u64 = 1 << 16;

/// Takes records and keeps their values as columns.
pub(super) struct Points<'w> {
    fields: Vec<Field>,
    columns: Vec<Data>,
    /// The bytes of a record.
    record: usize,
    within: Option<Bounds>,
    watch: Option<&'w dyn Watch>,
    done: u64,
    /// The points that will be looked at.
    all: u64,
    until_told: u64,
}

impl<'w> Points<'w> {
    /// For `all` points, with room for no more of them than `room`.
    pub(super) fn new(
        fields: Vec<Field>,
        record: usize,
        (all, room): (u64, u64),
        options: &ReadOptions<'w>,
    ) -> Self {
        // How many points a box holds is known when they have been seen.
        let room = if options.within.is_some() { 0 } else { usize::try_from(all.min(room)).unwrap_or(0) };
        let columns = fields.iter().map(|field| field.kind.column().column(room)).collect();
        let (within, watch) = (options.within, options.watch);
        Self { fields, columns, record, within, watch, done: 0, all, until_told: TOLD }
    }

    /// Takes a block of records; changes its bytes.
    pub(super) fn take(&mut self, block: &mut [u8]) -> Result<(), LasError> {
        let points = (block.len() / self.record.max(1)) as u64;
        let inside = match self.within {
            Some(bounds) => self.keep_within(block, &bounds),
            None => block.len(),
        };
        let block = block.get(..inside).unwrap_or_default();
        for (field, column) in self.fields.iter().zip(&mut self.columns) {
            append(column, field, block, self.record);
        }
        self.done += points;
        if points < self.until_told {
            self.until_told -= points;
            return Ok(());
        }
        self.until_told = TOLD;
        self.tell()
    }

    /// All columns, in the order of the fields.
    pub(super) fn finish(mut self) -> Result<Vec<Column>, LasError> {
        if self.until_told < TOLD {
            self.tell()?;
        }
        if self.within.is_some() {
            self.columns.iter_mut().for_each(Data::shrink);
        }
        let names = self.fields.into_iter().map(|field| field.name);
        Ok(names.zip(self.columns).map(|(name, data)| Column::new(name, data)).collect())
    }

    fn tell(&mut self) -> Result<(), LasError> {
        match self.watch.map(|watch| watch.at(self.done, self.all)) {
            Some(ControlFlow::Break(())) => Err(LasError::Stopped),
            _ => Ok(()),
        }
    }

    /// Moves the records of the points inside to the front; returns their bytes.
    fn keep_within(&self, block: &mut [u8], bounds: &Bounds) -> usize {
        let mut axes = [(0.0, 0.0); 3];
        for (axis, field) in axes.iter_mut().zip(&self.fields) {
            if let Kind::Scaled { scale, offset, .. } = field.kind {
                *axis = (scale, offset);
            }
        }
        let mut kept = 0;
        for start in (0..block.len()).step_by(self.record.max(1)) {
            let record = block.get(start..start + self.record).unwrap_or_default();
            let [x, y, z] = [0, 4, 8].map(|at| f64::from(i32::from_le_bytes(part(record, at))));
            let [(sx, ox), (sy, oy), (sz, oz)] = axes;
            if bounds.contains([x * sx + ox, y * sy + oy, z * sz + oz]) {
                block.copy_within(start..start + self.record, kept);
                kept += self.record;
            }
        }
        kept
    }
}

/// Appends one field of a block of records to its column.
fn append(column: &mut Data, field: &Field, block: &[u8], stride: usize) {
    let rows = Rows { block, stride, at: field.at };
    match (field.kind, column) {
        (Kind::Bits { shift, width }, Data::U8(v)) => {
            let mask = ((1_u16 << width) - 1) as u8;
            rows.decode(v, |[byte]: [u8; 1]| (byte >> shift) & mask);
        }
        (Kind::Scaled { raw, scale, offset }, Data::F64(v)) => {
            let place = |number: f64| number * scale + offset;
            match raw {
                Scalar::I8 => rows.decode(v, |b| place(i8::from_le_bytes(b).into())),
                Scalar::U8 => rows.decode(v, |b| place(u8::from_le_bytes(b).into())),
                Scalar::I16 => rows.decode(v, |b| place(i16::from_le_bytes(b).into())),
                Scalar::U16 => rows.decode(v, |b| place(u16::from_le_bytes(b).into())),
                Scalar::I32 => rows.decode(v, |b| place(i32::from_le_bytes(b).into())),
                Scalar::U32 => rows.decode(v, |b| place(u32::from_le_bytes(b).into())),
                Scalar::I64 => rows.decode(v, |b| place(i64::from_le_bytes(b) as f64)),
                Scalar::U64 => rows.decode(v, |b| place(u64::from_le_bytes(b) as f64)),
                Scalar::F32 => rows.decode(v, |b| place(f32::from_le_bytes(b).into())),
                Scalar::F64 => rows.decode(v, |b| place(f64::from_le_bytes(b))),
            }
        }
        (_, Data::I8(v)) => rows.decode(v, i8::from_le_bytes),
        (_, Data::U8(v)) => rows.decode(v, u8::from_le_bytes),
        (_, Data::I16(v)) => rows.decode(v, i16::from_le_bytes),
        (_, Data::U16(v)) => rows.decode(v, u16::from_le_bytes),
        (_, Data::I32(v)) => rows.decode(v, i32::from_le_bytes),
        (_, Data::U32(v)) => rows.decode(v, u32::from_le_bytes),
        (_, Data::I64(v)) => rows.decode(v, i64::from_le_bytes),
        (_, Data::U64(v)) => rows.decode(v, u64::from_le_bytes),
        (_, Data::F32(v)) => rows.decode(v, f32::from_le_bytes),
        (_, Data::F64(v)) => rows.decode(v, f64::from_le_bytes),
        (_, Data::Text(_)) => {}
    }
}

/// One field of all records of a block.
struct Rows<'b> {
    block: &'b [u8],
    stride: usize,
    at: usize,
}

impl Rows<'_> {
    fn decode<T, const N: usize>(&self, out: &mut Vec<T>, number: impl Fn([u8; N]) -> T) {
        let field = |row: &[u8]| row.get(self.at..).and_then(|rest| rest.first_chunk::<N>().copied());
        out.extend(self.block.chunks_exact(self.stride).filter_map(field).map(number));
    }
}
