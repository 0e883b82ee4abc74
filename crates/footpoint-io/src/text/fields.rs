//! One line of text taken apart into fields.

/// The fields of a line, as places in it; kept from line to line to spare allocations.
#[derive(Default)]
pub(super) struct Row {
    fields: Vec<Field>,
    /// Commas and semicolons between the fields.
    marks: usize,
}

struct Field {
    start: usize,
    end: usize,
    quoted: bool,
}

/// Takes `line` apart: commas and semicolons separate always, blanks and tabs where none of those stands
/// between two fields. A field in double quotes may hold all of them.
pub(super) fn split(line: &[u8], row: &mut Row) {
    row.fields.clear();
    row.marks = 0;
    let mut at = 0;
    let mut open = false;
    loop {
        at += count(line, at, |b| b.is_ascii_whitespace());
        let Some(&first) = line.get(at) else { break };
        if is_mark(first) {
            row.fields.push(Field { start: at, end: at, quoted: false });
        } else {
            let field = quoted(line, at).unwrap_or_else(|| {
                let length = count(line, at, |b| !b.is_ascii_whitespace() && !is_mark(b));
                (Field { start: at, end: at + length, quoted: false }, at + length)
            });
            row.fields.push(field.0);
            at = field.1 + count(line, field.1, |b| b.is_ascii_whitespace());
        }
        open = line.get(at).copied().is_some_and(is_mark);
        if open {
            row.marks += 1;
            at += 1;
        }
    }
    // A mark at the very end opens one more field, an empty one.
    if open {
        row.fields.push(Field { start: line.len(), end: line.len(), quoted: false });
    }
}

/// A field in quotes at `start`, and the place behind it; `None` if no such field is there.
fn quoted(line: &[u8], start: usize) -> Option<(Field, usize)> {
    if line.get(start) != Some(&b'"') {
        return None;
    }
    let mut at = start + 1;
    loop {
        at += count(line, at, |b| b != b'"');
        match (line.get(at)?, line.get(at + 1)) {
            (_, Some(b'"')) => at += 2,
            (_, None) => return Some((Field { start: start + 1, end: at, quoted: true }, at + 1)),
            (_, Some(&next)) if is_mark(next) || next.is_ascii_whitespace() => {
                return Some((Field { start: start + 1, end: at, quoted: true }, at + 1));
            }
            _ => return None,
        }
    }
}

fn count(line: &[u8], from: usize, wanted: impl Fn(u8) -> bool) -> usize {
    line.get(from..).unwrap_or_default().iter().take_while(|&&b| wanted(b)).count()
}

fn is_mark(byte: u8) -> bool {
    matches!(byte, b',' | b';')
}

impl Row {
    pub(super) fn len(&self) -> usize {
        self.fields.len()
    }

    /// Drops an empty last field: some tools end each line by a separator.
    pub(super) fn drop_empty_end(&mut self) {
        if self.fields.len() > 1 && self.fields.last().is_some_and(|f| f.start == f.end && !f.quoted) {
            self.fields.pop();
        }
    }

    pub(super) fn raw<'a>(&self, line: &'a [u8], index: usize) -> &'a [u8] {
        self.fields.get(index).and_then(|f| line.get(f.start..f.end)).unwrap_or_default()
    }

    pub(super) fn number(&self, line: &[u8], index: usize) -> Option<f64> {
        fast_float2::parse(self.raw(line, index)).ok()
    }

    pub(super) fn is_empty(&self, line: &[u8], index: usize) -> bool {
        self.raw(line, index).is_empty()
    }

    /// Whether the field is neither a number nor nothing.
    pub(super) fn is_word(&self, line: &[u8], index: usize) -> bool {
        let quoted = self.fields.get(index).is_some_and(|f| f.quoted);
        self.number(line, index).is_none() && (quoted || !self.is_empty(line, index))
    }

    /// The field as text, quotes undone; the bytes themselves if they are not UTF-8.
    pub(super) fn text<'a>(&self, line: &'a [u8], index: usize) -> Result<String, &'a [u8]> {
        let raw = self.raw(line, index);
        let text = str::from_utf8(raw).map_err(|_| raw)?;
        let quoted = self.fields.get(index).is_some_and(|f| f.quoted);
        Ok(if quoted { text.replace("\"\"", "\"") } else { text.to_owned() })
    }

    /// Whether commas stand between digits in a line that has other separators too: `1,5 2,5`, `1,5;2,5`.
    pub(super) fn has_decimal_comma(&self, line: &[u8]) -> bool {
        let others = line.contains(&b';') || self.fields.len() > self.marks + 1;
        let between_digits = |w: &[u8]| matches!(w, [a, b',', b] if a.is_ascii_digit() && b.is_ascii_digit());
        others && self.fields.iter().all(|f| !f.quoted) && line.windows(3).any(between_digits)
    }
}

/// Whether a line is a comment: `#` or `//` in front.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"//")
}

/// A comment without its mark.
pub(super) fn comment_text(line: &[u8]) -> &[u8] {
    line.strip_prefix(b"//").unwrap_or_else(|| line.strip_prefix(b"#").unwrap_or(line))
}

/// Whether a field must be quoted to be read back as one field and not as a comment.
pub(crate) fn needs_quotes(field: &str) -> bool {
    field.is_empty()
        || is_comment(field.as_bytes())
        || field.bytes().any(|b| is_mark(b) || b == b'"' || b.is_ascii_whitespace())
}
