//! Writing NumPy files: all columns as one array of records (`.npy`), or each as an array in an archive (`.npz`).

use std::borrow::Cow;
use std::io::{self, Seek, Write};

use npyz::{DType, Field, WriterBuilder};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{Steps, WriteProblem};
use crate::rows::{self, Order};
use crate::scalar::Scalar;
use crate::{Column, Data, Table};

/// Checks that a column can be a field or an array.
pub(super) fn check(column: &Column) -> Result<(), WriteProblem> {
    if Scalar::of(&column.data).is_none() {
        return Err(WriteProblem::Text { name: column.name.clone(), format: "NumPy" });
    }
    if column.name.is_empty() || column.name.contains(char::is_control) {
        return Err(WriteProblem::Name(column.name.clone()));
    }
    Ok(())
}

pub(super) fn write(out: &mut impl Write, table: &Table, steps: &Steps<'_>) -> io::Result<()> {
    let fields = table
        .columns
        .iter()
        .map(|column| Ok(Field { name: column.name.clone(), dtype: dtype(&column.data)? }));
    header(out, DType::Record(fields.collect::<io::Result<_>>()?), table.rows())?;
    let columns: Vec<Cow<'_, Data>> =
        table.columns.iter().map(|column| Cow::Borrowed(&column.data)).collect();
    rows::write(out, &columns, Order::Little, |row| steps.at(row))
}

/// Writes the archive unpacked, as `numpy.savez` does: coordinates hardly shrink.
pub(super) fn write_archive(
    out: &mut (impl Write + Seek),
    table: &Table,
    steps: &Steps<'_>,
) -> io::Result<()> {
    let mut archive = ZipWriter::new(out);
    for (index, column) in table.columns.iter().enumerate() {
        let bytes = column.data.len() as u64 * Scalar::of(&column.data).map_or(0, Scalar::size);
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(bytes >= u64::from(u32::MAX) / 2);
        archive.start_file(format!("{}.npy", column.name), options)?;
        header(&mut archive, dtype(&column.data)?, column.data.len())?;
        let written = |row| steps.at_column(row, index, table.columns.len());
        rows::write(&mut archive, &[Cow::Borrowed(&column.data)], Order::Little, written)?;
    }
    archive.finish()?;
    Ok(())
}

fn header(out: &mut impl Write, dtype: DType, rows: usize) -> io::Result<()> {
    let options = npyz::WriteOptions::new_header_only().dtype(dtype).shape(&[rows as u64]);
    options.writer(out).write_header_only().map(drop)
}

/// The type of a column, least significant byte first.
fn dtype(data: &Data) -> io::Result<DType> {
    let name = match Scalar::of(data) {
        Some(Scalar::I8) => "|i1",
        Some(Scalar::U8) => "|u1",
        Some(Scalar::I16) => "<i2",
        Some(Scalar::U16) => "<u2",
        Some(Scalar::I32) => "<i4",
        Some(Scalar::U32) => "<u4",
        Some(Scalar::I64) => "<i8",
        Some(Scalar::U64) => "<u8",
        Some(Scalar::F32) => "<f4",
        Some(Scalar::F64) => "<f8",
        None => "|V0",
    };
    name.parse().map(DType::Plain).map_err(io::Error::other)
}
