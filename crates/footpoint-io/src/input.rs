//! Reading a file of any supported format.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::format::{TextKind, extension_inside};
use crate::roles::{Roles, RolesError};
use crate::source::Source;
use crate::{
    Bounds, E57Error, Format, LasError, NpyError, ObjError, PcdError, PlyError, PtxError, ReadOptions, Table,
    TextError,
};
use crate::{e57, las, npy, obj, pcd, ply, ptx, text};

/// A file that has been read.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// The points.
    pub table: Table,
    /// The format found in the file, whatever its name says.
    pub format: Format,
    /// What was passed over or guessed.
    pub report: ReadReport,
}

/// What a table does not show of its file; nothing is passed over without a word here.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReadReport {
    /// PLY elements other than `vertex`, in the file's order.
    pub other_elements: Vec<OtherElement>,
    /// List properties of the element `vertex`, which a table cannot hold.
    pub skipped_lists: Vec<String>,
    /// The number of points that the file states, where that is not what bounds the reading: LAS, PCD, PTS. It has another
    /// number of rows where it is damaged.
    pub stated_rows: Option<u64>,
    /// Guesses and doubts, each one sentence for the user.
    pub notes: Vec<String>,
}

/// A PLY element that was not kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OtherElement {
    /// Its name, such as `face`.
    pub name: String,
    /// The number of rows its header line states.
    pub rows: u64,
}

/// Why a file cannot be read, with its path.
#[derive(Debug, Error)]
#[error("{}: {problem}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: Box<ReadProblem>,
}

/// What is wrong with a file that cannot be read.
#[derive(Debug, Error)]
pub enum ReadProblem {
    /// The operating system or the gzip decoder failed.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// The path names a folder.
    #[error("is a folder; name a file")]
    Folder,
    /// There is no byte in it.
    #[error("is empty; a point file is expected")]
    Empty,
    /// The name says PLY, the first line does not.
    #[error("line 1: not a PLY file, its first line is not `ply`; if it is text, rename it to .txt or .xyz")]
    NotPly,
    /// A PLY file that breaks its own rules.
    #[error("{0}")]
    Ply(#[from] PlyError),
    /// A LAS, LAZ or COPC file that breaks its own rules.
    #[error("{0}")]
    Las(LasError),
    /// An E57 file that breaks its own rules.
    #[error("{0}")]
    E57(#[from] E57Error),
    /// A PCD file that breaks its own rules.
    #[error("{0}")]
    Pcd(#[from] PcdError),
    /// Its points have no coordinates to choose by.
    #[error("{0}")]
    Roles(#[from] RolesError),
    /// The watch ended reading.
    #[error("reading was stopped")]
    Stopped,
    /// A text file without a clear table.
    #[error("{0}")]
    Text(#[from] TextError),
    /// An OBJ file that breaks its own rules.
    #[error("{0}")]
    Obj(#[from] ObjError),
    /// A PTX file that breaks its own rules.
    #[error("{0}")]
    Ptx(#[from] PtxError),
    /// A NumPy file that is broken or holds no rows.
    #[error("{0}")]
    Npy(#[from] NpyError),
}

/// Reads the point file `path`: PLY, LAS, LAZ, COPC, E57, PCD, NumPy, PTX and OBJ by their first bytes, text by its
/// extension or its content; all but LAS, E57 and `.npz` also gzipped.
///
/// All rows and columns come in the file's order and types; numbers of text files come as `F64`, as do values
/// that LAS stores with a scale.
/// Fails, with path and place, on a file that cannot be opened, is cut short, contradicts itself, or is of
/// a format not supported. Never reserves more memory than the file's bytes can fill.
pub fn read(path: &Path) -> Result<Input, ReadError> {
    read_with(path, &ReadOptions::default())
}

/// [`read`] of a part, or with someone to tell how far it has come.
pub fn read_with(path: &Path, options: &ReadOptions<'_>) -> Result<Input, ReadError> {
    let read = read_any(path, options).and_then(|mut input| match options.within {
        Some(bounds) => keep_within(&mut input, &bounds).map(|()| input),
        None => Ok(input),
    });
    read.map_err(|problem| ReadError { path: path.to_owned(), problem: Box::new(problem) })
}

/// Leaves out the points outside a box.
fn keep_within(input: &mut Input, bounds: &Bounds) -> Result<(), ReadProblem> {
    let table = &mut input.table;
    let roles = Roles::find(table)?;
    let inside: Vec<bool> = match roles.points::<3>(table) {
        Some(points) => points.into_iter().map(|p| bounds.contains(p)).collect(),
        None => {
            let flat = roles.points::<2>(table).unwrap_or_default();
            // A box of points in the plane has any height.
            flat.into_iter().map(|[x, y]| bounds.contains([x, y, bounds.low[2]])).collect()
        }
    };
    table.columns.iter_mut().for_each(|column| column.data.keep(&inside));
    // What is outside is not missing.
    let outside = inside.iter().filter(|inside| !**inside).count() as u64;
    input.report.stated_rows = input.report.stated_rows.map(|stated| stated.saturating_sub(outside));
    Ok(())
}

fn read_any(path: &Path, options: &ReadOptions<'_>) -> Result<Input, ReadProblem> {
    if path.is_dir() {
        return Err(ReadProblem::Folder);
    }
    let (mut source, head) = Source::open(path, options.watch)?;
    if head.is_empty() {
        return Err(ReadProblem::Empty);
    }
    if ply::is_ply(&head) {
        let read = ply::read(&mut source, &head);
        let (table, encoding, report) = unless_stopped(&source, read)?;
        return Ok(Input { table, format: Format::Ply(encoding), report });
    }
    let extension = extension_inside(path);
    if las::is_las(&head, &extension) {
        return las::read(path, options);
    }
    if e57::is_e57(&head) || extension == "e57" {
        let (table, report) = e57::read(path, options.watch)?;
        return Ok(Input { table, format: Format::E57, report });
    }
    if pcd::is_pcd(&head) || extension == "pcd" {
        let read = pcd::read(&mut source);
        let (table, encoding, report) = unless_stopped(&source, read)?;
        return Ok(Input { table, format: Format::Pcd(encoding), report });
    }
    if npy::is_npy(&head) {
        let read = npy::read(&mut source);
        let (table, report) = unless_stopped(&source, read)?;
        return Ok(Input { table, format: Format::Npy, report });
    }
    if npy::is_npz(&head) {
        let (table, report) = npy::read_archive(path, options.watch)?;
        return Ok(Input { table, format: Format::Npz, report });
    }
    if extension == "ptx" || ptx::is_ptx(&head) {
        let read = ptx::read(&mut source);
        let (table, report) = unless_stopped(&source, read)?;
        return Ok(Input { table, format: Format::Ptx, report });
    }
    if extension == "obj" || obj::is_obj(&head) {
        let read = obj::read(&mut source, &head);
        let (table, report) = unless_stopped(&source, read)?;
        return Ok(Input { table, format: Format::Obj, report });
    }
    if extension == "ply" {
        return Err(ReadProblem::NotPly);
    }
    let kind = TextKind::from_extension(&extension).unwrap_or(TextKind::Txt);
    let read = text::read(&mut source, &head, kind);
    let (table, report) = unless_stopped(&source, read)?;
    Ok(Input { table, format: Format::Text, report })
}

fn unless_stopped<T, E: Into<ReadProblem>>(
    source: &Source<'_>,
    read: Result<T, E>,
) -> Result<T, ReadProblem> {
    if source.is_stopped() { Err(ReadProblem::Stopped) } else { read.map_err(E::into) }
}
