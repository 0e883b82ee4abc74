//! The bytes of an E57 file, with a watch on how far reading has come and a bound on how far it may run ahead.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::rc::Rc;

use crate::Watch;

/// Bytes from one word to the watch to the next.
const TOLD: u64 = 1 << 20;
const BUFFER: usize = 256 * 1024;

pub(super) struct Tracked<'w> {
    reader: BufReader<File>,
    at: u64,
    size: u64,
    until_told: u64,
    watch: Option<&'w dyn Watch>,
    limits: Rc<Limits>,
}

/// What the reader of points and the file below it tell each other.
#[derive(Default)]
pub(super) struct Limits {
    /// Bytes read so far.
    pub(super) read: Cell<u64>,
    /// Bytes that may be read in all. The crate unpacks every attribute as far as its bytes go, and waits for the
    /// slowest: without a bound, a file could have it hold one attribute of all points unpacked.
    pub(super) allowed: Cell<u64>,
    /// Whether the watch ended reading.
    pub(super) stopped: Cell<bool>,
}

impl<'w> Tracked<'w> {
    pub(super) fn new(file: File, size: u64, watch: Option<&'w dyn Watch>) -> (Self, Rc<Limits>) {
        let limits = Rc::new(Limits { allowed: Cell::new(u64::MAX), ..Limits::default() });
        let reader = BufReader::with_capacity(BUFFER, file);
        (Self { reader, at: 0, size, until_told: TOLD, watch, limits: Rc::clone(&limits) }, limits)
    }
}

impl Read for Tracked<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let limits = &self.limits;
        if limits.read.get() > limits.allowed.get() {
            return Err(io::Error::other("its attributes hold different numbers of points"));
        }
        let read = self.reader.read(buffer)?;
        self.at += read as u64;
        limits.read.set(limits.read.get() + read as u64);
        self.until_told = self.until_told.saturating_sub(read as u64);
        if let Some(watch) = self.watch.filter(|_| self.until_told == 0) {
            self.until_told = TOLD;
            if watch.at(self.at, self.size).is_break() {
                limits.stopped.set(true);
                return Err(io::Error::other("stopped"));
            }
        }
        Ok(read)
    }
}

impl Seek for Tracked<'_> {
    /// Within the buffer nothing is read anew: the crate seeks before every page of 1,024 bytes.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Start(to) => {
                let step = i128::from(to) - i128::from(self.at);
                match i64::try_from(step) {
                    Ok(step) => self.reader.seek_relative(step)?,
                    Err(_) => drop(self.reader.seek(SeekFrom::Start(to))?),
                }
                self.at = to;
            }
            other => self.at = self.reader.seek(other)?,
        }
        Ok(self.at)
    }
}
