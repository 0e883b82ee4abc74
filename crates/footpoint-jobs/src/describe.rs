//! What is said of a file that was read: its format, its unit, what was guessed or passed over.

use footpoint_io::{Format, Input, ReadReport, Unit};
use footpoint_render::Origin;

/// The format as reports have it.
pub fn format_name(format: Format) -> &'static str {
    match format {
        Format::Ply(_) => "ply",
        Format::E57 => "e57",
        Format::Pcd(_) => "pcd",
        Format::Text => "text",
        Format::Las => "las",
        Format::Laz => "laz",
        Format::Copc => "copc",
        Format::Obj => "obj",
        Format::Ptx => "ptx",
        Format::Npy => "npy",
        Format::Npz => "npz",
    }
}

/// What is known of where a cloud comes from: its format's name, if it has one, and whether a reference
/// system is stated.
pub fn origin_of(format: Option<&str>, has_reference_system: bool) -> Origin {
    match format {
        Some("las" | "laz" | "copc" | "e57" | "ptx") => Origin::SurveyFormat,
        _ if has_reference_system => Origin::ReferenceSystem,
        _ => Origin::Unknown,
    }
}

/// The unit as reports have it.
pub fn unit_name(unit: Unit) -> &'static str {
    match unit {
        Unit::Metre => "metre",
        Unit::Foot => "foot",
        Unit::UsSurveyFoot => "us_survey_foot",
        Unit::Degree => "degree",
        _ => "other",
    }
}

/// Guesses and doubts of the reader, and what it passed over, a sentence each.
pub fn notes(report: &ReadReport) -> Vec<String> {
    let mut notes = report.notes.clone();
    for element in &report.other_elements {
        notes.push(format!("{} rows of element `{}` passed over", element.rows, element.name));
    }
    for list in &report.skipped_lists {
        notes.push(format!("list property `{list}` of the points passed over"));
    }
    notes
}

/// Points that the file states and does not hold.
pub fn missing_points(input: &Input) -> u64 {
    let rows = input.table.rows() as u64;
    input.report.stated_rows.map_or(0, |stated| stated.saturating_sub(rows))
}
