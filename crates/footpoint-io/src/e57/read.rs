//! Reading E57: a plan of columns from all scans, then the points scan by scan.

use std::collections::{HashMap, HashSet};
use std::fs::File;
use std::path::Path;
use std::rc::Rc;

use e57::{E57Reader, PointCloud, RecordName, RecordValue};

use super::file::{Limits, Tracked};
use super::records::{self, Extended, bits, column_name, number, push, scalar};
use super::{E57Error, E57Kept, E57Scan, Pose, is_e57};
use crate::input::ReadProblem;
use crate::scalar::Scalar;
use crate::{Column, Data, Frame, Kept, ReadReport, Table, Unit, Watch};

/// Bytes that attributes may run ahead of each other: many packets, which have 64 KiB at most.
const AHEAD: u64 = 1 << 20;
/// Attributes of the richest files: some dozens.
const MOST_COLUMNS: usize = 4096;
const AXES: [&str; 3] = ["x", "y", "z"];

/// A scan, and where the values of its points go.
struct Scan {
    cloud: PointCloud,
    pose: Option<Pose>,
    /// For each attribute, the index of its column.
    columns: Vec<Option<usize>>,
    cartesian: Option<[usize; 3]>,
    cartesian_state: Option<usize>,
    spherical: Option<[usize; 3]>,
    spherical_state: Option<usize>,
}

/// A column of the table to be.
struct Plan {
    name: String,
    scalar: Scalar,
}

pub(crate) fn read(path: &Path, watch: Option<&dyn Watch>) -> Result<(Table, ReadReport), ReadProblem> {
    let mut file = File::open(path)?;
    check_length(&mut file)?;
    let size = file.metadata()?.len();
    let (tracked, limits) = Tracked::new(file, size, watch);
    let stopped = |problem: E57Error| match limits.stopped.get() {
        true => ReadProblem::Stopped,
        false => problem.into(),
    };
    let mut reader =
        E57Reader::new(tracked).map_err(|error| stopped(E57Error::Description(error.to_string())))?;
    let mut scans = Vec::new();
    for (index, cloud) in reader.pointclouds().into_iter().enumerate() {
        scans.push(Scan::new(cloud, index + 1)?);
    }
    check_claims(&scans, size)?;
    let mut report = ReadReport::default();
    let (plans, extensions) = plan(&mut scans, &reader.extensions())?;
    let rows: u64 = scans.iter().map(|scan| scan.cloud.records).sum();
    // Room for all points, unless the table would be far larger than the file.
    let is_likely = rows.saturating_mul(plans.len() as u64) <= size.saturating_add(1 << 17);
    let room = usize::try_from(rows).ok().filter(|_| is_likely).unwrap_or(0);
    let empty = |plan: &Plan| Column::new(plan.name.clone(), plan.scalar.column(room));
    let mut columns: Vec<Column> = plans.iter().map(empty).collect();
    let mut kept = E57Kept { extensions, ..E57Kept::default() };
    for (index, scan) in scans.iter().enumerate() {
        let before = columns.first().map_or(0, |column| column.data.len());
        read_points(&mut reader, (scan, index), &mut columns, (&limits, &mut kept)).map_err(stopped)?;
        let after = columns.first().map_or(0, |column| column.data.len());
        if after > before {
            fill(&mut columns, after, index, &mut report.notes);
        }
        kept.scans.push(scan.kept(after - before));
        report.notes.extend(scan.colour_note(index));
    }
    if scans.len() > 1 {
        let name = if columns.iter().any(|column| column.name == "scan") { "scan_index" } else { "scan" };
        columns.push(Column::new(name, scan_column(&kept.scans)));
    }
    match reader.images().len() {
        0 => {}
        images => report.notes.push(format!("{images} images were passed over")),
    }
    let crs = reader.coordinate_metadata().filter(|crs| !crs.trim().is_empty()).map(str::to_owned);
    let frame = Frame { crs, unit: Some(Unit::Metre) };
    Ok((Table { columns, frame, kept: Some(Kept::E57(kept)), ..Table::default() }, report))
}

/// Refuses a file that is shorter than its header says: the scans are described at its end.
fn check_length(file: &mut File) -> Result<(), E57Error> {
    use std::io::{Read, Seek};
    let mut header = Vec::new();
    file.by_ref().take(24).read_to_end(&mut header)?;
    file.rewind()?;
    if !is_e57(&header) {
        return Err(if header.starts_with(&[0x1f, 0x8b]) { E57Error::Gzipped } else { E57Error::NotE57 });
    }
    let found = file.metadata()?.len();
    let stated = header.get(16..).and_then(|rest| rest.first_chunk()).map_or(24, |b| u64::from_le_bytes(*b));
    if found < stated { Err(E57Error::Cut { stated, found }) } else { Ok(()) }
}

