//! Where each column of a table goes in a LAS file: point format, fields, extra bytes, grid and records.

use std::borrow::Cow;

use las::{Version, raw};

use super::extra::Extra;
use super::fields::{self, Field, Kind, unique};
use super::fit::{fit, widened};
use super::grid::Grid;
use super::record::{COPC, PROJECTION, Record, SPEC};
use super::unpack::LASZIP;
use super::{LasKept, LasMisfit, crs};
use crate::roles::Roles;
use crate::{Column, Data, Kept, Table};

/// The most extra columns whose descriptions one record holds.
const MOST_EXTRAS: usize = u16::MAX as usize / super::extra::DESCRIPTION;
const COLOURS: [&str; 3] = ["red", "green", "blue"];
/// The grid of heights that are all 0.
const FLAT: Grid = Grid { scale: 0.001, offset: 0.0 };
/// Beyond this, extents are no numbers any more.
const FARTHEST: f64 = 1e300;
/// The bit of the global encoding that says that the reference system is WKT.
const IS_WKT: u16 = 16;

/// A file to be written.
pub(super) struct Layout<'t> {
    pub(super) header: raw::Header,
    pub(super) format: u8,
    /// The fields that get values; bytes of others stay zero.
    pub(super) fields: Vec<(Field, Cow<'t, Data>)>,
    /// The bytes of a record.
    pub(super) record: usize,
    /// The bytes of a record that are not of the point format.
    pub(super) extra: usize,
    pub(super) vlrs: Vec<Record>,
    pub(super) evlrs: Vec<Record>,
}

/// Checks that a LAS file can hold a table.
pub(crate) fn check(table: &Table) -> Result<(), LasMisfit> {
    Layout::of(table).map(drop)
}

impl<'t> Layout<'t> {
    pub(super) fn of(table: &'t Table) -> Result<Self, LasMisfit> {
        let roles = Roles::find(table)?;
        let kept = match &table.kept {
            Some(Kept::Las(kept)) => Some(kept.as_ref()),
            _ => None,
        };
        let mut columns = Columns::of(table, &roles)?;
        let is_keyed = crs::epsg(&table.frame).is_some();
        let format = columns.format(kept.map(|kept| kept.format), is_keyed);
        let mut header = kept.map_or_else(new_header, |kept| kept.header.clone());
        put_grids(&mut header, table, &roles)?;
        let own = fields::standard(format, &header).unwrap_or_default();
        let mut fields = columns.take_standard(&own);
        if kept.is_none() {
            add_returns(&mut fields, &own, table.rows());
        }
        for (field, &index) in own.iter().zip(&roles.coordinates) {
            if let Some(column) = table.columns.get(index) {
                fields.push((field.clone(), as_doubles(&column.data)));
            }
        }
        let base = fields::size(&own);
        let (described, extra) = columns.take_extras(kept, (format, &own), &mut fields)?;
        let record = base + extra;
        if record > usize::from(u16::MAX) {
            return Err(LasMisfit::TooWide { format });
        }
        let (mut vlrs, evlrs) = kept.map_or_else(Default::default, kept_records);
        if kept.is_none_or(|kept| kept.frame != table.frame) {
            vlrs.retain(|record| !record.is_of(PROJECTION));
            vlrs.extend(crs::record(&table.frame));
        }
        if !described.is_empty() {
            vlrs.push(Record::new(SPEC, 4, "extra bytes", described));
        }
        finish_header(&mut header, format, (table.rows(), record), !evlrs.is_empty())?;
        Ok(Self { header, format, fields, record, extra, vlrs, evlrs })
    }
}

/// The columns beside the coordinates that have no place yet.
struct Columns<'t> {
    left: Vec<&'t Column>,
    rows: usize,
}

impl<'t> Columns<'t> {
    fn of(table: &'t Table, roles: &Roles) -> Result<Self, LasMisfit> {
        let mut left = Vec::new();
        for (index, column) in table.columns.iter().enumerate() {
            if matches!(column.data, Data::Text(_)) {
                return Err(LasMisfit::Text(column.name.clone()));
            }
            if column.name.len() > 32 {
                return Err(LasMisfit::Name(column.name.clone()));
            }
            if !roles.coordinates.contains(&index) {
                left.push(column);
            }
        }
        Ok(Self { left, rows: table.rows() })
    }

