//! Fuzz targets for readers: good files damaged in ways that generators and fuzzers find.
//!
//! A target is a test that ends in `check!().with_type::<Damage>().for_each(|d| target.survives(d))` on a
//! [`Target`] of a few small good files, one for each branch of the reader; `fuzz_numpy.rs` is an example. The
//! files go through the file system, as readers seek and look at names. What is done to them comes from the
//! generator alone, so that a fuzzer that sees coverage can steer it, and a seed gives the same again.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use bolero::TypeGenerator;
use footpoint_io::{Bounds, Column, Data, Overwrite, ReadOptions, Table, WriteOptions, read_with, write};
use tempfile::TempDir;

/// No damaged small file may take longer.
const LONGEST: Duration = Duration::from_secs(5);

/// What is done to one of the good files.
#[derive(Debug, Clone, TypeGenerator)]
pub(crate) struct Damage {
    file: u8,
    /// Whether only the first edit is made: of many, one as a rule is such that no other is ever seen.
    is_single: bool,
    /// Whether what stands before the points stays whole.
    is_behind: bool,
    edits: Vec<Edit>,
}

#[derive(Debug, Clone, TypeGenerator)]
enum Edit {
    Set(Place, u8),
    Flip(Place, u8),
    Insert(Place, Vec<u8>),
    Remove(Place, u8),
    Repeat(Place, u8),
    Cut(Place),
    /// Puts one of `WORDS` in the place of a word.
    Word(Place, u8),
    /// Puts one of `WORDS` in the place of the next written number.
    Number(Place, u8),
    /// Overwrites bytes by a number that claims much.
    Claim(Place, u8),
}

/// A place in a file: half of them near the start, where headers are.
#[derive(Debug, Clone, Copy, TypeGenerator)]
struct Place {
    near: bool,
    at: u16,
}

const WORDS: [&str; 16] = [
    "0",
    "-1",
    "1",
    "7",
    "255",
    "65536",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1e308",
    "-0.5",
    "nan",
    "inf",
    "x",
    "",
];

/// Good files of one format or a few, and a place for a damaged one.
pub(crate) struct Target {
    files: Vec<(String, Vec<u8>)>,
    folder: TempDir,
    /// What is done to a damaged file, given the good one, so that the damage gets past checksums.
    seal: Option<Seal>,
    /// Where the points of a file start.
    body: Option<fn(&[u8]) -> usize>,
    within: Option<Bounds>,
}

type Seal = fn(&[u8], Vec<u8>) -> Vec<u8>;

impl Target {
    pub(crate) fn new() -> Self {
        Self { files: Vec::new(), folder: tempfile::tempdir().unwrap(), seal: None, body: None, within: None }
    }

    /// Its files are damaged as they are given and brought into their final form afterwards.
    #[allow(dead_code, reason = "few formats have checksums")]
    pub(crate) fn sealed(self, seal: Seal) -> Self {
        Self { seal: Some(seal), ..self }
    }

    /// Half of the damage is done behind this place of a file, so that it gets past a header.
    #[allow(dead_code, reason = "not all formats have a header that is easily broken")]
    pub(crate) fn behind(self, body: fn(&[u8]) -> usize) -> Self {
        Self { body: Some(body), ..self }
    }

    /// Only a box of its files is read.
    #[allow(dead_code, reason = "one format has an octree")]
    pub(crate) fn within(self, within: Bounds) -> Self {
        Self { within: Some(within), ..self }
    }

    /// With a file of this name and content.
    pub(crate) fn file(mut self, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        self.files.push((name.to_owned(), bytes.as_ref().to_vec()));
        self
    }

    /// With a file as we write it.
    pub(crate) fn written(self, name: &str, table: &Table, options: &WriteOptions) -> Self {
        let path = self.folder.path().join(name);
        write(&path, table, &WriteOptions { overwrite: Overwrite::Replace, ..*options }).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        self.file(name, bytes)
    }