/// Refuses more points than the file has bytes for. Attributes that take no bytes count too, as a file could have a
/// table of any size by those: 16 values for a byte are beyond all that are in use.
fn check_claims(scans: &[Scan], size: u64) -> Result<(), E57Error> {
    const VALUES_PER_BYTE: u128 = 16;
    const FREE_VALUES: u128 = 1 << 20;
    let sum = |of: &dyn Fn(&PointCloud) -> u64| {
        scans.iter().map(|scan| u128::from(scan.cloud.records) * u128::from(of(&scan.cloud))).sum::<u128>()
    };
    let bytes = sum(&|cloud| cloud.prototype.iter().map(|record| bits(&record.data_type)).sum()) / 8;
    let values = sum(&|cloud| cloud.prototype.len() as u64);
    let wanted = bytes.max(values.saturating_sub(FREE_VALUES) / VALUES_PER_BYTE);
    if wanted > u128::from(size) {
        return Err(E57Error::TooManyPoints { points: sum(&|_| 1), wanted, found: size });
    }
    Ok(())
}

impl Scan {
    fn new(cloud: PointCloud, number: usize) -> Result<Self, E57Error> {
        let place = |wanted: RecordName| cloud.prototype.iter().position(|record| record.name == wanted);
        let three = |[a, b, c]: [RecordName; 3]| Some([place(a)?, place(b)?, place(c)?]);
        let cartesian = three([RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ]);
        let spherical =
            three([RecordName::SphericalRange, RecordName::SphericalAzimuth, RecordName::SphericalElevation]);
        let cartesian_state = place(RecordName::CartesianInvalidState);
        let spherical_state = place(RecordName::SphericalInvalidState);
        if cloud.records > 0 && cartesian.or(spherical).is_none() {
            return Err(E57Error::NoCoordinates { scan: number });
        }
        if cloud.records > 0 && cloud.prototype.iter().all(|record| bits(&record.data_type) == 0) {
            return Err(E57Error::NoBytes { scan: number, points: cloud.records });
        }
        let pose = match &cloud.transform {
            None => None,
            Some(pose) => {
                let (q, t) = (&pose.rotation, &pose.translation);
                let pose = Pose::new([q.w, q.x, q.y, q.z], [t.x, t.y, t.z]);
                Some(pose.ok_or(E57Error::Pose { scan: number })?)
            }
        };
        let pose = pose.filter(|pose| !pose.is_identity());
        let columns = Vec::new();
        Ok(Self { cloud, pose, columns, cartesian, cartesian_state, spherical, spherical_state })
    }

    /// Whether an attribute is part of `x y z` or of the state of those, and no column for itself.
    fn is_taken(&self, index: usize) -> bool {
        let is_one_of = |three: Option<[usize; 3]>| three.is_some_and(|three| three.contains(&index));
        is_one_of(self.cartesian)
            || self.cartesian_state == Some(index)
            || (self.cartesian.is_none()
                && (is_one_of(self.spherical) || self.spherical_state == Some(index)))
    }

    fn has_state(&self) -> bool {
        self.cartesian_state.is_some() || (self.cartesian.is_none() && self.spherical_state.is_some())
    }

    fn are_coordinates_single(&self) -> bool {
        let is_single = |index: &usize| {
            self.cloud.prototype.get(*index).is_some_and(|record| scalar(&record.data_type) == Scalar::F32)
        };
        let places = self.cartesian.filter(|_| self.pose.is_none() && self.spherical.is_none());
        places.is_some_and(|places| places.iter().all(is_single))
    }

    fn kept(&self, rows: usize) -> E57Scan {
        let cloud = &self.cloud;
        let limit = |value: &Option<RecordValue>, name: RecordName| {
            let record = cloud.prototype.iter().find(|record| record.name == name)?;
            Some(number(value.as_ref()?, &record.data_type))
        };
        let colour_limits = cloud.color_limits.as_ref().and_then(|limits| {
            Some([
                limit(&limits.red_min, RecordName::ColorRed)?,
                limit(&limits.red_max, RecordName::ColorRed)?,
                limit(&limits.green_min, RecordName::ColorGreen)?,
                limit(&limits.green_max, RecordName::ColorGreen)?,
                limit(&limits.blue_min, RecordName::ColorBlue)?,
                limit(&limits.blue_max, RecordName::ColorBlue)?,
            ])
        });
        let intensity_limits = cloud.intensity_limits.as_ref().and_then(|limits| {
            let of = |value| limit(value, RecordName::Intensity);
            Some([of(&limits.intensity_min)?, of(&limits.intensity_max)?])
        });
        E57Scan {
            name: cloud.name.clone(),
            guid: cloud.guid.clone(),
            description: cloud.description.clone(),
            rows,
            pose: self.pose,
            colour_limits,
            intensity_limits,
        }
    }

