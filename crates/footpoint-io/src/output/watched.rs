//! A file under way, whose writing someone may end.

use crate::Watch;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// The file, and who is asked before every block whether to go on.
pub(super) struct Watched<'w> {
    file: &'w mut File,
    watch: Option<&'w dyn Watch>,
    written: u64,
}

impl<'w> Watched<'w> {
    pub(super) fn new(file: &'w mut File, watch: Option<&'w dyn Watch>) -> Self {
        Self { file, watch, written: 0 }
    }
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.watch.is_some_and(|watch| watch.at(self.written, self.written).is_break()) {
            return Err(io::Error::other("writing was stopped"));
        }
        let count = self.file.write(bytes)?;
        self.written += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Read for Watched<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
