//! Writing E57: standard attributes for the columns that have one, an extension of ours for all others.

use std::io::{self, Read, Seek, Write};
use std::ops::Range;

use e57::{
    CartesianBounds, ColorLimits, E57Writer, Extension, IntensityLimits, Record, RecordDataType, RecordName,
    RecordValue,
};

use super::records::{self, Extended, NORMALS, OURS};
use super::{E57Kept, E57Scan};
use crate::output::WriteProblem;
use crate::scalar::Scalar;
use crate::{Column, Data, Kept, Table};

/// Attributes whose values still fit a packet of 64 KiB many times.
const MOST_COLUMNS: usize = 1000;
const AXES: [RecordName; 3] = [RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ];

/// Checks that a column can be an attribute.
pub(crate) fn check(column: &Column) -> Result<(), WriteProblem> {
    let name = column.name.clone();
    if Scalar::of(&column.data).is_none() {
        return Err(WriteProblem::Text { name, format: "E57" });
    }
    match records::data_type(&column.data) {
        Some(_) => Ok(()),
        None => Err(WriteProblem::Wide { name, format: "E57" }),
    }
}

/// Checks that a table, whose columns fit, has points in space and names that fit.
pub(crate) fn check_table(table: &Table) -> Result<(), WriteProblem> {
    if records::coordinates(table).is_none() {
        return Err(WriteProblem::NoPoints { format: "E57" });
    }
    let found = table.columns.len();
    if found > MOST_COLUMNS {
        return Err(WriteProblem::TooManyColumns { found, most: MOST_COLUMNS, format: "E57" });
    }
    let scans = scans(table);
    let layout = Layout::of(table, &scans);
    let bad = layout.fields.iter().find_map(|(record, column)| match &record.name {
        RecordName::Unknown { namespace, name } if namespace == OURS.0 && !records::is_name(name) => {
            Some(column)
        }
        _ => None,
    });
    match bad {
        Some(column) => Err(WriteProblem::Name(column.name.clone())),
        None => Ok(()),
    }
}

/// Writes the table: a scan for each value of the column `scan` where a file of several scans was read, else one.
/// Points without finite coordinates are marked as invalid.
pub(crate) fn write(file: &mut (impl Read + Write + Seek), table: &Table) -> io::Result<()> {
    write_all(file, table).map_err(io::Error::other)
}

fn write_all(file: &mut (impl Read + Write + Seek), table: &Table) -> e57::Result<()> {
    let empty = E57Kept::default();
    let kept = kept(table).unwrap_or(&empty);
    let scans = scans(table);
    let layout = Layout::of(table, &scans);
    let mut writer = E57Writer::new(file, &guid(table, 0))?;
    writer.set_coordinate_metadata(table.frame.crs.as_deref().map(cdata));
    for (namespace, url) in layout.namespaces(&kept.extensions) {
        writer.register_extension(Extension::new(&namespace, &url))?;
    }
    for (index, rows) in scans.into_iter().enumerate() {
        let was = kept.scans.get(index);
        let guid = was.and_then(|was| was.guid.as_deref()).map_or_else(|| guid(table, index + 1), cdata);
        let mut prototype: Vec<Record> = layout.fields.iter().map(|(record, _)| record.clone()).collect();
        if layout.marks_invalid {
            prototype.push(records::state_record());
        }
        let mut cloud = writer.add_pointcloud(&guid, prototype)?;
        if let Some(was) = was {
            cloud.set_name(was.name.as_deref().map(cdata));
            cloud.set_description(was.description.as_deref().map(cdata));
            if let Some(limits) = layout.colour_limits(was) {
                cloud.set_color_limits(Some(limits));
            }
            if let Some(limits) = layout.intensity_limits(was) {
                cloud.set_intensity_limits(Some(limits));
            }
        }
        let mut bounds = None;
        let is_empty = rows.is_empty();
        for row in rows {
            let point = layout.point(row);
            if point.iter().all(|c| c.is_finite()) && layout.is_valid(row) {
                extend(&mut bounds, point);
            }
            cloud.add_point(layout.values(row, point))?;
        }
        cloud.set_cartesian_bounds(bounds.map(|[low, high]: [[f64; 3]; 2]| CartesianBounds {
            x_min: Some(low[0]),
            x_max: Some(high[0]),
            y_min: Some(low[1]),
            y_max: Some(high[1]),
            z_min: Some(low[2]),
            z_max: Some(high[2]),
        }));
        if is_empty {
            cloud.set_index_bounds(None);
        }
        cloud.finalize()?;
    }
    writer.finalize()
}

fn kept(table: &Table) -> Option<&E57Kept> {
    match &table.kept {
        Some(Kept::E57(kept)) => Some(kept),
        _ => None,
    }
}

