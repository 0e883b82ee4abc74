//! The compression of PCD files, LZF: runs of new bytes, and repeats of bytes at most 8,192 back.
//!
//! Own code, as the crate `lzf` calls itself deprecated and `pcd-rs` keeps its own to itself. Format: `lzf_d.c` of
//! LibLZF 3.6.

/// A repeat of this many bytes takes three bytes: no more can come of any block.
const LONGEST: usize = 264;
const FURTHEST: usize = 1 << 13;
const LONGEST_RUN: usize = 32;
const HASH_BITS: u32 = 16;

/// Whether `packed` bytes can unpack to as many as `unpacked`.
pub(super) fn is_possible(packed: u64, unpacked: u64) -> bool {
    unpacked <= packed.saturating_mul(LONGEST as u64 / 3)
}

/// Unpacks a block that must give exactly `size` bytes; `None` if it is damaged.
pub(super) fn unpack(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(size);
    let mut bytes = packed;
    while let Some((&control, rest)) = bytes.split_first() {
        bytes = rest;
        let control = usize::from(control);
        if control < LONGEST_RUN {
            let (run, rest) = bytes.split_at_checked(control + 1)?;
            out.extend_from_slice(run);
            bytes = rest;
        } else {
            let mut length = (control >> 5) + 2;
            if length == 9 {
                let (&more, rest) = bytes.split_first()?;
                length += usize::from(more);
                bytes = rest;
            }
            let (&low, rest) = bytes.split_first()?;
            bytes = rest;
            let distance = ((control & 31) << 8 | usize::from(low)) + 1;
            let start = out.len().checked_sub(distance)?;
            // A repeat may run into the bytes it makes.
            let source = start..(start + length).min(out.len());
            let period = source.len();
            for _ in 0..length / period {
                out.extend_from_within(source.clone());
            }
            out.extend_from_within(start..start + length % period);
        }
        if out.len() > size {
            return None;
        }
    }
    (out.len() == size).then_some(out)
}

/// Packs a block; the result may be longer by one byte in 32.
pub(super) fn pack(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len() / 2);
    let mut last_seen = vec![usize::MAX; 1 << HASH_BITS];
    let (mut at, mut run_start) = (0, 0);
    while let Some(&key) = bytes.get(at..).and_then(|rest| rest.first_chunk::<3>()) {
        let seen = last_seen.get_mut(hash(key)).map(|place| std::mem::replace(place, at));
        let repeat = seen.filter(|&start| start < at && at - start <= FURTHEST);
        let length = repeat.map_or(0, |start| common_length(bytes, start, at));
        let (Some(start), true) = (repeat, length >= 3) else {
            at += 1;
            continue;
        };
        put_run(&mut out, bytes.get(run_start..at).unwrap_or_default());
        let distance = at - start - 1;
        let high = (distance >> 8) as u8;
        match length - 2 {
            short @ ..7 => out.push((short as u8) << 5 | high),
            long => out.extend([7 << 5 | high, (long - 7) as u8]),
        }
        out.push(distance as u8);
        at += length;
        run_start = at;
    }
    put_run(&mut out, bytes.get(run_start..).unwrap_or_default());
    out
}

fn hash([a, b, c]: [u8; 3]) -> usize {
    let key = u32::from_le_bytes([a, b, c, 0]);
    (key.wrapping_mul(0x9E37_79B1) >> (32 - HASH_BITS)) as usize
}

/// How many bytes from `start` on are those from `at` on.
fn common_length(bytes: &[u8], start: usize, at: usize) -> usize {
    let (old, new) = (bytes.get(start..).unwrap_or_default(), bytes.get(at..).unwrap_or_default());
    old.iter().zip(new).take(LONGEST).take_while(|(a, b)| a == b).count()
}

fn put_run(out: &mut Vec<u8>, bytes: &[u8]) {
    for run in bytes.chunks(LONGEST_RUN) {
        out.push((run.len() - 1) as u8);
        out.extend_from_slice(run);
    }
}
