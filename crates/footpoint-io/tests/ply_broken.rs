//! A broken PLY file is refused at once, with the place and the reason.

mod common;

use std::time::{Duration, Instant};

use common::refusal;

fn ascii(body: &str) -> String {
    format!("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty uchar r\nend_header\n{body}")
}

fn header(lines: &str) -> String {
    format!("ply\nformat ascii 1.0\n{lines}\nend_header\n")
}

#[track_caller]
fn refuses(bytes: impl AsRef<[u8]>, reason: &str) {
    let message = refusal("a.ply", bytes);
    assert!(message.contains(reason), "wanted `{reason}` in: {message}");
}

#[test]
fn ascii_cut_short_names_the_row() {
    refuses(ascii("1 2\n"), "unexpected end of file in element vertex, row 2 of 2");
    refuses(ascii("1 2\n3"), "unexpected end of file in element vertex, row 2 of 2");
    refuses(ascii(""), "unexpected end of file in element vertex, row 1 of 2");
}

#[test]
fn ascii_rows_of_wrong_length_name_the_line() {
    refuses(ascii("1 2 3\n4 5\n"), "line 7: element vertex, row 1 has 3 values, the header wants 2");
    refuses(ascii("1\n4 5\n"), "line 7: element vertex, row 1 has 1 values, the header wants 2");
}

#[test]
fn ascii_values_of_wrong_type_name_line_and_property() {
    refuses(ascii("1 2\nx 5\n"), "line 8: element vertex, row 2, property x: `x` is not a float");
    refuses(ascii("1 256\n3 5\n"), "line 7: element vertex, row 1, property r: `256` is not a uchar");
    refuses(ascii("1 2.5\n3 5\n"), "property r: `2.5` is not a uchar");
    refuses(ascii("1,5 2\n3 5\n"), "property x: `1,5` is not a float");
}

#[test]
fn binary_cut_short_says_wanted_and_found_bytes() {
    let text =
        "ply\nformat binary_little_endian 1.0\nelement vertex 10\nproperty double x\nend_header\n1234567";
    refuses(text, "element vertex: its 10 rows want 80 bytes, found 7");
}

#[test]
fn absurd_counts_fail_fast() {
    let start = Instant::now();
    for format in ["ascii", "binary_little_endian"] {
        for count in ["4000000000000", "18446744073709551615"] {
            for property in [
                "property double x",
                "property list uchar int l",
                "property double x\nproperty list int int l",
            ] {
                let text =
                    format!("ply\nformat {format} 1.0\nelement vertex {count}\n{property}\nend_header\n0\n");
                refuses(text, "unexpected end of file in element vertex");
                let text = format!(
                    "ply\nformat {format} 1.0\nelement face {count}\n{property}\nelement vertex 1\n\
                     property char x\nend_header\n0\n"
                );
                refuses(text, "unexpected end of file in element face");
            }
        }
    }
    assert!(start.elapsed() < Duration::from_secs(2));
}

#[test]
fn a_negative_list_is_refused() {
    let text = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list char int l\nend_header\n\u{7f}";
    refuses(text, "unexpected end of file in element vertex, row 1 of 1");
    let mut bytes = text.as_bytes().to_vec();
    *bytes.last_mut().unwrap() = 0xff;
    refuses(bytes, "element vertex, row 1, property l: a list of -1 values");
}

#[test]
fn headers_name_the_bad_line() {
    refuses(header("element vertex 1\nproperty quux nx"), "line 4: unknown type `quux`");
    refuses(header("element vertex 1\nproperty list uchar quux l"), "line 4: unknown type `quux`");
    refuses(header("element vertex -1"), "line 3: the count of an element is a whole number");
    refuses(header("element vertex"), "line 3: an element wants a name and a count");
    refuses(header("property float x"), "line 3: a property before any element");
    refuses(
        header("element vertex 1\nproperty float x\nproperty int x"),
        "line 5: a second property of the same name",
    );
    refuses(header("element vertex 1\nelement vertex 1"), "line 4: a second element `vertex`");
    refuses(
        header("element vertex 1\nproperty list float int x"),
        "cannot be counted by a floating-point type",
    );
    refuses(header("hello"), "line 3: not a line of a PLY header: `hello`");
    refuses("ply\nformat ascii 2.0\nend_header\n", "line 2: unknown PLY format");
    refuses("ply\nelement vertex 0\nend_header\n", "no line `format");
    refuses("ply\nformat ascii 1.0\nelement vertex 1\n", "no `end_header`");
}

#[test]
fn a_missing_vertex_lists_the_elements() {
    refuses(
        header("element point 0\nelement face 0"),
        "no element named `vertex`, which holds the points; elements found: point, face",
    );
    refuses("ply\nformat ascii 1.0\nend_header\n", "elements found: none");
}

#[test]
fn a_ply_name_on_another_file_is_refused() {
    refuses("1 2 3\n", "not a PLY file");
    refuses("", "is empty");
}
