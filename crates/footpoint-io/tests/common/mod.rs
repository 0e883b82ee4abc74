//! What several tests need: files of given bytes, and reading them.

#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

use std::path::{Path, PathBuf};

use footpoint_io::{Column, Data, Input, Table, read};
use tempfile::TempDir;

/// A folder of its own with one file in it.
pub(crate) struct Sample {
    _folder: TempDir,
    pub(crate) path: PathBuf,
}

impl Sample {
    pub(crate) fn new(name: &str, bytes: impl AsRef<[u8]>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Self { _folder: folder, path }
    }
}

/// Reads a file of this name and content that must be readable.
pub(crate) fn parse(name: &str, bytes: impl AsRef<[u8]>) -> Input {
    read(&Sample::new(name, bytes).path).unwrap()
}

/// The message for a file of this name and content that must not be readable.
pub(crate) fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let sample = Sample::new(name, bytes);
    let message = read(&sample.path).unwrap_err().to_string();
    assert!(message.starts_with(&sample.path.display().to_string()), "no path in: {message}");
    message
}

pub(crate) fn names(table: &Table) -> Vec<&str> {
    table.columns.iter().map(|column| column.name.as_str()).collect()
}

pub(crate) fn numbers(table: &Table, name: &str) -> Vec<f64> {
    table.column(name).unwrap().data.to_f64().unwrap()
}

pub(crate) fn f64_table(columns: &[(&str, &[f64])]) -> Table {
    let columns = columns.iter().map(|(name, values)| Column::new(*name, Data::F64(values.to_vec())));
    Table { columns: columns.collect(), ..Table::default() }
}

/// A column of each number type, with the values that formats like to lose.
pub(crate) fn extremes() -> Table {
    let mut table =
        Table { comments: vec!["by a test".into(), "obj_info grid 2".into()], ..Table::default() };
    table.set(Column::new("x", Data::F64(vec![-0.0, 5e-324, f64::MAX, f64::NAN, f64::NEG_INFINITY, 0.1])));
    table.set(Column::new("y", Data::F32(vec![-0.0, 1e-45, f32::MAX, f32::NAN, f32::INFINITY, 0.1])));
    table.set(Column::new("a", Data::I8(vec![i8::MIN, i8::MAX, 0, 1, -1, 2])));
    table.set(Column::new("b", Data::U8(vec![u8::MIN, u8::MAX, 0, 1, 2, 3])));
    table.set(Column::new("c", Data::I16(vec![i16::MIN, i16::MAX, 0, 1, -1, 2])));
    table.set(Column::new("d", Data::U16(vec![u16::MIN, u16::MAX, 0, 1, 2, 3])));
    table.set(Column::new("e", Data::I32(vec![i32::MIN, i32::MAX, 0, 1, -1, 2])));
    table.set(Column::new("f", Data::U32(vec![u32::MIN, u32::MAX, 0, 1, 2, 3])));
    let wide = vec![1e-5, 9.999e-6, 1e16, 9_007_199_254_740_991.0, 1.0 / 3.0, -123_456.789];
    table.set(Column::new("g", Data::F64(wide)));
    table
}

/// All values as bits, so that `nan` equals itself and `-0` does not equal `0`.
pub(crate) fn bits(data: &Data) -> Vec<u64> {
    match data {
        Data::F32(values) => values.iter().map(|v| u64::from(v.to_bits())).collect(),
        other => other.to_f64().unwrap().iter().map(|v| v.to_bits()).collect(),
    }
}

/// The folder of real files beside the project, if it is there.
pub(crate) fn real_files() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no folder shared/data beside the project");
    None
}

/// A fixed sequence of numbers, the same in each run.
pub(crate) struct Lcg(pub(crate) u64);

impl Lcg {
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % limit
    }
}

/// What an E57 file holds between the checksums of its pages.
pub(crate) fn unpaged(bytes: &[u8]) -> Vec<u8> {
    bytes.chunks(1024).flat_map(|page| &page[..page.len().min(1020)]).copied().collect()
}

/// An E57 file of this content, with the checksums of its pages.
pub(crate) fn paged(content: &[u8]) -> Vec<u8> {
    content.chunks(1020).flat_map(|page| [page, &crc32c(page).to_be_bytes()].concat()).collect()
}

fn crc32c(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0x82f6_3b78 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}