    /// What to say of colours whose limits are not those of the type they come in.
    fn colour_note(&self, index: usize) -> Option<String> {
        let [low, high, ..] = self.kept(0).colour_limits?;
        let red = self.cloud.prototype.iter().find(|record| record.name == RecordName::ColorRed)?;
        let full = match scalar(&red.data_type) {
            Scalar::U8 => 255.0,
            Scalar::U16 => 65535.0,
            _ => 1.0,
        };
        (low != 0.0 || high != full)
            .then(|| format!("colours of scan {} run from {low} to {high}", index + 1))
    }

    /// The coordinates of a point in the scan's own frame, and their state: 0 where they are valid.
    fn coordinates(&self, values: &[RecordValue]) -> ([f64; 3], u8) {
        let number = |index: usize| match (values.get(index), self.cloud.prototype.get(index)) {
            (Some(value), Some(record)) => number(value, &record.data_type),
            _ => f64::NAN,
        };
        let state = |index: Option<usize>| index.map_or(0.0, number) as u8;
        let spherical = || {
            let [range, azimuth, elevation] = self.spherical?.map(number);
            let flat = range * elevation.cos();
            Some([flat * azimuth.cos(), flat * azimuth.sin(), range * elevation.sin()])
        };
        match self.cartesian {
            Some(places) => {
                let cartesian_state = state(self.cartesian_state);
                match spherical() {
                    Some(point) if cartesian_state != 0 && state(self.spherical_state) == 0 => (point, 0),
                    _ => (places.map(number), cartesian_state),
                }
            }
            None => (spherical().unwrap_or([f64::NAN; 3]), state(self.spherical_state)),
        }
    }
}

/// The columns of all scans, in the order in which the first scan with each names it, and the attributes of
/// extensions among them. Fills [`Scan::columns`].
fn plan(scans: &mut [Scan], known: &[e57::Extension]) -> Result<(Vec<Plan>, Vec<Extended>), E57Error> {
    let single = !scans.is_empty() && scans.iter().all(Scan::are_coordinates_single);
    let axis = if single { Scalar::F32 } else { Scalar::F64 };
    let mut plans: Vec<Plan> =
        AXES.iter().map(|name| Plan { name: (*name).to_owned(), scalar: axis }).collect();
    let mut extensions: Vec<Extended> = Vec::new();
    if scans.iter().any(Scan::has_state) {
        plans.push(Plan { name: "invalid_state".to_owned(), scalar: Scalar::U8 });
    }
    let mut places: HashMap<String, usize> = HashMap::new();
    for (number, scan) in scans.iter_mut().enumerate() {
        let mut names: HashSet<String> = AXES.iter().map(|name| (*name).to_owned()).collect();
        names.insert("invalid_state".to_owned());
        for (index, record) in scan.cloud.prototype.iter().enumerate() {
            if scan.is_taken(index) {
                scan.columns.push(None);
                continue;
            }
            let mut name = column_name(&record.name);
            if let (RecordName::Unknown { namespace, name: tag }, true) =
                (&record.name, names.contains(&name))
            {
                name = format!("{namespace}_{tag}");
            }
            if !names.insert(name.clone()) {
                return Err(E57Error::DuplicateName { scan: number + 1, name });
            }
            let scalar = scalar(&record.data_type);
            let place = *places.entry(name.clone()).or_insert(plans.len());
            if let Some(plan) = plans.get_mut(place) {
                plan.scalar = records::common(plan.scalar, scalar);
            } else {
                extensions.extend(extended(&name, &record.name, known));
                plans.push(Plan { name, scalar });
            }
            scan.columns.push(Some(place));
        }
    }
    if plans.len() > MOST_COLUMNS {
        return Err(E57Error::TooWide { found: plans.len(), most: MOST_COLUMNS });
    }
    Ok((plans, extensions))
}

