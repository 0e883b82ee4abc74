//! The study's tables, and how they get into their page.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;

const BEGIN: &str = "<!-- study -->";
const END: &str = "<!-- /study -->";

/// The page with the record's tables between its marks; `None` where these are missing.
pub(crate) fn written(page: &str, record: &Value) -> Option<String> {
    let (head, rest) = page.split_once(BEGIN)?;
    let (_, tail) = rest.split_once(END)?;
    Some(format!("{head}{BEGIN}\n{}\n{END}{tail}", tables(record)))
}

/// The record with its rows as one line each, below the names of their columns.
pub(crate) fn compact(record: &Value) -> String {
    let mut head = record.clone();
    let mut text = Vec::new();
    for (key, mark, names) in [("rows", "ROWS", "columns"), ("degrees", "DEGREES", "columns_of_degrees")] {
        let rows = record[key].as_array().map_or(&[][..], Vec::as_slice);
        let all = rows.iter().filter_map(Value::as_object).flat_map(|row| row.keys());
        let columns: BTreeSet<&String> = all.collect();
        let line = |row: &Value| {
            Value::from(columns.iter().map(|&name| row[name].clone()).collect::<Vec<_>>()).to_string()
        };
        let lines: Vec<String> = rows.iter().map(|row| format!("    {}", line(row))).collect();
        head[key] = Value::from(mark);
        head[names] = columns.iter().map(|name| name.as_str()).collect();
        text.push((format!("\"{mark}\""), format!("[\n{}\n  ]", lines.join(",\n"))));
    }
    let whole = format!("{head:#}\n");
    text.into_iter().fold(whole, |whole, (mark, rows)| whole.replacen(&mark, &rows, 1))
}

/// A column: its head, and its cell of a row.
type Column = (&'static str, fn(&Value) -> String);

const SHAPE: Column = ("surface", |row| text(row, "shape"));
const NOISE: Column = ("noise", |row| number(row, "noise_in_spacings"));
const AIM: Column = ("n_eff", |row| number(row, "effective_neighbours"));
const SUPPORT: Column = ("h", |row| number(row, "support_in_spacings"));
const OK: Column = ("ok %", |row| number_of(row["ok_share"].as_f64().map(|share| 100.0 * share)));
const POSITION: Column = ("position", |row| number(row, "position_in_spacings"));
const BIAS: Column = ("bias of theory", |row| number(row, "bias_expected_in_spacings"));
const SURFACE_NORMAL: Column = ("∇f off by", |row| number(row, "surface_normal_degrees"));
const FRAME_NORMAL: Column = ("n off by", |row| number(row, "frame_normal_degrees"));
const BETWEEN: Column = ("n to ∇f", |row| number(row, "between_degrees"));

fn tables(record: &Value) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write_tables(&mut out, record);
    out
}

fn write_tables(out: &mut String, record: &Value) -> std::fmt::Result {
    let is = |row: &Value, key: &str, value: &str| row[key] == value;
    let fixed = |row: &&Value| row["automatic"] == false;
    let plain = |row: &&Value| is(row, "field", "centred covariance") && is(row, "operator", "orthogonal");
    let some = |row: &&Value| [16.0, 64.0, 256.0].map(Value::from).contains(&row["effective_neighbours"]);
    let rows: Vec<&Value> = record["rows"].as_array().into_iter().flatten().collect();
    let picked = |keep: &dyn Fn(&&Value) -> bool| rows.iter().copied().filter(keep).collect::<Vec<_>>();

    writeln!(
        out,
        "\nSupport and noise (centred covariance, orthogonal projection; lengths in spacings, angles in degrees):\n"
    )?;
    let columns = [SHAPE, NOISE, AIM, SUPPORT, OK, POSITION, BIAS, SURFACE_NORMAL, FRAME_NORMAL, BETWEEN];
    write_table(out, &columns, &picked(&|row| fixed(row) && plain(row)))?;

    writeln!(out, "\nFields (torus, orthogonal projection):\n")?;
    let field: Column = ("field", |row| text(row, "field"));
    let columns = [NOISE, AIM, field, OK, POSITION, SURFACE_NORMAL, FRAME_NORMAL, BETWEEN];
    let orthogonal = |row: &&Value| is(row, "operator", "orthogonal") && is(row, "shape", "torus");
    write_table(out, &columns, &picked(&|row| fixed(row) && orthogonal(row) && some(row)))?;

    writeln!(out, "\nOperators (torus, centred covariance):\n")?;
    let operator: Column = ("operator", |row| text(row, "operator"));
    let evaluations: Column = ("evaluations a point", |row| number(row, "mean_evaluations"));
    let columns = [NOISE, AIM, operator, OK, POSITION, SURFACE_NORMAL, FRAME_NORMAL, evaluations];
    let centred = |row: &&Value| is(row, "field", "centred covariance") && is(row, "shape", "torus");
    write_table(out, &columns, &picked(&|row| fixed(row) && centred(row) && some(row)))?;

    writeln!(out, "\nDegrees (centred covariance, orthogonal projection; bold: the one chosen):\n")?;
    write_degrees(out, record)?;

    writeln!(out, "\nThe support of least error (centred covariance, orthogonal projection):\n")?;
    let expected: Column = ("position expected", |row| number(row, "expected_in_spacings"));
    let columns = [SHAPE, NOISE, AIM, SUPPORT, OK, POSITION, expected, SURFACE_NORMAL, FRAME_NORMAL];
    write_table(out, &columns, &picked(&|row| !fixed(row) && plain(row)))
}

