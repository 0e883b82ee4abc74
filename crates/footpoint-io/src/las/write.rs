//! Writing LAS and LAZ: header, records, points block by block, records behind them, and the header again.

use std::io::{self, Seek, SeekFrom, Write};

use las::raw;
use laz::{LasZipCompressor, LazVlr, LazVlrBuilder};

use super::fit::put;
use super::layout::Layout;
use super::points::BLOCK;
use super::record::{Record, SPEC, part};
use super::unpack::LASZIP;
use crate::Table;
use crate::output::Steps;

/// The mark of LASzip in the number of the point format.
const IS_PACKED: u8 = 0x80;
/// The record of waveforms.
const WAVEFORMS: u16 = 65535;

/// Writes a table that [`super::check`] lets pass.
pub(crate) fn write(
    out: &mut (impl Write + Seek + Send + Sync),
    table: &Table,
    is_packed: bool,
    steps: &Steps<'_>,
) -> io::Result<()> {
    let mut layout = Layout::of(table).map_err(io::Error::other)?;
    let packing = is_packed.then(|| pack_record(&mut layout)).transpose()?;
    let records: u64 = layout.vlrs.iter().map(|record| record.size(false)).sum();
    let signature: &[u8] =
        if layout.header.version.minor == 0 { &raw::POINT_DATA_START_SIGNATURE } else { &[] };
    let start = u64::from(layout.header.header_size) + records + signature.len() as u64;
    layout.header.offset_to_point_data = u32::try_from(start).map_err(io::Error::other)?;
    layout.header.number_of_variable_length_records = layout.vlrs.len() as u32;
    write_header(&layout.header, out)?;
    layout.vlrs.iter().try_for_each(|record| record.write(out, false))?;
    out.write_all(signature)?;
    let mut counts = Counts::new(&layout);
    match packing {
        None => each_block((table.rows(), steps), &layout, &mut counts, |block| out.write_all(block))?,
        Some(packing) => {
            let mut packed = LasZipCompressor::new(&mut *out, packing).map_err(io::Error::other)?;
            each_block((table.rows(), steps), &layout, &mut counts, |block| packed.compress_many(block))?;
            packed.done()?;
        }
    }
    write_evlrs(&mut layout, out)?;
    counts.put(&mut layout.header, table.rows() as u64);
    out.seek(SeekFrom::Start(0))?;
    write_header(&layout.header, out)?;
    out.flush()
}

/// Adds the record of the packing and marks the point format.
fn pack_record(layout: &mut Layout<'_>) -> io::Result<LazVlr> {
    let extra = u16::try_from(layout.extra).map_err(io::Error::other)?;
    let packing = LazVlrBuilder::default().with_point_format(layout.format, extra);
    let packing = packing.map_err(io::Error::other)?.build();
    let mut data = Vec::new();
    packing.write_to(&mut data)?;
    layout.vlrs.push(Record::new(LASZIP.0, LASZIP.1, LazVlr::DESCRIPTION, data));
    layout.header.point_data_record_format |= IS_PACKED;
    Ok(packing)
}

fn write_header(header: &raw::Header, out: &mut impl Write) -> io::Result<()> {
    header.write_to(out).map_err(|error| match error {
        las::Error::Io(error) => error,
        error => io::Error::other(error),
    })
}

fn each_block(
    (rows, steps): (usize, &Steps<'_>),
    layout: &Layout<'_>,
    counts: &mut Counts,
    mut take: impl FnMut(&[u8]) -> io::Result<()>,
) -> io::Result<()> {
    let mut block = Vec::new();
    for first in (0..rows).step_by(BLOCK) {
        block.clear();
        block.resize(BLOCK.min(rows - first) * layout.record, 0);
        for (field, data) in &layout.fields {
            put(data, first, field, &mut block, layout.record);
        }
        counts.add(&block, layout.record);
        take(&block)?;
        steps.at(first + BLOCK)?;
    }
    Ok(())
}

fn write_evlrs(layout: &mut Layout<'_>, out: &mut (impl Write + Seek)) -> io::Result<()> {
    if layout.evlrs.is_empty() {
        return Ok(());
    }
    let start_of_first_evlr = out.stream_position()?;
    let mut at = start_of_first_evlr;
    for record in &layout.evlrs {
        // LAS 1.3 has no other extended record, and knows it by this field alone.
        if record.is(SPEC, WAVEFORMS) || layout.header.version.minor == 3 {
            layout.header.start_of_waveform_data_packet_record = Some(at);
        }
        at += record.size(true);
        record.write(out, true)?;
    }
    let number_of_evlrs = layout.evlrs.len() as u32;
    layout.header.evlr = Some(raw::header::Evlr { start_of_first_evlr, number_of_evlrs });
    Ok(())
}

/// What the header says of the points: bounds and returns.
struct Counts {
    /// The bits of the return number in its byte.
    returns: u8,
    by_return: [u64; 15],
    low: [i32; 3],
    high: [i32; 3],
}

impl Counts {
    fn new(layout: &Layout<'_>) -> Self {
        let returns = if layout.format < 6 { 7 } else { 15 };
        Self { returns, by_return: [0; 15], low: [i32::MAX; 3], high: [i32::MIN; 3] }
    }

    fn add(&mut self, block: &[u8], stride: usize) {
        for record in block.chunks_exact(stride) {
            let integers = [0, 4, 8].map(|at| i32::from_le_bytes(part(record, at)));
            for ((low, high), integer) in self.low.iter_mut().zip(&mut self.high).zip(integers) {
                *low = integer.min(*low);
                *high = integer.max(*high);
            }
            let [byte] = part::<1>(record, 14);
            let number = usize::from(byte & self.returns).wrapping_sub(1);
            if let Some(count) = self.by_return.get_mut(number) {
                *count += 1;
            }
        }
    }

    fn put(&self, header: &mut raw::Header, points: u64) {
        let scales = [header.x_scale_factor, header.y_scale_factor, header.z_scale_factor];
        let offsets = [header.x_offset, header.y_offset, header.z_offset];
        let corner = |integers: [i32; 3]| match points {
            0 => [0.0; 3],
            _ => std::array::from_fn(|k| f64::from(integers[k]) * scales[k] + offsets[k]),
        };
        [header.min_x, header.min_y, header.min_z] = corner(self.low);
        [header.max_x, header.max_y, header.max_z] = corner(self.high);
        // The old counts stay empty where the format or the number is beyond them (LAS 1.4 R15, section 2.4).
        let is_old = header.point_data_record_format & !IS_PACKED < 6 && u32::try_from(points).is_ok();
        header.number_of_point_records = if is_old { points as u32 } else { 0 };
        header.number_of_points_by_return = [0; 5];
        if is_old {
            let old = header.number_of_points_by_return.iter_mut();
            old.zip(self.by_return).for_each(|(old, count)| *old = count as u32);
        }
        if let Some(large) = &mut header.large_file {
            large.number_of_point_records = points;
            large.number_of_points_by_return = self.by_return;
        }
    }
}