    /// Reads a damaged file: any result will do that comes soon, with columns of one length and no more room
    /// than the bytes account for. The files themselves must be good.
    pub(crate) fn survives(&self, damage: &Damage) {
        let (name, good) = &self.files[usize::from(damage.file) % self.files.len()];
        let start = self.body.filter(|_| damage.is_behind).map_or(0, |body| body(good));
        let (head, body) = good.split_at(start);
        let mut body = body.to_vec();
        let most = if damage.is_single { 1 } else { 8 };
        damage.edits.iter().take(most).for_each(|edit| edit.apply(&mut body));
        let mut bytes = [head, &body].concat();
        if let Some(seal) = self.seal {
            bytes = seal(good, bytes);
        }
        let path: PathBuf = self.folder.path().join(name);
        std::fs::write(&path, &bytes).unwrap();
        let start = Instant::now();
        let read = read_with(&path, &ReadOptions { within: self.within, watch: None });
        assert!(start.elapsed() < LONGEST, "reading took {:?}", start.elapsed());
        match read {
            Ok(input) => check(&input.table, bytes.len()),
            Err(error) => assert!(!damage.edits.is_empty(), "{error}"),
        }
    }
}

fn check(table: &Table, bytes: usize) {
    let rows = table.rows();
    // Deflate packs a thousand bytes into one.
    assert!(rows <= 1100 * bytes, "{rows} rows from {bytes} bytes");
    for Column { name, data } in &table.columns {
        assert_eq!(data.len(), rows, "{name}");
        let room = match data {
            Data::F64(values) => values.capacity(),
            Data::F32(values) => values.capacity(),
            Data::U8(values) => values.capacity(),
            _ => 0,
        };
        assert!(
            room <= 2 * rows.max(8 * bytes).max(1 << 16),
            "{name}: room for {room} of {rows} rows from {bytes} bytes"
        );
    }
}

impl Place {
    fn within(self, length: usize) -> usize {
        let reach = if self.near { length.min(512) } else { length };
        (usize::from(self.at) * reach) >> 16
    }
}

impl Edit {
    fn apply(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Set(place, byte) => {
                let at = place.within(bytes.len());
                bytes.iter_mut().skip(at).take(1).for_each(|b| *b = *byte);
            }
            Self::Flip(place, bit) => {
                let at = place.within(bytes.len());
                bytes.iter_mut().skip(at).take(1).for_each(|b| *b ^= 1 << (bit % 8));
            }
            Self::Insert(place, new) => {
                let at = place.within(bytes.len());
                bytes.splice(at..at, new.iter().copied());
            }
            Self::Remove(place, length) => {
                let at = place.within(bytes.len());
                bytes.drain(at..bytes.len().min(at + usize::from(*length)));
            }
            Self::Repeat(place, length) => {
                let at = place.within(bytes.len());
                let part = bytes[at..bytes.len().min(at + usize::from(*length))].to_vec();
                bytes.splice(at..at, part);
            }
            Self::Cut(place) => bytes.truncate(place.within(bytes.len())),
            Self::Word(place, word) => {
                let at = place.within(bytes.len());
                let blank = |b: &u8| b.is_ascii_whitespace() || b",()[]:\"<>".contains(b);
                let start = bytes[..at].iter().rposition(blank).map_or(0, |i| i + 1);
                let end = bytes[at..].iter().position(blank).map_or(bytes.len(), |i| at + i);
                bytes.splice(start..end.max(start), WORDS[usize::from(*word) % WORDS.len()].bytes());
            }
            Self::Number(place, word) => {
                let at = place.within(bytes.len());
                let is_start = |b: &u8| b.is_ascii_digit() || *b == b'-';
                let Some(start) = bytes[at..].iter().position(is_start).map(|i| at + i) else { return };
                let is_other = |b: &u8| !b.is_ascii_digit() && !b"-+.e".contains(b);
                let end = bytes[start..].iter().position(is_other).map_or(bytes.len(), |i| start + i);
                bytes.splice(start..end, WORDS[usize::from(*word) % WORDS.len()].bytes());
            }
            Self::Claim(place, kind) => {
                let claims: [&[u8]; 6] =
                    [&[0xff; 2], &[0xff; 4], &[0xff; 8], &[0xff, 0xff, 0xff, 0x7f], &[0; 4], &[0; 8]];
                let at = place.within(bytes.len());
                let claim = claims[usize::from(*kind) % claims.len()];
                bytes.iter_mut().skip(at).zip(claim).for_each(|(byte, new)| *byte = *new);
            }
        }
    }
}