/// One row a cloud: errors of degrees 0, 2 and 3, the chosen one set in bold.
fn write_degrees(out: &mut String, record: &Value) -> std::fmt::Result {
    let heads = ["position 0", "2", "3", "∇f off by 0", "2", "3"];
    writeln!(out, "| surface | noise | n_eff | κ_H h | {} |", heads.join(" | "))?;
    writeln!(out, "|{}", "---|".repeat(4 + heads.len()))?;
    for row in record["degrees"].as_array().into_iter().flatten() {
        let bent = number(row, "curvature_times_support");
        write!(out, "| {} | {} | {} | {bent} |", SHAPE.1(row), NOISE.1(row), AIM.1(row))?;
        for (k, key) in ["position_in_spacings", "surface_normal_degrees"].into_iter().enumerate() {
            for (m, degree) in [0, 2, 3].into_iter().enumerate() {
                let cell = number_of(row[key][m].as_f64());
                let chosen = row["chosen"][k] == degree;
                write!(out, "{}", if chosen { format!(" **{cell}** |") } else { format!(" {cell} |") })?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

fn write_table(out: &mut String, columns: &[Column], rows: &[&Value]) -> std::fmt::Result {
    let heads: Vec<&str> = columns.iter().map(|column| column.0).collect();
    writeln!(out, "| {} |", heads.join(" | "))?;
    writeln!(out, "|{}", "---|".repeat(columns.len()))?;
    for row in rows {
        let cells: Vec<String> = columns.iter().map(|column| (column.1)(row)).collect();
        writeln!(out, "| {} |", cells.join(" | "))?;
    }
    Ok(())
}

fn text(row: &Value, key: &str) -> String {
    row[key].as_str().unwrap_or_default().to_owned()
}

fn number(row: &Value, key: &str) -> String {
    number_of(row[key].as_f64())
}

/// Three significant digits, zero where rounding is all there is.
fn number_of(value: Option<f64>) -> String {
    match value {
        None => String::new(),
        Some(value) if value.abs() < 1e-9 => "0".to_owned(),
        Some(value) if value.abs() < 1e-3 => format!("{value:.1e}"),
        Some(value) => {
            let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 4) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn tables_replace_what_stood_between_the_marks() {
        let row = json!({
            "shape": "torus", "noise_in_spacings": 0.5, "effective_neighbours": 16.0, "automatic": false,
            "field": "centred covariance", "operator": "orthogonal", "ok_share": 0.9987,
            "position_in_spacings": 0.123456, "between_degrees": 1e-12,
        });
        let page = format!("before\n{BEGIN}\nstale\n{END}\nafter\n");
        let page = written(&page, &json!({ "rows": [row] })).unwrap();
        assert!(
            page.starts_with("before\n") && page.ends_with("\nafter\n") && !page.contains("stale"),
            "{page}"
        );
        assert!(page.contains("| torus | 0.5 | 16 |  | 99.9 | 0.123 |"), "{page}");
        assert_eq!(written("no marks", &json!({})), None);
    }

    #[test]
    fn a_compact_record_holds_every_number() {
        let record = json!({ "study": "x", "rows": [{ "a": 1.5, "b": "t" }, { "a": 2.0, "c": null }] });
        let read: Value = serde_json::from_str(&compact(&record)).unwrap();
        assert_eq!(read["columns"], json!(["a", "b", "c"]));
        assert_eq!(read["rows"], json!([[1.5, "t", null], [2.0, null, null]]));
        assert_eq!(read["study"], "x");
    }
}
