//! The head of a LAS file: the header and the records beside the points, as far as the file's bytes go.

use std::io::{Read, Seek, SeekFrom};

use las::raw;

use super::LasError;
use super::fields;
use super::record::{COPC, Place, Record, SPEC};

/// The header of every version is at least this long.
const LEAST_HEADER: u64 = 227;

/// What stands before and behind the points.
pub(super) struct Head {
    pub(super) header: raw::Header,
    pub(super) vlrs: Vec<Record>,
    pub(super) evlrs: Vec<Record>,
    /// The points that the header states.
    pub(super) points: u64,
    pub(super) format: u8,
    pub(super) is_packed: bool,
    pub(super) size: u64,
}

impl Head {
    pub(super) fn read(
        file: &mut (impl Read + Seek),
        size: u64,
        notes: &mut Vec<String>,
    ) -> Result<Self, LasError> {
        let mut start = Vec::new();
        file.by_ref().take(u64::from(u16::MAX)).read_to_end(&mut start)?;
        if !start.starts_with(&raw::LASF) {
            let is_gzip = start.starts_with(&[0x1f, 0x8b]);
            return Err(if is_gzip { LasError::NotSeekable } else { LasError::Signature });
        }
        let short = |wanted: u64| LasError::Header { wanted, found: size };
        if size < LEAST_HEADER {
            return Err(short(LEAST_HEADER));
        }
        let header = raw::Header::read_from(start.as_slice()).map_err(|_| short(375));
        let (major, minor) = (start.get(24).copied().unwrap_or(0), start.get(25).copied().unwrap_or(0));
        if major != 1 || minor > 4 {
            return Err(LasError::Version { major, minor });
        }
        let header = header?;
        if header.header_size < header.version.header_size() {
            return Err(short(header.version.header_size().into()));
        }
        // LASzip marks packed points by the highest bits of the format.
        let (format, marks) =
            (header.point_data_record_format & 0x3f, header.point_data_record_format & 0xc0);
        let own = fields::standard(format, &header).ok_or(LasError::PointFormat(format))?;
        let least = fields::size(&own);
        if usize::from(header.point_data_record_length) < least {
            return Err(LasError::RecordLength { format, found: header.point_data_record_length, least });
        }
        // Where the two counts of LAS 1.4 differ, the old one is to be taken (LAS 1.4 R15, section 2.4).
        let wide = header.large_file.map_or(0, |large| large.number_of_point_records);
        let old = u64::from(header.number_of_point_records);
        if old > 0 && wide > 0 && old != wide {
            notes.push(format!("the header counts {old} points and, in the field of LAS 1.4, {wide}"));
        }
        let points = if old > 0 { old } else { wide };
        if points > 0 {
            check_scales(&header)?;
        }
        let mut head =
            Self { header, vlrs: Vec::new(), evlrs: Vec::new(), points, format, is_packed: marks != 0, size };
        head.read_records(file, notes)?;
        file.seek(SeekFrom::Start(head.start()))?;
        Ok(head)
    }

    /// Where the points start.
    pub(super) fn start(&self) -> u64 {
        self.header.offset_to_point_data.into()
    }

    /// The bytes of an unpacked point.
    pub(super) fn record_size(&self) -> usize {
        self.header.point_data_record_length.into()
    }

    pub(super) fn is_copc(&self) -> bool {
        self.is_packed && self.vlrs.iter().any(|record| record.is(COPC, 1))
    }

    fn read_records(
        &mut self,
        file: &mut (impl Read + Seek),
        notes: &mut Vec<String>,
    ) -> Result<(), LasError> {
        let end = self.start().min(self.size);
        let count = u64::from(self.header.number_of_variable_length_records);
        let place = Place { start: self.header.header_size.into(), end, count, extended: false };
        self.vlrs = Record::read_all(file, &place)?;
        tell_missing(notes, "variable length records", count, self.vlrs.len());
        // LAS 1.3 has one extended record at most, the waveforms, and its own field for where it starts.
        let waveforms = self.header.start_of_waveform_data_packet_record.unwrap_or(0);
        let (start, count) = match self.header.evlr {
            Some(evlr) => (evlr.start_of_first_evlr, u64::from(evlr.number_of_evlrs)),
            None if self.header.version.minor == 3 && waveforms > 0 => (waveforms, 1),
            None => return Ok(()),
        };
        self.evlrs = Record::read_all(file, &Place { start, end: self.size, count, extended: true })?;
        tell_missing(notes, "extended records behind the points", count, self.evlrs.len());
        Ok(())
    }

    /// All records, those behind the points last.
    pub(super) fn records(&self) -> impl Iterator<Item = &Record> {
        self.vlrs.iter().chain(&self.evlrs)
    }

    /// The descriptions of the extra bytes, one behind the other.
    pub(super) fn extra_bytes(&self) -> &[u8] {
        self.records().find(|record| record.is(SPEC, 4)).map_or(&[], |record| &record.data)
    }
}

fn tell_missing(notes: &mut Vec<String>, what: &str, wanted: u64, found: usize) {
    if (found as u64) < wanted {
        notes.push(format!("the header counts {wanted} {what}, {found} are whole"));
    }
}

fn check_scales(header: &raw::Header) -> Result<(), LasError> {
    let axes = [
        ("x", header.x_scale_factor, header.x_offset),
        ("y", header.y_scale_factor, header.y_offset),
        ("z", header.z_scale_factor, header.z_offset),
    ];
    match axes.into_iter().find(|(_, scale, offset)| !scale.is_normal() || !offset.is_finite()) {
        Some((axis, scale, offset)) => Err(LasError::Scale { axis, scale, offset }),
        None => Ok(()),
    }
}
