//! File formats: what there is, and which one a file name asks for.

use std::path::Path;

/// The format of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Stanford PLY.
    Ply(Encoding),
    /// Rows of separated fields, with or without a header.
    Text,
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
pub(crate) const WRITABLE: &str = "ply xyz csv txt pts pwn xy obj npy npz";

/// What [`write`](crate::write) makes of a file name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    Ply,
    Text(TextKind),
    Obj,
    Npy,
    Npz,
}

impl Target {
    pub(crate) fn from_path(path: &Path) -> Option<Self> {
        let extension = extension(path);
        Some(match extension.as_str() {
            "ply" => Self::Ply,
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

/// The extension below a final `.gz`.
pub(crate) fn extension_inside(path: &Path) -> String {
    let outer = extension(path);
    if outer == "gz" {
        path.file_stem().map(|stem| extension(Path::new(stem))).unwrap_or_default()
    } else {
        outer
    }
}

/// The name of a known format that is not read, by extension or by the first bytes.
pub(crate) fn unsupported(extension: &str, head: &[u8]) -> Option<&'static str> {
    if head.starts_with(b"LASF") {
        return Some("LAS/LAZ");
    }
    if head.starts_with(b"ASTM-E57") {
        return Some("E57");
    }
    if head.starts_with(b"# .PCD") {
        return Some("PCD");
    }
    match extension {
        "las" | "laz" => Some("LAS/LAZ"),
        "e57" => Some("E57"),
        "pcd" => Some("PCD"),
        _ => None,
    }
}
