//! PLY files of every lawful layout give their vertices, and word of what was passed over.

mod common;

use common::{names, numbers, parse};
use footpoint_io::{Data, Encoding, Format, OtherElement};

const XY: &str = "property float x\nproperty float y\n";

fn float_rows(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

#[test]
fn both_name_families_give_the_same_types() {
    let families = [
        ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"],
        ["int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"],
    ];
    for family in families {
        let lines: String = family.iter().map(|kind| format!("property {kind} p_{kind}\n")).collect();
        let text =
            format!("ply\nformat ascii 1.0\nelement vertex 1\n{lines}end_header\n-1 2 -3 4 -5 6 7.5 8.5\n");
        let data: Vec<Data> = parse("a.ply", text).table.columns.into_iter().map(|c| c.data).collect();
        let wanted = [
            Data::I8(vec![-1]),
            Data::U8(vec![2]),
            Data::I16(vec![-3]),
            Data::U16(vec![4]),
            Data::I32(vec![-5]),
            Data::U32(vec![6]),
            Data::F32(vec![7.5]),
            Data::F64(vec![8.5]),
        ];
        assert_eq!(data, wanted);
    }
}

#[test]
fn ascii_takes_every_line_end_leading_blanks_and_blank_lines() {
    let text = format!(
        "ply\nformat ascii 1.0\ncomment  hi \nelement vertex 2\n{XY}end_header\n  1\t2 \n\n +3 4e0\n"
    );
    for end in ["\n", "\r\n", "\r"] {
        let input = parse("a.ply", text.replace('\n', end));
        assert_eq!(numbers(&input.table, "x"), [1.0, 3.0], "{end:?}");
        assert_eq!(numbers(&input.table, "y"), [2.0, 4.0], "{end:?}");
        assert_eq!(input.table.comments, ["hi"]);
    }
}

#[test]
fn binary_bytes_that_look_like_line_ends_stay_data() {
    let row = [f32::from_le_bytes(*b"\n\r\n\r"), f32::from_le_bytes(*b"\r\n\r\n")];
    for end in ["\n", "\r\n", "\r"] {
        let header = format!("ply\nformat binary_little_endian 1.0\nelement vertex 1\n{XY}end_header\n");
        let mut bytes = header.replace('\n', end).into_bytes();
        bytes.extend(float_rows(&row));
        let input = parse("a.ply", bytes);
        assert_eq!(numbers(&input.table, "x"), [f64::from(row[0])], "{end:?}");
        assert!(input.report.notes.is_empty());
    }
}

#[test]
fn elements_before_and_behind_are_passed_over_by_type() {
    let camera = "element camera 2\nproperty uchar id\nproperty list ushort double matrix\n";
    let face = "element face 2\nproperty list uchar int vertex_indices\nproperty float q\n";
    let header =
        |format| format!("ply\nformat {format} 1.0\n{camera}element vertex 2\n{XY}{face}end_header\n");
    let ascii = header("ascii") + "1 2 0.5 0.5\n2 0\n1 2\n3 4\n3 0 1 1 9\n0 9\n";
    let mut binary = header("binary_little_endian").into_bytes();
    binary.extend([1, 2, 0]);
    binary.extend([0; 16]);
    binary.extend([2, 0, 0]);
    binary.extend(float_rows(&[1.0, 2.0, 3.0, 4.0]));
    binary.extend([3]);
    binary.extend([0; 16]);
    binary.extend([0; 5]);
    for bytes in [ascii.into_bytes(), binary] {
        let input = parse("a.ply", bytes);
        assert_eq!(numbers(&input.table, "y"), [2.0, 4.0]);
        let other = |name: &str, rows| OtherElement { name: name.into(), rows };
        assert_eq!(input.report.other_elements, [other("camera", 2), other("face", 2)]);
        assert!(input.report.notes.is_empty(), "{:?}", input.report);
    }
}

#[test]
fn lists_of_a_vertex_are_skipped_and_named() {
    let header = |format| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 2\nproperty float x\nproperty list char short near\n\
             property float y\nend_header\n"
        )
    };
    let mut big = header("binary_big_endian").into_bytes();
    for (x, list, y) in [(1.0_f32, vec![7_i16, 8], 2.0_f32), (3.0, vec![], 4.0)] {
        big.extend(x.to_be_bytes());
        big.push(list.len() as u8);
        big.extend(list.iter().flat_map(|v| v.to_be_bytes()));
        big.extend(y.to_be_bytes());
    }
    for bytes in [(header("ascii") + "1 2 7 8 2\n3 0 4\n").into_bytes(), big] {
        let input = parse("a.ply", bytes);
        assert_eq!(names(&input.table), ["x", "y"]);
        assert_eq!(numbers(&input.table, "x"), [1.0, 3.0]);
        assert_eq!(numbers(&input.table, "y"), [2.0, 4.0]);
        assert_eq!(input.report.skipped_lists, ["near"]);
    }
}

#[test]
fn no_rows_make_an_empty_table() {
    let input =
        parse("a.ply", format!("ply\nformat binary_big_endian 1.0\nelement vertex 0\n{XY}end_header\n"));
    assert_eq!(input.format, Format::Ply(Encoding::BigEndian));
    assert_eq!((input.table.rows(), names(&input.table)), (0, vec!["x", "y"]));
}

#[test]
fn a_cut_behind_the_vertices_is_a_note() {
    let face = "element face 3\nproperty list uchar int vertex_indices\n";
    let header = |format| format!("ply\nformat {format} 1.0\nelement vertex 1\n{XY}{face}end_header\n");
    let mut binary = header("binary_little_endian").into_bytes();
    binary.extend(float_rows(&[1.0, 2.0]));
    binary.extend([1, 0, 0, 0, 0, 3, 0]);
    for bytes in [(header("ascii") + "1 2\n1 0\n").into_bytes(), binary] {
        let input = parse("a.ply", bytes);
        assert_eq!(numbers(&input.table, "x"), [1.0]);
        assert_eq!(
            input.report.notes,
            [
                "the vertices are complete, but behind them: unexpected end of file in element face, row 2 of 3; get the whole file again"
            ]
        );
    }
}

#[test]
fn data_behind_the_last_element_are_noted() {
    let input =
        parse("a.ply", format!("ply\nformat ascii 1.0\nelement vertex 1\n{XY}end_header\n1 2\n3 4\n"));
    assert_eq!(input.report.notes, ["data behind the last element were not read"]);
}

#[test]
fn whole_numbers_written_as_decimals_are_taken() {
    let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty uchar red\nend_header\n255.0\n";
    assert_eq!(parse("a.ply", text).table.columns[0].data, Data::U8(vec![255]));
}

#[test]
fn latin_1_comments_are_read() {
    let text = b"ply\nformat ascii 1.0\ncomment H\xf6he\nelement vertex 0\nproperty float x\nend_header\n";
    assert_eq!(parse("a.ply", text).table.comments, ["H\u{f6}he"]);
}

#[test]
fn the_first_line_decides_whatever_the_name_says() {
    let text = format!("ply\nformat ascii 1.0\nelement vertex 1\n{XY}end_header\n1 2\n");
    assert_eq!(parse("scan.data", text).format, Format::Ply(Encoding::Ascii));
}
