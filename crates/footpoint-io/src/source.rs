//! A file as a stream of bytes and lines, unpacked if it is gzipped, with its end in sight.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use flate2::bufread::MultiGzDecoder;

use crate::Watch;

const BUFFER: usize = 256 * 1024;
/// Bytes looked at before the format is decided.
const HEAD: u64 = 64 * 1024;
/// Bytes from one word to the watch to the next.
const TOLD: u64 = 1 << 20;

/// Unpacked bytes that are given for any number of packed ones.
const UNPACKED_ANYHOW: u64 = 256 << 20;
/// Unpacked bytes to a packed one beyond that. Deflate reaches 1032, with nothing but repetition; rows of
/// points stay below 20, and below 100 if nine of ten are `0 0 0`.
const UNPACKED_AT_MOST: u64 = 100;

pub(crate) struct Source<'w> {
    reader: Box<dyn BufRead + 'w>,
    /// Bytes at the front of the reader that the line lent last takes up.
    lent: usize,
    /// A line that does not lie in the reader's buffer as a whole.
    spill: Vec<u8>,
    /// Bytes not yet read; `None` if nobody knows, as in a gzipped file.
    remaining: Option<u64>,
    line: u64,
    /// Bytes of the file that have been read, unpacked or not.
    passed: Arc<AtomicU64>,
    /// Its size, if it has one.
    size: Option<u64>,
    watch: Option<&'w dyn Watch>,
    /// Unpacked bytes until the watch is told again.
    until_told: u64,
    stopped: bool,
}

impl<'w> Source<'w> {
    /// Opens `path`; the second value is its first bytes, which the source will give again.
    pub(crate) fn open(path: &Path, watch: Option<&'w dyn Watch>) -> io::Result<(Self, Vec<u8>)> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        let counted = Counted::new(file);
        let passed = Arc::clone(&counted.passed);
        let mut reader = BufReader::with_capacity(BUFFER, counted);
        let size = metadata.is_file().then_some(metadata.len());
        let mut source = if reader.fill_buf()?.starts_with(&[0x1f, 0x8b]) {
            let unpacked = Unpacked::new(MultiGzDecoder::new(reader), Arc::clone(&passed), size);
            Self::new(BufReader::with_capacity(BUFFER, unpacked), None, passed)
        } else {
            Self::new(reader, size, passed)
        };
        source.size = size;
        source.watch = watch;
        let mut head = Vec::new();
        source.reader.by_ref().take(HEAD).read_to_end(&mut head)?;
        let rest = std::mem::replace(&mut source.reader, Box::new(io::empty()));
        source.reader = Box::new(Cursor::new(head.clone()).chain(rest));
        Ok((source, head))
    }

    /// A source of `remaining` bytes, if that is known, of a file of which `passed` have been read.
    fn new(reader: impl BufRead + 'w, remaining: Option<u64>, passed: Arc<AtomicU64>) -> Self {
        Self {
            reader: Box::new(reader),
            lent: 0,
            spill: Vec::new(),
            remaining,
            line: 0,
            passed,
            size: None,
            watch: None,
            until_told: TOLD,
            stopped: false,
        }
    }

    /// A part of an archive.
    pub(crate) fn part(unpacked: Unpacked<impl Read + 'w>, watch: Option<&'w dyn Watch>) -> Self {
        let (passed, size) = (Arc::clone(&unpacked.packed), unpacked.size);
        let reader = BufReader::with_capacity(BUFFER, unpacked);
        // An archive may have any number of small parts; the watch hears of each.
        Self { size, watch, until_told: 0, ..Self::new(reader, None, passed) }
    }

    /// Bytes left in the file, if known.
    pub(crate) fn remaining(&self) -> Option<u64> {
        self.remaining
    }

    /// Whether the watch ended reading.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// The number of the line read last, from 1.
    pub(crate) fn line_number(&self) -> u64 {
        self.line
    }

    pub(crate) fn at_end(&mut self) -> io::Result<bool> {
        self.take_back();
        Ok(self.reader.fill_buf()?.is_empty())
    }

    /// Reads the next line into `line`, without its end; `false` at the end of the file.
    pub(crate) fn read_line(&mut self, end: u8, line: &mut Vec<u8>) -> io::Result<bool> {
        line.clear();
        let Some(next) = self.next_line(end)? else { return Ok(false) };
        line.extend_from_slice(next);
        Ok(true)
    }

