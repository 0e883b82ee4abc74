//! Writing a file, a table as a rule: checks before the work, a partial file during it, one rename at the end.

mod npy;
pub(crate) mod number;
mod obj;
mod ply;
mod text;
mod watched;

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

use crate::format::{Target, WRITABLE, is_copc};
use crate::{Encoding, LasMisfit, PcdEncoding, Table, Watch, e57, las, pcd};
use watched::Watched;

const BUFFER: usize = 1 << 20;

/// How to write a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WriteOptions {
    /// What to do about a file that is there already.
    pub overwrite: Overwrite,
    /// How a `.ply` file stores its numbers; without effect on text.
    pub ply: Encoding,
    /// How a `.pcd` file stores its numbers.
    pub pcd: PcdEncoding,
}

/// What to do about a file that is there already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Overwrite {
    /// Leave it and fail.
    #[default]
    Refuse,
    /// Replace it, at the end and in one step.
    Replace,
}

/// Why a file cannot be written, with its path.
#[derive(Debug, Error)]
#[error("{}: {problem}", path.display())]
pub struct WriteError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What stands against it.
    pub problem: WriteProblem,
}

/// What stands against writing a file.
#[derive(Debug, Error)]
pub enum WriteProblem {
    /// The extension names no format that is written.
    #[error("no format to write by this name; end it in one of: {WRITABLE}")]
    UnknownExtension,
    /// The file exists and may not be replaced.
    #[error("exists already; choose another name, or allow it to be overwritten")]
    Exists,
    /// The name is taken by a folder or a device.
    #[error("is a folder or a special file; choose another name")]
    NotAFile,
    /// The folder to write to does not exist.
    #[error("the folder {} does not exist; create it first", .0.display())]
    NoFolder(PathBuf),
    /// The folder or the existing file is write-protected, or the disk refuses.
    #[error("cannot write here: {0}")]
    NotWritable(io::Error),
    /// Writing failed on the way; the partial file has been removed.
    #[error("writing failed, nothing is left behind: {0}")]
    Io(io::Error),
    /// Columns of different lengths.
    #[error("column `{name}` has {found} rows, the first column has {wanted}")]
    Uneven {
        /// The column.
        name: String,
        /// Its rows.
        found: usize,
        /// The rows of the first column.
        wanted: usize,
    },
    /// Two columns of one name, which no reader could tell apart.
    #[error("two columns are named `{0}`; rename one")]
    DuplicateName(String),
    /// What LAS cannot hold.
    #[error("{0}")]
    Las(#[from] LasMisfit),
    /// A column of text, which PLY cannot hold.
    #[error("column `{0}` holds text, which PLY cannot; write csv or txt, or leave the column out")]
    TextInPly(String),
    /// Integers that no number of a PLY file holds.
    #[error(
        "column `{0}` holds integers beyond 2^53, which PLY cannot; write csv, txt or las, or leave it out"
    )]
    WideInPly(String),
    /// A column of text, which another format cannot hold either.
    #[error("column `{name}` holds text, which {format} cannot; write csv or txt, or leave the column out")]
    Text {
        /// The column.
        name: String,
        /// The format.
        format: &'static str,
    },
    /// Integers too large, or too far apart, for a format.
    #[error("column `{name}` holds integers beyond what {format} can; write csv or txt, or leave it out")]
    Wide {
        /// The column.
        name: String,
        /// The format.
        format: &'static str,
    },
    /// A table without points in space, in a format that needs them.
    #[error("{format} needs columns x, y and z of numbers; write csv, txt or ply")]
    NoPoints {
        /// The format.
        format: &'static str,
    },
    /// More columns than a format can hold.
    #[error("{found} columns, but {format} holds {most}; leave some out")]
    TooManyColumns {
        /// The columns of the table.
        found: usize,
        /// The limit.
        most: usize,
        /// The format.
        format: &'static str,
    },
    /// Columns that OBJ has no place for.
    #[error("OBJ holds only coordinates, normals and colours; leave out {0}, or write PLY")]
    NotInObj(String),
    /// A name that cannot stand in the file's header.
    #[error("column name {0:?} cannot stand in the header of this format; rename it")]
    Name(String),
    /// A text value with a line break.
    #[error("column `{name}`, row {row}: the text has a line break, which a row cannot hold")]
    LineBreak {
        /// The column.
        name: String,
        /// The row, from 1.
        row: usize,
    },
}

/// Checks, before any work is done, that [`write()`] could put a file at `path`.
///
/// The extension must be known, the folder must exist and take a new file (one is made there and removed),
/// and the name must be free or, with [`Overwrite::Replace`], a plain file.
pub fn check_writable(path: &Path, overwrite: Overwrite) -> Result<(), WriteError> {
    at(path, || target_of(path).map(drop))?;
    check_file(path, overwrite)
}

/// Checks that the format of `path` can hold `table`: columns of one length, names of their own, no text
/// columns but in text files, finite coordinates in LAS, no line breaks in text, nothing but coordinates, normals and
/// colours in OBJ.
pub fn check_table(path: &Path, table: &Table) -> Result<(), WriteError> {
    at(path, || check_columns(target_of(path)?, table))
}

/// Writes `table` to `path` in the format of its extension: `ply las laz e57 pcd xyz csv txt pts pwn xy obj npy npz`.
///
/// All values read back as the same numbers, but for coordinates in LAS, which [`LasKept`](crate::LasKept)
/// tells of; text keeps no types, `pts` no names and no comments, `csv`, `npy` and `npz` no comments, for the sake of other
/// readers, and `obj` has colours from 0 to 1. A partial file beside `path` (`.NAME.*.partial`) becomes `path`
/// in one step when it is complete, and is removed on any error. Fails as [`check_writable`] and
/// [`check_table`] do, and on a full disk.
pub fn write(path: &Path, table: &Table, options: &WriteOptions) -> Result<(), WriteError> {
    write_with(path, table, options, None)
}

