//! Unpacking LAZ chunk by chunk through the `laz` crate, with every count checked before it is believed.
//!
//! The readers of the `las` crate are not used for this: they reserve what a chunk table or a layer claims,
//! take the records beside the points from the header's counts, and read one extended record only.

use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::Builder;

use laz::laszip::ChunkTable;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{LazItem, LazItemType, LazVlr, LazVlrBuilder};

use super::LasError;
use super::header::Head;
use super::points::{BLOCK, Points};
use super::record::part;

/// The record that says how the points are packed.
pub(super) const LASZIP: (&str, u16) = (LazVlr::USER_ID, LazVlr::RECORD_ID);
/// Unpacked bytes for each byte of the file; surveys reach 5 to 30, regular grids without attributes 2000.
const MOST_PER_BYTE: u64 = 200;
/// Unpacked bytes that are allowed whatever the size, for the sake of such grids.
const MOST_AT_LEAST: u64 = 1 << 30;

/// The name of the thread that unpacks LAZ. Its panics, which damaged files cause in the decoder, are caught and become
/// errors; a program may leave their message unsaid.
pub const UNPACKING: &str = "footpoint-unpacking";

/// Room for calls: in layers the decoder of times calls itself as often as damaged bytes say, where whole ones say so once.
const STACK: usize = 256 << 20;

/// Points packed together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk {
    pub(super) at: u64,
    pub(super) bytes: u64,
    pub(super) points: u64,
}

/// How the points of a file are packed.
pub(super) struct Packing {
    vlr: LazVlr,
    way: Way,
    record: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    /// All points in one chunk, without a table.
    Whole,
    Chunks,
    /// Chunks that keep each field apart, with the sizes of the fields in front.
    Layers,
}

impl Packing {
    pub(super) fn of(head: &Head) -> Result<Self, LasError> {
        let wrong = |what: &str| LasError::Packing(what.to_owned());
        let record = head.vlrs.iter().find(|record| record.is(LASZIP.0, LASZIP.1));
        let record = record.ok_or_else(|| wrong("the file has no record `laszip encoded`"))?;
        // A vector of items is reserved by their number, which is then at most 65,535.
        let vlr = LazVlr::from_buffer(&record.data).map_err(|error| LasError::Packing(error.to_string()))?;
        let size = head.record_size();
        let own =
            super::fields::standard(head.format, &head.header).map_or(0, |own| super::fields::size(&own));
        let extra = u16::try_from(size.saturating_sub(own)).unwrap_or(u16::MAX);
        let expected = LazVlrBuilder::default().with_point_format(head.format, extra);
        let expected = expected.map_err(|error| LasError::Packing(error.to_string()))?.build();
        let kinds = |items: &[LazItem]| -> Vec<(LazItemType, u16)> {
            items.iter().map(|item| (item.item_type(), item.size())).collect()
        };
        if kinds(vlr.items()) != kinds(expected.items()) {
            return Err(wrong("its record `laszip encoded` describes other fields than the point format"));
        }
        let layered = vlr.items().first().is_some_and(|item| item.version() > 2);
        let way = match (u16::from_le_bytes(part(&record.data, 0)), layered) {
            (1, false) => Way::Whole,
            (2, false) => Way::Chunks,
            (3, true) => Way::Layers,
            _ => return Err(wrong("its record `laszip encoded` names a way of packing that is not known")),
        };
        let most = head.size.saturating_mul(MOST_PER_BYTE).saturating_add(MOST_AT_LEAST);
        if head.points.saturating_mul(size as u64) > most {
            return Err(LasError::TooMany { points: head.points, size: head.size });
        }
        Ok(Self { vlr, way, record: size })
    }

    /// All chunks in the order of the points.
    pub(super) fn chunks(&self, file: &mut (impl Read + Seek), head: &Head) -> Result<Vec<Chunk>, LasError> {
        let start = head.start();
        if head.points == 0 {
            return Ok(Vec::new());
        }
        if self.way == Way::Whole {
            return Ok(vec![Chunk {
                at: start,
                bytes: head.size.saturating_sub(start),
                points: head.points,
            }]);
        }
        let table = self.table(file, head)?;
        let at = table_place(file, head)?;
        let broken = |what: String| LasError::ChunkTable { at, what };
        let mut chunks = Vec::new();
        let (mut offset, mut left) = (start + 8, head.points);
        for entry in table.as_ref() {
            let points = entry.point_count.min(left);
            let end = offset.checked_add(entry.byte_count).filter(|&end| end <= head.size);
            let end =
                end.ok_or_else(|| broken(format!("has chunks of more than the file's {} bytes", head.size)))?;
            if points > 0 {
                chunks.push(Chunk { at: offset, bytes: entry.byte_count, points });
            }
            (offset, left) = (end, left - points);
        }
        if left > 0 {
            return Err(broken(format!("holds {} of {} points", head.points - left, head.points)));
        }
        Ok(chunks)
    }

    fn table(&self, file: &mut (impl Read + Seek), head: &Head) -> Result<ChunkTable, LasError> {
        let at = table_place(file, head)?;
        let broken = |what: String| LasError::ChunkTable { at, what };
        file.seek(SeekFrom::Start(at))?;
        let mut start = [0; 8];
        file.read_exact(&mut start).map_err(|_| broken("is cut".to_owned()))?;
        // Each chunk but an empty last one has its first point unpacked.
        let count = u64::from(u32::from_le_bytes(part(&start, 4)));
        if count > head.size / self.record.max(1) as u64 + 1 {
            return Err(broken(format!("counts {count} chunks, which the file cannot hold")));
        }
        file.seek(SeekFrom::Start(head.start()))?;
        let read = guarded(|| ChunkTable::read_from(BufReader::new(file), &self.vlr));
        read?.map_err(|error| broken(format!("cannot be read ({error})")))
    }