    /// The next line without its end, not copied if it can be helped; `None` at the end of the file.
    pub(crate) fn next_line(&mut self, end: u8) -> io::Result<Option<&[u8]>> {
        self.take_back();
        if let Some(length) = memchr::memchr(end, self.reader.fill_buf()?) {
            self.passed(length + 1)?;
            self.line += 1;
            self.lent = length + 1;
            return Ok(self.reader.fill_buf()?.get(..length));
        }
        self.spill.clear();
        let read = self.reader.read_until(end, &mut self.spill)?;
        self.passed(read)?;
        if read == 0 {
            return Ok(None);
        }
        self.line += 1;
        if self.spill.last() == Some(&end) {
            self.spill.pop();
        }
        Ok(Some(&self.spill))
    }

    /// Passes over the line that was lent.
    fn take_back(&mut self) {
        self.reader.consume(self.lent);
        self.lent = 0;
    }

    /// Fills `buffer` as far as the file goes and returns the bytes read.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.take_back();
        let mut filled = 0;
        while let Some(rest) = buffer.get_mut(filled..).filter(|rest| !rest.is_empty()) {
            match self.reader.read(rest) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.passed(filled)?;
        Ok(filled)
    }

    /// Passes over `wanted` bytes, or as many as there are, and returns how many.
    pub(crate) fn skip(&mut self, wanted: u64) -> io::Result<u64> {
        self.take_back();
        let mut skipped = 0;
        while skipped < wanted {
            let available = self.reader.fill_buf()?.len();
            if available == 0 {
                break;
            }
            let step = usize::try_from(wanted - skipped).unwrap_or(usize::MAX).min(available);
            self.reader.consume(step);
            self.passed(step)?;
            skipped += step as u64;
        }
        Ok(skipped)
    }

    fn passed(&mut self, bytes: usize) -> io::Result<()> {
        let bytes = bytes as u64;
        if let Some(remaining) = &mut self.remaining {
            *remaining = remaining.saturating_sub(bytes);
        }
        let Some(watch) = self.watch else { return Ok(()) };
        if bytes < self.until_told {
            self.until_told -= bytes;
            return Ok(());
        }
        self.until_told = TOLD;
        // Of a gzipped file, what is known is how much of the packed bytes have been read.
        let done = self.passed.load(Ordering::Relaxed);
        let all = self.size.unwrap_or(done);
        // The directory of an archive is read besides its parts.
        if watch.at(done.min(all), all).is_continue() {
            return Ok(());
        }
        self.stopped = true;
        Err(io::Error::other("stopped"))
    }
}

/// A file that counts what is read of it.
pub(crate) struct Counted {
    file: File,
    passed: Arc<AtomicU64>,
}

impl Counted {
    pub(crate) fn new(file: File) -> Self {
        Self { file, passed: Arc::default() }
    }

    /// The bytes read so far, as long as the file is read.
    pub(crate) fn passed(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.passed)
    }
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.passed.fetch_add(read as u64, Ordering::Relaxed);
        Ok(read)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// What a decoder unpacks, up to what a file of points can come to: a small file must not fill the memory.
pub(crate) struct Unpacked<R> {
    decoder: R,
    packed: Arc<AtomicU64>,
    /// The size of the file; parts of an archive that are read twice count once.
    size: Option<u64>,
    unpacked: u64,
}

impl<R> Unpacked<R> {
    /// Counts what `decoder` gives against the `packed` bytes read of a file of this size.
    pub(crate) fn new(decoder: R, packed: Arc<AtomicU64>, size: Option<u64>) -> Self {
        Self { decoder, packed, size, unpacked: 0 }
    }

    /// With what other parts of the same archive have unpacked.
    pub(crate) fn after(self, unpacked: u64) -> Self {
        Self { unpacked, ..self }
    }
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.decoder.read(buffer)?;
        self.unpacked += read as u64;
        let packed = self.packed.load(Ordering::Relaxed).min(self.size.unwrap_or(u64::MAX));
        if self.unpacked > UNPACKED_ANYHOW && self.unpacked / UNPACKED_AT_MOST > packed {
            return Err(io::Error::other(format!(
                "{packed} packed bytes unpack to more than {} MiB, over {UNPACKED_AT_MOST} times as many, as no \
                 points do; if you trust the file, unpack it and read the result",
                self.unpacked >> 20
            )));
        }
        Ok(read)
    }
}
