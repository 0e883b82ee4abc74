//! File formats: what there is, and which one a file name asks for.

use std::path::Path;

use crate::PcdEncoding;

/// The format of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Stanford PLY.
    Ply(Encoding),
    /// ASTM E57.
    E57,
    /// PCD of the point cloud library.
    Pcd(PcdEncoding),
    /// Rows of separated fields, with or without a header.
    Text,
    /// ASPRS LAS.
    Las,
    /// LAS with packed points.
    Laz,
    /// LAZ sorted into an octree.
    Copc,
    /// Wavefront OBJ.
    Obj,
    /// Leica PTX: text of gridded scans.
    Ptx,
    /// One NumPy array.
    Npy,
    /// An archive of NumPy arrays.
    Npz,
}

/// How a PLY file stores its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// As decimal text, one row a line.
    Ascii,
    /// Binary, least significant byte first.
    #[default]
    LittleEndian,
    /// Binary, most significant byte first.
    BigEndian,
}

/// The kinds of text files, told apart by extension: they differ in header and in unnamed columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TextKind {
    /// `csv`: comma, plain header.
    Csv,
    /// `txt` and unknown extensions: blank, plain header.
    Txt,
    /// `xyz`, `pwn`: blank, header in a comment.
    Xyz,
    /// `xy`: as `xyz`, but two coordinates.
    Xy,
    /// `pts`: blank, a line with the number of points, no header.
    Pts,
}

/// Extensions that can be written, for error messages.
pub(crate) const WRITABLE: &str = "ply las laz e57 pcd xyz csv txt pts pwn xy obj npy npz";

/// What [`write`](crate::write) makes of a file name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    Ply,
    E57,
    Pcd,
    Text(TextKind),
    Las { is_packed: bool },
    Obj,
    Npy,
    Npz,
}

impl Target {
    pub(crate) fn from_path(path: &Path) -> Option<Self> {
        let extension = extension(path);
        Some(match extension.as_str() {
            "ply" => Self::Ply,
            "las" | "laz" => Self::Las { is_packed: extension == "laz" },
            "e57" => Self::E57,
            "pcd" => Self::Pcd,
            "obj" => Self::Obj,
            "npy" => Self::Npy,
            "npz" => Self::Npz,
            other => Self::Text(TextKind::from_extension(other)?),
        })
    }
}

impl TextKind {
    pub(crate) fn from_extension(extension: &str) -> Option<Self> {
        Some(match extension {
            "csv" => Self::Csv,
            "txt" => Self::Txt,
            "xyz" | "pwn" => Self::Xyz,
            "xy" => Self::Xy,
            "pts" => Self::Pts,
            _ => return None,
        })
    }
}

/// The extension in lower case, without the dot; empty if there is none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Whether a file name ends as those of COPC files do.
pub(crate) fn is_copc(path: &Path) -> bool {
    path.file_stem().is_some_and(|stem| extension(Path::new(stem)) == "copc")
}

/// The extension below a final `.gz`.
pub(crate) fn extension_inside(path: &Path) -> String {
    let outer = extension(path);
    if outer == "gz" {
        path.file_stem().map(|stem| extension(Path::new(stem))).unwrap_or_default()
    } else {
        outer
    }
}