/// Where an attribute of an extension goes back to, if it is not one of those that are found anew.
fn extended(column: &str, name: &RecordName, known: &[e57::Extension]) -> Option<Extended> {
    let RecordName::Unknown { namespace, name } = name else { return None };
    let known = known.iter().find(|known| known.namespace == *namespace)?;
    let is_found_anew = [records::OURS.0, records::NORMALS.0].contains(&namespace.as_str());
    let (column, namespace, name, url) =
        (column.to_owned(), namespace.clone(), name.clone(), known.url.clone());
    (!is_found_anew).then_some(Extended { column, namespace, name, url })
}

fn read_points(
    reader: &mut E57Reader<Tracked<'_>>,
    (scan, index): (&Scan, usize),
    columns: &mut [Column],
    (limits, kept): (&Rc<Limits>, &mut E57Kept),
) -> Result<(), E57Error> {
    let points = scan.cloud.records;
    if points == 0 {
        return Ok(());
    }
    let number = index + 1;
    let broken = |point: u64, what: String| E57Error::Points { scan: number, point: point + 1, points, what };
    let bits: u64 = scan.cloud.prototype.iter().map(|record| bits(&record.data_type)).sum();
    let start = limits.read.get();
    limits.allowed.set(start + AHEAD);
    let raw = reader.pointcloud_raw(&scan.cloud).map_err(|error| broken(0, error.to_string()))?;
    let has_state = columns.get(3).is_some_and(|column| column.name == "invalid_state");
    let mut row = columns.first().map_or(0, |column| column.data.len());
    for (point, values) in (0..points).zip(raw) {
        let values = values.map_err(|error| broken(point, error.to_string()))?;
        let bytes = (point + 1).saturating_mul(bits) / 8;
        limits.allowed.set(start.saturating_add(bytes + bytes / 4).saturating_add(AHEAD));
        for ((value, record), column) in values.iter().zip(&scan.cloud.prototype).zip(&scan.columns) {
            let Some(column) = column.and_then(|column| columns.get_mut(column)) else { continue };
            push(&mut column.data, value, &record.data_type).ok_or_else(|| E57Error::Value {
                scan: number,
                point: point + 1,
                name: column.name.clone(),
            })?;
        }
        let (stated, state) = scan.coordinates(&values);
        let at = match &scan.pose {
            _ if state != 0 && stated.iter().all(|c| c.is_finite()) => {
                kept.stated.push((row, scan.pose.map_or(stated, |pose| pose.turn(stated))));
                [f64::NAN; 3]
            }
            Some(pose) => pose.place(stated),
            None => stated,
        };
        for (column, value) in columns.iter_mut().zip(at) {
            match &mut column.data {
                Data::F32(values) => values.push(value as f32),
                Data::F64(values) => values.push(value),
                _ => {}
            }
        }
        if let Some(Data::U8(states)) = columns.get_mut(3).map(|c| &mut c.data).filter(|_| has_state) {
            states.push(state);
        }
        row += 1;
    }
    limits.allowed.set(u64::MAX);
    Ok(())
}

/// Brings all columns to one length: what a scan does not have is NaN there, or 0 in columns of integers.
fn fill(columns: &mut [Column], rows: usize, index: usize, notes: &mut Vec<String>) {
    let mut zeros = Vec::new();
    for Column { name, data } in columns {
        if data.len() < rows && Scalar::of(data).is_some_and(Scalar::is_integer) {
            zeros.push(name.as_str());
        }
        match data {
            Data::I8(v) => v.resize(rows, 0),
            Data::U8(v) => v.resize(rows, 0),
            Data::I16(v) => v.resize(rows, 0),
            Data::U16(v) => v.resize(rows, 0),
            Data::I32(v) => v.resize(rows, 0),
            Data::U32(v) => v.resize(rows, 0),
            Data::I64(v) => v.resize(rows, 0),
            Data::U64(v) => v.resize(rows, 0),
            Data::F32(v) => v.resize(rows, f32::NAN),
            Data::F64(v) => v.resize(rows, f64::NAN),
            Data::Text(_) => {}
        }
    }
    if !zeros.is_empty() {
        notes.push(format!("scan {} has no {}; it is 0 there", index + 1, zeros.join(", ")));
    }
}

/// The index of its scan for each point.
fn scan_column(scans: &[E57Scan]) -> Data {
    let all = scans.iter().enumerate();
    match u16::try_from(scans.len() - 1) {
        Ok(_) => Data::U16(all.flat_map(|(i, scan)| std::iter::repeat_n(i as u16, scan.rows)).collect()),
        Err(_) => Data::U32(all.flat_map(|(i, scan)| std::iter::repeat_n(i as u32, scan.rows)).collect()),
    }
}