/// [`write()`], with someone who may end it: is asked now and then, and told how many bytes have been written.
pub fn write_with(
    path: &Path,
    table: &Table,
    options: &WriteOptions,
    watch: Option<&dyn Watch>,
) -> Result<(), WriteError> {
    let target = at(path, || {
        let target = target_of(path)?;
        check_columns(target, table).map(|()| target)
    })?;
    write_file(path, options.overwrite, |file| fill(Watched::new(file, watch), target, table, options))
}

/// Checks, before any work is done, that [`write_file`] could put a file at `path`, whatever its format.
pub fn check_file(path: &Path, overwrite: Overwrite) -> Result<(), WriteError> {
    at(path, || {
        check_place(path, overwrite)?;
        partial(path).map(drop)
    })
}

/// Puts a file of any format at `path`: what `fill` writes, as [`write()`] does it, in one step and never half.
pub fn write_file(
    path: &Path,
    overwrite: Overwrite,
    fill: impl FnOnce(&mut std::fs::File) -> io::Result<()>,
) -> Result<(), WriteError> {
    at(path, || {
        check_place(path, overwrite)?;
        let mut file = partial(path)?;
        fill(file.as_file_mut()).map_err(WriteProblem::Io)?;
        let kept = match overwrite {
            Overwrite::Replace => file.persist(path),
            // Someone may have written the file since the check. Some file systems have no such step;
            // there a second look must do, as the work would be lost otherwise.
            Overwrite::Refuse => file.persist_noclobber(path).or_else(|error| match path.exists() {
                true => Err(error),
                false => error.file.persist(path),
            }),
        };
        match kept {
            Ok(_) => Ok(()),
            Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Err(WriteProblem::Exists),
            Err(error) => Err(WriteProblem::Io(error.error)),
        }
    })
}

fn at<T>(path: &Path, work: impl FnOnce() -> Result<T, WriteProblem>) -> Result<T, WriteError> {
    work().map_err(|problem| WriteError { path: path.to_owned(), problem })
}

fn target_of(path: &Path) -> Result<Target, WriteProblem> {
    let target = Target::from_path(path).ok_or(WriteProblem::UnknownExtension)?;
    match target {
        Target::Las { .. } if is_copc(path) => Err(LasMisfit::Copc.into()),
        target => Ok(target),
    }
}

fn fill(file: Watched<'_>, target: Target, table: &Table, options: &WriteOptions) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER, file);
    match target {
        Target::Ply => ply::write(&mut out, table, options.ply)?,
        Target::Pcd => pcd::write(&mut out, table, options.pcd)?,
        Target::E57 => e57::write(out.get_mut(), table)?,
        Target::Text(kind) => text::write(&mut out, table, kind)?,
        Target::Las { is_packed } => las::write(&mut out, table, is_packed)?,
        Target::Obj => obj::write(&mut out, table)?,
        Target::Npy => npy::write(&mut out, table)?,
        Target::Npz => npy::write_archive(&mut out, table)?,
    }
    out.flush()
}

/// The comments, each at least one line.
fn comment_lines(table: &Table) -> impl Iterator<Item = &str> {
    table.comments.iter().flat_map(|comment| comment.split('\n')).map(|line| line.trim_end_matches('\r'))
}

/// The folder that holds `path`.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn check_place(path: &Path, overwrite: Overwrite) -> Result<(), WriteProblem> {
    if !folder(path).is_dir() {
        return Err(WriteProblem::NoFolder(folder(path).to_owned()));
    }
    match path.metadata() {
        Err(_) => Ok(()),
        Ok(there) if !there.is_file() => Err(WriteProblem::NotAFile),
        Ok(_) if overwrite == Overwrite::Refuse => Err(WriteProblem::Exists),
        Ok(there) if there.permissions().readonly() => {
            Err(WriteProblem::NotWritable(io::Error::from(io::ErrorKind::PermissionDenied)))
        }
        Ok(_) => Ok(()),
    }
}

/// A new file beside `path`, removed again unless it is kept.
fn partial(path: &Path) -> Result<NamedTempFile, WriteProblem> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!(".{name}.");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".partial");
    // Temporary files are private by default; the result is to be an ordinary file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder(path)).map_err(WriteProblem::NotWritable)
}

fn check_columns(target: Target, table: &Table) -> Result<(), WriteProblem> {
    if target == Target::Obj {
        obj::check(table)?;
    }
    let mut names = std::collections::HashSet::new();
    for column in &table.columns {
        let (found, wanted) = (column.data.len(), table.rows());
        if found != wanted {
            return Err(WriteProblem::Uneven { name: column.name.clone(), found, wanted });
        }
        if !names.insert(&column.name) {
            return Err(WriteProblem::DuplicateName(column.name.clone()));
        }
        match target {
            Target::Ply => ply::check(column)?,
            Target::E57 => e57::check(column)?,
            Target::Pcd => pcd::check(column)?,
            Target::Text(_) => text::check(column)?,
            Target::Las { .. } => {}
            Target::Obj => {}
            Target::Npy | Target::Npz => npy::check(column)?,
        }
    }
    match target {
        Target::Las { .. } => las::check(table)?,
        Target::E57 => e57::check_table(table)?,
        _ => {}
    }
    Ok(())
}
