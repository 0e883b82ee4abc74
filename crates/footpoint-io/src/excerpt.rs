//! Pieces of a file inside error messages.

const LENGTH: usize = 60;

/// At most 60 characters of `bytes`, none of them able to disturb a terminal.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    // No character has more than four bytes; a "line" of a broken file may be the whole file.
    let start = bytes.get(..4 * LENGTH).unwrap_or(bytes);
    let shown = |c: char| if c.is_control() { '?' } else { c };
    String::from_utf8_lossy(start).chars().map(shown).take(LENGTH).collect()
}