    fn find(&self, name: &str) -> Option<&'t Column> {
        self.left.iter().copied().find(|column| column.name == name)
    }

    fn has(&self, name: &str, kind: Kind) -> bool {
        self.find(name).is_some_and(|column| fit(&column.data, kind).is_some())
    }

    /// The point format that has a field for colours and times if there are such columns: the one of the
    /// file that was read, or its next of kin.
    fn format(&self, kept: Option<u8>, is_keyed: bool) -> u8 {
        let sixteen = Kind::Number(crate::scalar::Scalar::U16);
        let colours = COLOURS.iter().all(|name| self.has(name, sixteen));
        let time = self.has("gps_time", Kind::Number(crate::scalar::Scalar::F64));
        match kept {
            Some(format @ 0..=3) => format | u8::from(time) | u8::from(colours) << 1,
            Some(4) if colours => 5,
            Some(6) if colours => 7,
            Some(format) => format,
            // Formats from 6 on want their system as WKT; keys of GeoTIFF belong to those before.
            None if is_keyed => u8::from(time) | u8::from(colours) << 1,
            None if colours && self.has("nir", sixteen) => 8,
            None => 6 + u8::from(colours),
        }
    }

    /// Takes the columns that the fields of the point format hold, each by its name.
    fn take_standard(&mut self, own: &[Field]) -> Vec<(Field, Cow<'t, Data>)> {
        // Colours of 8 bits are widened together or not at all.
        let bytes = |name: &str| self.find(name).is_some_and(|column| matches!(column.data, Data::U8(_)));
        let widen = COLOURS.iter().all(|name| bytes(name));
        let mut taken = Vec::new();
        for field in own.iter().skip(3) {
            let Some(column) = self.find(&field.name) else { continue };
            let data = match COLOURS.contains(&field.name.as_str()) && widen {
                true => widened(&column.data).map(Cow::Owned),
                false => fit(&column.data, field.kind),
            };
            if let Some(data) = data {
                self.left.retain(|left| left.name != column.name);
                taken.push((field.clone(), data));
            }
        }
        taken
    }

    /// Takes all columns that are left as extra bytes, first those that were extra bytes; returns their
    /// descriptions and their bytes in a record.
    fn take_extras(
        &mut self,
        kept: Option<&LasKept>,
        (format, own): (u8, &[Field]),
        fields: &mut Vec<(Field, Cow<'t, Data>)>,
    ) -> Result<(Vec<u8>, usize), LasMisfit> {
        let base = fields::size(own);
        let mut names: Vec<String> = own.iter().map(|field| field.name.clone()).collect();
        let mut places: Vec<(Extra, Vec<Cow<'t, Data>>)> = Vec::new();
        for extra in kept.map_or(&[][..], |kept| &kept.extras) {
            let fitting = extra.fields.iter().map(|field| fit(&self.find(&field.name)?.data, field.kind));
            let Some(data) = fitting.collect::<Option<Vec<_>>>() else { continue };
            let is_taken = |name: &String| extra.fields.iter().any(|field| field.name == *name);
            self.left.retain(|column| !is_taken(&column.name));
            names.extend(extra.fields.iter().map(|field| field.name.clone()));
            places.push((extra.clone(), data));
        }
        if !self.left.is_empty() {
            // Bytes without a description can only be the last.
            let last = places.pop_if(|(extra, _)| extra.description.is_none());
            for (field, data) in last.into_iter().flat_map(|(extra, data)| extra.fields.into_iter().zip(data))
            {
                places.push((Extra::new(&field.name, field.kind.column()), vec![data]));
            }
        }
        for column in &self.left {
            let Some(scalar) = crate::scalar::Scalar::of(&column.data) else { continue };
            let name = unique(&column.name, &|name| names.iter().any(|taken| taken == name));
            if name.len() > 32 || name.trim().is_empty() {
                return Err(LasMisfit::Name(name));
            }
            places.push((Extra::new(&name, scalar), vec![Cow::Borrowed(&column.data)]));
            names.push(name);
        }
        if places.len() > MOST_EXTRAS {
            return Err(LasMisfit::TooWide { format });
        }
        let mut described = Vec::new();
        let mut size = 0;
        for (extra, data) in places {
            let bytes = extra.size();
            described.extend(extra.description.unwrap_or_default());
            for (field, data) in extra.fields.into_iter().zip(data) {
                fields.push((Field { at: base + size + field.at, ..field }, data));
            }
            size += bytes;
        }
        debug_assert!(fields.iter().all(|(_, data)| data.len() == self.rows));
        Ok((described, size))
    }
}

/// Makes each point the only return of its pulse, where no column says otherwise: LAS counts returns from 1.
fn add_returns(fields: &mut Vec<(Field, Cow<'_, Data>)>, own: &[Field], rows: usize) {
    for field in
        own.iter().filter(|field| matches!(field.name.as_str(), "return_number" | "number_of_returns"))
    {
        if !fields.iter().any(|(taken, _)| taken.name == field.name) {
            fields.push((field.clone(), Cow::Owned(Data::U8(vec![1; rows]))));
        }
    }
}

fn as_doubles(data: &Data) -> Cow<'_, Data> {
    match data {
        Data::F64(_) => Cow::Borrowed(data),
        other => Cow::Owned(Data::F64(other.to_f64().unwrap_or_default())),
    }
}

/// Gives each axis the grid it had if that loses nothing, else one of its own.
fn put_grids(header: &mut raw::Header, table: &Table, roles: &Roles) -> Result<(), LasMisfit> {
    let old = [
        Grid { scale: header.x_scale_factor, offset: header.x_offset },
        Grid { scale: header.y_scale_factor, offset: header.y_offset },
        Grid { scale: header.z_scale_factor, offset: header.z_offset },
    ];
    // Points in the plane have the height 0.
    let mut grids = if let [_, _] = roles.coordinates[..] { [old[0], old[1], FLAT] } else { old };
    for ((grid, old), &index) in grids.iter_mut().zip(old).zip(&roles.coordinates) {
        let Some(column) = table.columns.get(index) else { continue };
        let data = as_doubles(&column.data);
        let Data::F64(values) = data.as_ref() else { continue };
        if let Some(row) = values.iter().position(|value| value.is_nan() || value.abs() > FARTHEST) {
            let value = values.get(row).copied().unwrap_or(f64::NAN);
            return Err(LasMisfit::Coordinate { axis: column.name.clone(), row: row + 1, value });
        }
        if !(old.scale.is_normal() && old.offset.is_finite() && old.is_exact(values)) {
            *grid = Grid::for_values(values);
        }
    }
    let [x, y, z] = grids;
    (header.x_scale_factor, header.x_offset) = (x.scale, x.offset);
    (header.y_scale_factor, header.y_offset) = (y.scale, y.offset);
    (header.z_scale_factor, header.z_offset) = (z.scale, z.offset);
    Ok(())
}

/// The header of a table that was not LAS: version 1.4, no grid yet.
fn new_header() -> raw::Header {
    let software = concat!("footpoint ", env!("CARGO_PKG_VERSION"));
    raw::Header {
        version: Version::new(1, 4),
        generating_software: super::record::padded(software),
        ..raw::Header::default()
    }
}

/// The records that still hold of the points, without those about how the old file stored them: packing,
/// octree, index of the points, descriptions of extra bytes.
fn kept_records(kept: &LasKept) -> (Vec<Record>, Vec<Record>) {
    let holds = |record: &&Record| {
        let index = record.is("LAStools", 30);
        !(record.is(LASZIP.0, LASZIP.1) || record.is_of(COPC) || index || record.is(SPEC, 4))
    };
    let copies = |records: &[Record]| records.iter().filter(holds).cloned().collect();
    (copies(&kept.vlrs), copies(&kept.evlrs))
}

fn finish_header(
    header: &mut raw::Header,
    format: u8,
    (rows, record): (usize, usize),
    has_evlrs: bool,
) -> Result<(), LasMisfit> {
    let least = match format {
        0 | 1 => 0,
        2 | 3 => 2,
        4 | 5 => 3,
        _ => 4,
    };
    let minor = header.version.minor.max(least);
    if minor < 4 && u32::try_from(rows).is_err() {
        return Err(LasMisfit::TooManyPoints(rows));
    }
    header.version = Version::new(1, minor);
    let own = header.version.header_size();
    header.padding.truncate(usize::from(u16::MAX - own));
    header.header_size = own + header.padding.len() as u16;
    header.point_data_record_format = format;
    header.point_data_record_length = record as u16;
    if format > 5 {
        header.global_encoding |= IS_WKT;
    }
    header.large_file = (minor == 4).then(raw::header::LargeFile::default);
    header.evlr = None;
    header.start_of_waveform_data_packet_record = (minor > 2 && !has_evlrs).then_some(0);
    Ok(())
}
