//! Variable length records: what a LAS file holds beside its points, kept byte by byte.

use std::io::{self, Read, Seek, SeekFrom, Write};

/// The user of the records that LAS itself defines.
pub(super) const SPEC: &str = "LASF_Spec";
/// The user of the records about the coordinate reference system.
pub(super) const PROJECTION: &str = "LASF_Projection";
/// The user of the records of COPC.
pub(super) const COPC: &str = "copc";

/// A record, extended (behind the points) or not.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    reserved: u16,
    user: [u8; 16],
    id: u16,
    description: [u8; 32],
    pub(super) data: Vec<u8>,
}

/// Where records are, and how many the header counts.
pub(super) struct Place {
    pub(super) start: u64,
    /// The first byte that is no longer theirs.
    pub(super) end: u64,
    pub(super) count: u64,
    pub(super) extended: bool,
}

impl Record {
    pub(super) fn new(user: &str, id: u16, description: &str, data: Vec<u8>) -> Self {
        Self { reserved: 0, user: padded(user), id, description: padded(description), data }
    }

    /// Whether this is the record `id` of `user`.
    pub(super) fn is(&self, user: &str, id: u16) -> bool {
        self.id == id && text(&self.user).eq_ignore_ascii_case(user)
    }

    pub(super) fn is_of(&self, user: &str) -> bool {
        text(&self.user).eq_ignore_ascii_case(user)
    }

    pub(super) fn id(&self) -> u16 {
        self.id
    }

    /// Reads the records of a place, as many as lie in it.
    pub(super) fn read_all(file: &mut (impl Read + Seek), place: &Place) -> io::Result<Vec<Self>> {
        let mut records = Vec::new();
        let mut at = place.start;
        // No file is so long that one could seek to any number.
        if at >= place.end {
            return Ok(records);
        }
        file.seek(SeekFrom::Start(at))?;
        let head_size = if place.extended { 60 } else { 54 };
        while (records.len() as u64) < place.count && at.saturating_add(head_size) <= place.end {
            let mut head = [0; 60];
            file.read_exact(head.get_mut(..head_size as usize).unwrap_or_default())?;
            let length = match place.extended {
                true => u64::from_le_bytes(part(&head, 20)),
                false => u64::from(u16::from_le_bytes(part(&head, 20))),
            };
            at += head_size;
            if length > place.end - at {
                break;
            }
            let mut data = Vec::new();
            file.by_ref().take(length).read_to_end(&mut data)?;
            at += length;
            records.push(Self {
                reserved: u16::from_le_bytes(part(&head, 0)),
                user: part(&head, 2),
                id: u16::from_le_bytes(part(&head, 18)),
                description: part(&head, head_size as usize - 32),
                data,
            });
        }
        Ok(records)
    }

    /// The bytes it takes in the file.
    pub(super) fn size(&self, extended: bool) -> u64 {
        self.data.len() as u64 + if extended { 60 } else { 54 }
    }

    pub(super) fn write(&self, out: &mut impl Write, extended: bool) -> io::Result<()> {
        out.write_all(&self.reserved.to_le_bytes())?;
        out.write_all(&self.user)?;
        out.write_all(&self.id.to_le_bytes())?;
        if extended {
            out.write_all(&(self.data.len() as u64).to_le_bytes())?;
        } else {
            let length = u16::try_from(self.data.len()).map_err(io::Error::other)?;
            out.write_all(&length.to_le_bytes())?;
        }
        out.write_all(&self.description)?;
        out.write_all(&self.data)
    }
}

/// `N` bytes from `at` on; zeros where there are none.
pub(super) fn part<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes.get(at..).and_then(|rest| rest.first_chunk()).copied().unwrap_or([0; N])
}

/// Text in front of the first zero byte.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(bytes.get(..end).unwrap_or_default()).trim().to_owned()
}

/// Text filled up with zero bytes.
pub(super) fn padded<const N: usize>(text: &str) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.iter_mut().zip(text.bytes()).for_each(|(to, from)| *to = from);
    bytes
}
