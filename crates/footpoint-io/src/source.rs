//! A file as a stream of bytes and lines, unpacked if it is gzipped, with its end in sight.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
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

pub(crate) struct Source<'w> {
    reader: Box<dyn BufRead>,
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
        let passed = Arc::new(AtomicU64::new(0));
        let counted = Counted { file, passed: Arc::clone(&passed) };
        let mut reader = BufReader::with_capacity(BUFFER, counted);
        let size = metadata.is_file().then_some(metadata.len());
        if reader.fill_buf()?.starts_with(&[0x1f, 0x8b]) {
            let unpacked = BufReader::with_capacity(BUFFER, MultiGzDecoder::new(reader));
            Self::with_head(unpacked, None, (passed, size, watch))
        } else {
            Self::with_head(reader, size, (passed, size, watch))
        }
    }

    fn with_head(
        mut reader: impl BufRead + 'static,
        remaining: Option<u64>,
        (passed, size, watch): (Arc<AtomicU64>, Option<u64>, Option<&'w dyn Watch>),
    ) -> io::Result<(Self, Vec<u8>)> {
        let mut head = Vec::new();
        reader.by_ref().take(HEAD).read_to_end(&mut head)?;
        let reader = Box::new(Cursor::new(head.clone()).chain(reader));
        Ok((Self { reader, remaining, line: 0, passed, size, watch, until_told: TOLD, stopped: false }, head))
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
        Ok(self.reader.fill_buf()?.is_empty())
    }

    /// Reads the next line into `line`, without its end; `false` at the end of the file.
    pub(crate) fn read_line(&mut self, end: u8, line: &mut Vec<u8>) -> io::Result<bool> {
        line.clear();
        let read = self.reader.read_until(end, line)?;
        self.passed(read)?;
        if read == 0 {
            return Ok(false);
        }
        self.line += 1;
        if line.last() == Some(&end) {
            line.pop();
        }
        Ok(true)
    }

    /// Fills `buffer` as far as the file goes and returns the bytes read.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
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
        if watch.at(done, self.size.unwrap_or(done)).is_continue() {
            return Ok(());
        }
        self.stopped = true;
        Err(io::Error::other("stopped"))
    }
}

/// A file that counts what is read of it.
struct Counted {
    file: File,
    passed: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.passed.fetch_add(read as u64, Ordering::Relaxed);
        Ok(read)
    }
}