    /// Unpacks chunks one after the other.
    pub(super) fn unpack(
        &self,
        file: &mut (impl Read + Seek + Send),
        chunks: &[Chunk],
        points: &mut Points<'_>,
    ) -> Result<(), LasError> {
        std::thread::scope(|scope| {
            let work = || self.unpack_here(file, chunks, points);
            let worker =
                Builder::new().name(UNPACKING.to_owned()).stack_size(STACK).spawn_scoped(scope, work)?;
            worker.join().unwrap_or_else(|_| Err(LasError::Packing("the decoder gave up".to_owned())))
        })
    }

    fn unpack_here(
        &self,
        file: &mut (impl Read + Seek),
        chunks: &[Chunk],
        points: &mut Points<'_>,
    ) -> Result<(), LasError> {
        let mut packed = Vec::new();
        let mut first = 1;
        for chunk in chunks {
            file.seek(SeekFrom::Start(chunk.at))?;
            packed.clear();
            file.by_ref().take(chunk.bytes).read_to_end(&mut packed)?;
            self.unpack_chunk(&packed, chunk, points).map_err(|stop| match stop {
                Stop::Error(error) => error,
                Stop::Broken(what) => LasError::Chunk { first, at: chunk.at, what },
            })?;
            first += chunk.points;
        }
        Ok(())
    }

    fn unpack_chunk(&self, packed: &[u8], chunk: &Chunk, points: &mut Points<'_>) -> Result<(), Stop> {
        if self.way == Way::Layers {
            self.check_layers(packed)?;
        }
        let source = Cursor::new(packed);
        let mut records: Box<dyn RecordDecompressor<Cursor<&[u8]>>> = match self.way {
            Way::Layers => Box::new(LayeredPointRecordDecompressor::new(source)),
            Way::Whole | Way::Chunks => Box::new(SequentialPointRecordDecompressor::new(source)),
        };
        records.set_fields_from(self.vlr.items()).map_err(|error| Stop::Broken(error.to_string()))?;
        let mut block = Vec::new();
        let mut left = chunk.points;
        while left > 0 {
            let now = left.min(BLOCK as u64);
            block.resize(now as usize * self.record, 0);
            guarded(|| records.decompress_many(&mut block))?
                .map_err(|error| Stop::Broken(format!("{error}")))?;
            points.take(&mut block)?;
            left -= now;
        }
        Ok(())
    }

    /// Checks that the layers of a chunk are no longer than the chunk: the decoder makes room by their sizes.
    fn check_layers(&self, packed: &[u8]) -> Result<(), Stop> {
        let layers = self.vlr.items().iter().map(|item| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(count) => usize::from(count),
            _ => 1,
        });
        let layers: usize = layers.sum();
        let sizes = packed.get(self.record + 4..).and_then(|rest| rest.get(..4 * layers));
        let sizes = sizes.ok_or_else(|| Stop::Broken("the chunk is shorter than its head".to_owned()))?;
        let wanted: u64 =
            sizes.chunks_exact(4).map(|size| u64::from(u32::from_le_bytes(part(size, 0)))).sum();
        let found = (packed.len() - self.record - 4 - 4 * layers) as u64;
        match wanted > found {
            true => Err(Stop::Broken(format!("its fields want {wanted} bytes, the chunk has {found}"))),
            false => Ok(()),
        }
    }
}

/// Where the table of chunks is: the first number of the points says so, or, where the writer could not go
/// back, the last of the file.
fn table_place(file: &mut (impl Read + Seek), head: &Head) -> Result<u64, LasError> {
    let start = head.start();
    let missing = |at: u64| LasError::ChunkTable { at, what: "lies beyond the end of the file".to_owned() };
    let mut place = [0; 8];
    for from in [start, head.size.saturating_sub(8)] {
        if from.checked_add(8).is_none_or(|end| end > head.size) {
            return Err(missing(from));
        }
        file.seek(SeekFrom::Start(from))?;
        file.read_exact(&mut place)?;
        let at = i64::from_le_bytes(place);
        if let Ok(at) = u64::try_from(at)
            && at > start
        {
            return if at.checked_add(8).is_some_and(|end| end <= head.size) {
                Ok(at)
            } else {
                Err(missing(at))
            };
        }
    }
    Err(missing(head.size))
}

/// Why a chunk is not unpacked.
enum Stop {
    Error(LasError),
    Broken(String),
}

impl From<LasError> for Stop {
    fn from(error: LasError) -> Self {
        Self::Error(error)
    }
}

impl From<Panicked> for Stop {
    fn from(_: Panicked) -> Self {
        Self::Broken("the decoder ran into values that cannot be".to_owned())
    }
}

impl From<Panicked> for LasError {
    fn from(_: Panicked) -> Self {
        Self::Packing("the table of chunks holds values that cannot be".to_owned())
    }
}

struct Panicked;

/// Runs the decoder of `laz`, which indexes its models by what it decodes and divides by its interval: on
/// broken bytes both panic, and no look at the bytes beforehand can tell. It is dropped afterwards.
fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, Panicked> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| Panicked)
}
