//! The coordinate reference system of a LAS file and its unit: WKT, or the keys of GeoTIFF.

use las::crs::GeoTiffData;
use las::{Builder, Vlr};

use super::header::Head;
use super::record::{PROJECTION, Record};
use super::wkt;
use crate::{Frame, Unit};

/// The record of WKT.
pub(super) const WKT: u16 = 2112;
/// The records of the keys of GeoTIFF: directory, numbers and texts.
pub(super) const KEYS: u16 = 34735;
const KEY_NUMBERS: u16 = 34736;
const KEY_TEXTS: u16 = 34737;
/// Keys (OGC 19-008r4, section 7), and the value that says `see the other keys`.
const MODEL: u16 = 1024;
const GEODETIC: u16 = 2048;
const PROJECTED: u16 = 3072;
const LINEAR_UNIT: u16 = 3076;
const USER_DEFINED: u16 = 32767;

/// What the file says of its coordinates; a record that cannot be read is told in the notes.
pub(super) fn frame(head: &Head, notes: &mut Vec<String>) -> Frame {
    let wkt = head.records().find(|record| record.is(PROJECTION, WKT));
    let wkt = wkt.map(|record| super::record::text(&record.data)).filter(|wkt| !wkt.is_empty());
    if let Some(wkt) = wkt {
        let unit = wkt::unit(&wkt);
        return Frame { crs: Some(wkt), unit };
    }
    match from_keys(head, notes) {
        Ok(frame) => frame,
        Err(problem) => {
            notes.push(format!("the reference system is not known: its GeoTIFF keys are broken ({problem})"));
            Frame::default()
        }
    }
}

fn from_keys(head: &Head, notes: &mut Vec<String>) -> las::Result<Frame> {
    let mut builder = Builder::from((1, 4));
    let wanted =
        |record: &&Record| record.is_of(PROJECTION) && matches!(record.id(), KEYS | KEY_NUMBERS | KEY_TEXTS);
    builder.vlrs = head
        .records()
        .filter(wanted)
        .map(|record| Vlr {
            user_id: PROJECTION.to_owned(),
            record_id: record.id(),
            description: String::new(),
            data: record.data.clone(),
        })
        .collect();
    let Some(keys) = builder.into_header()?.get_geotiff_crs()? else { return Ok(Frame::default()) };
    if keys.entries.iter().any(|entry| entry.id == 0) {
        notes.push(
            "some of the GeoTIFF keys are empty; the reference system is what the others say".to_owned(),
        );
    }
    let value = |id: u16| {
        let entry = keys.entries.iter().find(|entry| entry.id == id)?;
        if let GeoTiffData::U16(value) = entry.data { Some(value) } else { None }
    };
    let code = |id| value(id).filter(|&code| code > 0 && code != USER_DEFINED);
    let is_geographic = value(MODEL) == Some(2) || value(PROJECTED).is_none() && value(GEODETIC).is_some();
    let crs = if is_geographic { code(GEODETIC) } else { code(PROJECTED) };
    let unit = match value(LINEAR_UNIT) {
        _ if is_geographic && value(MODEL) != Some(1) => Some(Unit::Degree),
        Some(9001) => Some(Unit::Metre),
        Some(9002) => Some(Unit::Foot),
        Some(9003) => Some(Unit::UsSurveyFoot),
        _ => None,
    };
    Ok(Frame { crs: crs.map(|code| format!("EPSG:{code}")), unit })
}

/// The number of a system given as `EPSG:` and a number.
pub(super) fn epsg(frame: &Frame) -> Option<u16> {
    frame.crs.as_ref()?.strip_prefix("EPSG:")?.parse().ok()
}

/// The record that states a frame, if it has a system.
pub(super) fn record(frame: &Frame) -> Option<Record> {
    let crs = frame.crs.as_ref()?;
    let Some(code) = epsg(frame) else {
        let mut data = crs.clone().into_bytes();
        data.push(0);
        return Some(Record::new(PROJECTION, WKT, "coordinate reference system", data));
    };
    let (model, system) = if frame.unit == Some(Unit::Degree) { (2, GEODETIC) } else { (1, PROJECTED) };
    let mut keys = vec![(MODEL, model), (system, code)];
    match frame.unit {
        Some(Unit::Metre) => keys.push((LINEAR_UNIT, 9001)),
        Some(Unit::Foot) => keys.push((LINEAR_UNIT, 9002)),
        Some(Unit::UsSurveyFoot) => keys.push((LINEAR_UNIT, 9003)),
        Some(Unit::Degree) | None => {}
    }
    let mut words = vec![1, 1, 0, keys.len() as u16];
    keys.into_iter().for_each(|(key, value)| words.extend([key, 0, 1, value]));
    let data = words.into_iter().flat_map(u16::to_le_bytes).collect();
    Some(Record::new(PROJECTION, KEYS, "GeoTIFF keys", data))
}
