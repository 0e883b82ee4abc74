//! Records as Markdown, for the README.

use serde_json::Value;
use std::fmt::Write;

/// The tables of a record of speed or of peers, with a line that names the machine.
pub(crate) fn table(record: &Value) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = targets(&mut text, record).and_then(|()| peers(&mut text, record)).and_then(|()| {
        let place = &record["circumstances"];
        let word = |name: &str| place[name].as_str().unwrap_or("unknown").to_owned();
        let (machine, instructions) = (word("machine"), word("instructions"));
        let (version, commit, date) = (word("version"), word("commit"), word("date"));
        writeln!(text, "\n{machine}, {instructions}; footpoint {version} at {commit}, {date}.")
    });
    text
}

fn targets(text: &mut String, record: &Value) -> std::fmt::Result {
    let Some(targets) = record["targets"].as_array() else { return Ok(()) };
    writeln!(text, "| what | target | reached | |\n|---|---|---|---|")?;
    for target in targets {
        let bounds: Vec<String> = [("at_least", "≥"), ("at_most", "≤")]
            .into_iter()
            .filter_map(|(name, sign)| Some(format!("{sign} {}", target[name].as_f64()?)))
            .collect();
        let name = target["target"].as_str().unwrap_or_default();
        let verdict = target["verdict"].as_str().unwrap_or_default();
        writeln!(text, "| {name} | {} | {} | {verdict} |", bounds.join(", "), short(&target["reached"]))?;
    }
    Ok(())
}

fn peers(text: &mut String, record: &Value) -> std::fmt::Result {
    // The groups of speed have cases in place of jobs.
    let groups = record["groups"].as_array().into_iter().flatten().filter(|group| group["jobs"].is_array());
    for (i, group) in groups.enumerate() {
        if i == 0 {
            writeln!(
                text,
                "| job | program | equal in | CPU s | times footpoint's |\n|---|---|---|---|---|"
            )?;
        }
        let name = group["group"].as_str().unwrap_or_default();
        writeln!(text, "| {name} | footpoint | | {} | 1 |", short(&group["footpoint"]["cpu_seconds"]))?;
        for job in group["jobs"].as_array().into_iter().flatten().filter(|job| job["failure"].is_null()) {
            let peer = job["peer"].as_str().unwrap_or_default();
            let what = job["job"].as_str().unwrap_or_default();
            let equal = job["equal"].as_str().unwrap_or_default();
            let (seconds, ratio) = (short(&job["cpu_seconds"]), short(&job["against_footpoint"]));
            writeln!(text, "| | {peer} {what} | {equal} | {seconds} | {ratio} |")?;
        }
    }
    Ok(())
}

/// Three digits are what a timing is good for.
fn short(number: &Value) -> String {
    match number.as_f64() {
        Some(value) if value >= 100.0 => format!("{value:.0}"),
        Some(value) if value >= 10.0 => format!("{value:.1}"),
        Some(value) => format!("{value:.2}"),
        None => "?".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_table_names_the_machine_and_every_target() {
        let record = json!({
            "circumstances": { "machine": "a processor", "instructions": "AVX2" },
            "targets": [{ "target": "a ratio", "at_least": 14.0, "reached": 12.345, "verdict": "missed" }],
            "groups": [{ "group": "30", "cases": [] }],
        });
        let table = table(&record);
        assert!(table.contains("| a ratio | ≥ 14 | 12.3 | missed |"), "{table}");
        assert!(table.contains("a processor, AVX2"), "{table}");
        assert!(!table.contains("| job |"), "{table}");
    }
}