/// The rows of each scan to write: by the column `scan` of the file that was read, if it still counts up.
fn scans(table: &Table) -> Vec<Range<usize>> {
    let all = || std::iter::once(0..table.rows()).collect();
    let Some(known) = kept(table).map(|kept| kept.scans.len()).filter(|&known| known > 1) else {
        return all();
    };
    let numbers: Vec<usize> = match table.column("scan").map(|column| &column.data) {
        Some(Data::U16(values)) if known <= 1 << 16 => values.iter().map(|&n| n.into()).collect(),
        Some(Data::U32(values)) if known > 1 << 16 => values.iter().map(|&n| n as usize).collect(),
        _ => return all(),
    };
    if !numbers.is_sorted() || numbers.last().is_some_and(|&last| last >= known) {
        return all();
    }
    let end = |scan: usize| numbers.partition_point(|&n| n <= scan);
    (0..known).map(|scan| scan.checked_sub(1).map_or(0, end)..end(scan)).collect()
}

/// Which attribute each column is.
struct Layout<'t> {
    fields: Vec<(Record, &'t Column)>,
    /// The places of x, y, z among the fields.
    axes: [usize; 3],
    /// The states of coordinates, if a column says them.
    states: Option<&'t [u8]>,
    /// What the file read states of invalid points, if the table still has its rows.
    stated: &'t [(usize, [f64; 3])],
    /// Whether an attribute has to be added for points that are not finite.
    marks_invalid: bool,
}

impl<'t> Layout<'t> {
    fn of(table: &'t Table, scans: &[Range<usize>]) -> Self {
        let places = records::coordinates(table).unwrap_or_default();
        let extensions = kept(table).map_or(&[][..], |kept| kept.extensions.as_slice());
        let has_rows =
            |kept: &&E57Kept| kept.scans.iter().map(|scan| scan.rows).sum::<usize>() == table.rows();
        let stated = kept(table).filter(has_rows).map_or(&[][..], |kept| kept.stated.as_slice());
        let mut layout =
            Self { fields: Vec::new(), axes: [0; 3], states: None, stated, marks_invalid: false };
        for (index, column) in table.columns.iter().enumerate() {
            if scans.len() > 1 && column.name == "scan" {
                continue;
            }
            let Some(data_type) = records::data_type(&column.data) else { continue };
            let axis = places.iter().position(|&place| place == index);
            let name = match axis.and_then(|axis| Some((axis, AXES.get(axis)?))) {
                Some((axis, name)) => {
                    if let Some(place) = layout.axes.get_mut(axis) {
                        *place = layout.fields.len();
                    }
                    name.clone()
                }
                None => records::record_name(table, &column.name, extensions),
            };
            // The standard fixes the range of states and flags.
            let data_type = match name {
                RecordName::CartesianInvalidState => RecordDataType::Integer { min: 0, max: 2 },
                RecordName::IsColorInvalid
                | RecordName::IsIntensityInvalid
                | RecordName::IsTimeStampInvalid => RecordDataType::Integer { min: 0, max: 1 },
                _ => data_type,
            };
            if let (RecordName::CartesianInvalidState, Data::U8(states)) = (&name, &column.data) {
                layout.states = Some(states);
            }
            layout.fields.push((Record { name, data_type }, column));
        }
        let is_finite = |data: &Data| match data {
            Data::F32(values) => values.iter().all(|value| value.is_finite()),
            Data::F64(values) => values.iter().all(|value| value.is_finite()),
            _ => true,
        };
        let mut axes = places.iter().filter_map(|&place| table.columns.get(place));
        layout.marks_invalid = layout.states.is_none() && !axes.all(|axis| is_finite(&axis.data));
        layout
    }

    /// The namespaces in use, with their addresses.
    fn namespaces(&self, extensions: &[Extended]) -> Vec<(String, String)> {
        let mut found: Vec<(String, String)> = Vec::new();
        for (record, _) in &self.fields {
            let RecordName::Unknown { namespace, .. } = &record.name else { continue };
            let other = extensions.iter().find(|extended| extended.namespace == *namespace);
            let url = match namespace.as_str() {
                namespace if namespace == OURS.0 => OURS.1,
                namespace if namespace == NORMALS.0 => NORMALS.1,
                _ => other.map_or(OURS.1, |extended| extended.url.as_str()),
            };
            if !found.iter().any(|(known, _)| known == namespace) {
                found.push((namespace.clone(), url.to_owned()));
            }
        }
        found
    }

    fn is_valid(&self, row: usize) -> bool {
        self.states.and_then(|states| states.get(row)).is_none_or(|&state| state == 0)
    }

