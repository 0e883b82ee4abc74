//! The hand-written part of a record: why a target was missed, what was tried.

use serde_json::Value;

/// Relative to the project's folder, where the benchmark is run.
const FILE: &str = "bench/notes.md";

/// Adds the part's section of the notes to its record, if there is one.
pub(crate) fn add(record: &mut Value, part: &str) {
    let text = std::fs::read_to_string(FILE).unwrap_or_default();
    if let Some(notes) = section(&text, part) {
        record["notes"] = notes.into();
    }
}

/// What stands below `## title`, up to the next heading of that level.
fn section(text: &str, title: &str) -> Option<String> {
    let mut lines = text.lines().skip_while(|line| line.strip_prefix("## ") != Some(title));
    lines.next()?;
    let body: Vec<&str> = lines.take_while(|line| !line.starts_with("## ")).collect();
    let body = body.join("\n").trim().to_owned();
    (!body.is_empty()).then_some(body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_ends_at_the_next() {
        let text = "# notes\n\n## speed\n\none\n\ntwo\n## peers\nthree\n";
        assert_eq!(section(text, "speed").as_deref(), Some("one\n\ntwo"));
        assert_eq!(section(text, "peers").as_deref(), Some("three"));
        assert_eq!(section(text, "scaling"), None);
    }
}