    /// The coordinates to write in a row: of an invalid point, those that the file read states.
    fn point(&self, row: usize) -> [f64; 3] {
        let point = self.axes.map(|place| {
            let value = self.fields.get(place).and_then(|(record, column)| {
                Some(records::number(&records::value(&column.data, row)?, &record.data_type))
            });
            value.unwrap_or(f64::NAN)
        });
        if self.is_valid(row) || !point.iter().all(|c| c.is_nan()) {
            return point;
        }
        let stated = self.stated.binary_search_by_key(&row, |(row, _)| *row).ok();
        stated.and_then(|place| self.stated.get(place)).map_or(point, |(_, stated)| *stated)
    }

    fn values(&self, row: usize, point: [f64; 3]) -> Vec<RecordValue> {
        let value = |(place, (_, column)): (usize, &(Record, &Column))| {
            let axis = self.axes.iter().position(|&axis| axis == place).and_then(|axis| point.get(axis));
            match (records::value(&column.data, row), axis) {
                (Some(RecordValue::Single(_)), Some(&axis)) => RecordValue::Single(axis as f32),
                (Some(RecordValue::Double(_)), Some(&axis)) => RecordValue::Double(axis),
                (value, _) => value.unwrap_or(RecordValue::Integer(0)),
            }
        };
        let mut values: Vec<RecordValue> = self.fields.iter().enumerate().map(value).collect();
        if self.marks_invalid {
            let is_valid = point.iter().all(|c| c.is_finite());
            values.push(RecordValue::Integer(if is_valid { 0 } else { 2 }));
        }
        values
    }

    /// A limit in the type of its attribute.
    fn limit(&self, name: &RecordName, value: f64) -> Option<RecordValue> {
        let (record, _) = self.fields.iter().find(|(record, _)| record.name == *name)?;
        Some(match record.data_type {
            RecordDataType::Integer { .. } => RecordValue::Integer(value as i64),
            RecordDataType::Single { .. } => RecordValue::Single(value as f32),
            _ => RecordValue::Double(value),
        })
    }

    fn colour_limits(&self, was: &E57Scan) -> Option<ColorLimits> {
        let [a, b, c, d, e, f] = was.colour_limits?;
        Some(ColorLimits {
            red_min: Some(self.limit(&RecordName::ColorRed, a)?),
            red_max: Some(self.limit(&RecordName::ColorRed, b)?),
            green_min: Some(self.limit(&RecordName::ColorGreen, c)?),
            green_max: Some(self.limit(&RecordName::ColorGreen, d)?),
            blue_min: Some(self.limit(&RecordName::ColorBlue, e)?),
            blue_max: Some(self.limit(&RecordName::ColorBlue, f)?),
        })
    }

    fn intensity_limits(&self, was: &E57Scan) -> Option<IntensityLimits> {
        let [low, high] = was.intensity_limits?;
        Some(IntensityLimits {
            intensity_min: Some(self.limit(&RecordName::Intensity, low)?),
            intensity_max: Some(self.limit(&RecordName::Intensity, high)?),
        })
    }
}

fn extend(bounds: &mut Option<[[f64; 3]; 2]>, point: [f64; 3]) {
    let [low, high] = bounds.unwrap_or([point; 2]);
    let pairs = |with: [f64; 3], better: fn(f64, f64) -> f64| -> [f64; 3] {
        std::array::from_fn(|k| better(with[k], point[k]))
    };
    *bounds = Some([pairs(low, f64::min), pairs(high, f64::max)]);
}

/// A string as the crate can put it between the marks of character data: without their end, and without characters
/// that XML has not.
fn cdata(text: &str) -> String {
    let is_allowed = |c: &char| !c.is_control() || matches!(c, '\t' | '\n' | '\r');
    let text: String = text.chars().filter(is_allowed).collect();
    text.replace("]]>", "]]]]><![CDATA[>")
}

/// A name for the file or one of its scans, from what it holds: FNV-1a over names and coordinates.
fn guid(table: &Table, index: usize) -> String {
    let mut halves = [0xcbf2_9ce4_8422_2325_u64, 0x9ae1_6a3b_2f90_404f].map(|seed| seed ^ index as u64);
    let mut take = |word: u64| {
        for half in &mut halves {
            *half = (*half ^ word).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
        }
    };
    for column in &table.columns {
        column.name.bytes().for_each(|byte| take(byte.into()));
    }
    for place in records::coordinates(table).unwrap_or_default() {
        match table.columns.get(place).map(|column| &column.data) {
            Some(Data::F32(values)) => values.iter().for_each(|value| take(value.to_bits().into())),
            Some(Data::F64(values)) => values.iter().for_each(|value| take(value.to_bits())),
            _ => {}
        }
    }
    let hex = format!("{:016x}{:016x}", halves[0], halves[1]);
    let part = |range: Range<usize>| hex.get(range).unwrap_or_default();
    format!("{{{}-{}-{}-{}-{}}}", part(0..8), part(8..12), part(12..16), part(16..20), part(20..32))
}
