//! The layouts of PCD files: what becomes of types, counts, packed colours, padding, order of lines and sizes.

mod common;

use common::{names, numbers, parse, refusal};
use footpoint_io::{Data, Format, Kept, PcdEncoding, PcdKept, Table};

fn header(fields: &str, size: &str, kind: &str, count: &str, points: u64) -> String {
    format!(
        "VERSION 0.7\nFIELDS {fields}\nSIZE {size}\nTYPE {kind}\nCOUNT {count}\nWIDTH {points}\nHEIGHT 1\n\
         POINTS {points}\n"
    )
}

fn kept(table: &Table) -> &PcdKept {
    match &table.kept {
        Some(Kept::Pcd(kept)) => kept,
        other => panic!("{other:?}"),
    }
}

#[test]
fn columns_come_in_their_own_types() {
    let head =
        header("a b c d e f g h i j", "1 1 2 2 4 4 8 8 4 8", "I U I U I U I U F F", "1 1 1 1 1 1 1 1 1 1", 1);
    let row =
        "-128 255 -32768 65535 -2147483648 4294967295 -9223372036854775808 18446744073709551615 0.1 0.1\n";
    let table = parse("a.pcd", head.clone() + "DATA ascii\n" + row).table;
    let mut bytes = (head + "DATA binary\n").into_bytes();
    bytes.extend([0x80, 0xff, 0, 0x80, 0xff, 0xff, 0, 0, 0, 0x80, 0xff, 0xff, 0xff, 0xff]);
    bytes.extend(i64::MIN.to_le_bytes().into_iter().chain(u64::MAX.to_le_bytes()));
    bytes.extend(0.1_f32.to_le_bytes().into_iter().chain(0.1_f64.to_le_bytes()));
    let binary = parse("a.pcd", bytes);
    assert_eq!(binary.format, Format::Pcd(PcdEncoding::Binary));
    assert_eq!(table.columns, binary.table.columns);
    let data: Vec<&Data> = table.columns.iter().map(|column| &column.data).collect();
    let wanted = [
        Data::I8(vec![-128]),
        Data::U8(vec![255]),
        Data::I16(vec![i16::MIN]),
        Data::U16(vec![u16::MAX]),
        Data::I32(vec![i32::MIN]),
        Data::U32(vec![u32::MAX]),
        Data::I64(vec![i64::MIN]),
        Data::U64(vec![u64::MAX]),
        Data::F32(vec![0.1]),
        Data::F64(vec![0.1]),
    ];
    assert_eq!(data, wanted.iter().collect::<Vec<_>>());
}

#[test]
fn several_values_become_several_columns_and_padding_none() {
    let head = header("x _ f", "4 2 1", "F U U", "1 3 2", 2);
    let ascii = parse("a.pcd", head.clone() + "DATA ascii\n1 9 9 9 5 6\n2 9 9 9 7 8\n").table;
    assert_eq!(names(&ascii), ["x", "f_0", "f_1"]);
    assert_eq!(numbers(&ascii, "f_1"), [6.0, 8.0]);
    let mut bytes = (head + "DATA binary\n").into_bytes();
    for (x, f) in [(1_f32, [5, 6]), (2.0, [7, 8])] {
        bytes.extend(x.to_le_bytes().into_iter().chain([9; 6]).chain(f));
    }
    assert_eq!(parse("a.pcd", bytes).table.columns, ascii.columns);
}

#[test]
fn compressed_fields_stand_one_behind_the_other_with_or_without_padding() {
    let head = header("x _ f", "4 1 1", "F U U", "1 1 2", 2) + "DATA binary_compressed\n";
    let x = 1_f32.to_le_bytes().into_iter().chain(2_f32.to_le_bytes());
    for padding in [0_u8, 2] {
        let block: Vec<u8> = x.clone().chain(vec![9; padding.into()]).chain([5, 6, 7, 8]).collect();
        let mut bytes = head.clone().into_bytes();
        bytes.extend(
            (block.len() as u32 + 1).to_le_bytes().into_iter().chain((block.len() as u32).to_le_bytes()),
        );
        // One run of new bytes.
        bytes.push(block.len() as u8 - 1);
        bytes.extend(block);
        let table = parse("a.pcd", bytes).table;
        assert_eq!(numbers(&table, "x"), [1.0, 2.0]);
        assert_eq!((numbers(&table, "f_0"), numbers(&table, "f_1")), (vec![5.0, 7.0], vec![6.0, 8.0]));
    }
}

#[test]
fn packed_colours_are_unpacked() {
    for (kind, value) in [("U", "1056816"), ("I", "1056816"), ("F", "1.480914e-39")] {
        let text =
            header("x rgb", "4 4", &format!("F {kind}"), "1 1", 1) + &format!("DATA ascii\n1 {value}\n");
        let table = parse("a.pcd", text).table;
        assert_eq!(names(&table), ["x", "red", "green", "blue"], "{kind}");
        let colour = ["red", "green", "blue"].map(|name| numbers(&table, name)[0]);
        assert_eq!(colour, [16.0, 32.0, 48.0], "{kind}");
    }
    let alpha = header("rgba", "4", "U", "1", 1) + "DATA ascii\n4278190080\n";
    assert_eq!(numbers(&parse("a.pcd", alpha).table, "alpha"), [255.0]);
    // With columns of these names beside it, or of another size, it stays what it is.
    let both = header("rgb red", "4 1", "U U", "1 1", 1) + "DATA ascii\n1056816 7\n";
    assert_eq!(names(&parse("a.pcd", both).table), ["rgb", "red"]);
    let short = header("rgb", "2", "U", "1", 1) + "DATA ascii\n7\n";
    assert_eq!(names(&parse("a.pcd", short).table), ["rgb"]);
}

#[test]
fn organised_clouds_keep_rows_without_a_point() {
    let text = "# .PCD v0.7 - Point Cloud Data file format\n# by a test\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n\
                TYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 4\nDATA ascii\n\
                0 0 0\nnan nan nan\n1,0,0\n1\t1 0\n";
    let input = parse("noname", text);
    assert!(input.report.notes.is_empty(), "{:?}", input.report);
    assert_eq!(input.table.comments, ["by a test"]);
    assert_eq!(input.table.rows(), 4);
    assert!(numbers(&input.table, "x")[1].is_nan());
    let kept = kept(&input.table);
    assert_eq!((kept.width(), kept.height()), (2, 2));
    assert_eq!(kept.viewpoint(), Some([1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]));
}

#[test]
fn the_content_decides_and_gzip_does_not_matter() {
    let text = header("x y", "4 4", "F F", "1 1", 1) + "DATA ascii\n1 2\n";
    assert_eq!(parse("a.xyz", &text).format, Format::Pcd(PcdEncoding::Ascii));
    let packed = gzip(text.as_bytes());
    assert_eq!(parse("a.pcd.gz", packed).format, Format::Pcd(PcdEncoding::Ascii));
    // A text file whose header happens to begin with a word of PCD.
    assert_eq!(parse("a.csv", "VERSION,x\n1,2\n").format, Format::Text);
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap()
}

#[test]
fn broken_headers_and_rows_name_their_place() {
    let good = header("x y", "4 4", "F F", "1 1", 2);
    let ascii = |rows: &str| good.clone() + "DATA ascii\n" + rows;
    for (text, reason) in [
        (good.clone(), "unexpected end of file in the header, after line 8: no line `DATA`"),
        (
            good.clone() + "DATA morse\n",
            "line 9: PCD has DATA ascii, binary and binary_compressed: `DATA morse`",
        ),
        (ascii("1 2\n3 4 5\n"), "line 11: row 2 has 3 values, the header wants 2"),
        (ascii("1 2\n\n3 four\n"), "line 12: row 2, field y: `four` is no number of type float"),
        (ascii("1\n3 4\n"), "line 10: row 1 has 1 values, the header wants 2"),
        (good.replace("SIZE 4 4", "SIZE 4") + "DATA ascii\n", "1 values in `SIZE`, but names 2 fields"),
        (good.replace("SIZE 4 4", "SIZE 4 2") + "DATA ascii\n", "field `y`: a number of type F and size 2"),
        (good.replace("FIELDS x y", "FIELDS x x") + "DATA ascii\n", "names field `x` twice"),
        (good.replace("FIELDS x y", "") + "DATA ascii\n", "the header has no line `FIELDS`"),
        (
            good.replace("WIDTH 2", "WIDTH two") + "DATA ascii\n",
            "line 6: a whole number is expected: `WIDTH two`",
        ),
        (good.replace("COUNT 1 1", "COUNT 1 99999999") + "DATA ascii\n", "asks for 100000000 columns"),
        (
            good.clone() + "DATA binary_compressed\n\u{1}\u{0}\u{0}\u{0}\u{10}\u{0}\u{0}\u{0}\u{0}",
            "the compressed block is damaged",
        ),
    ] {
        let message = refusal("a.pcd", &text);
        assert!(message.contains(reason), "wanted `{reason}` in: {message}");
    }
}

#[test]
fn what_is_missing_at_the_end_is_told() {
    let good = header("x i", "4 4", "F I", "1 1", 4_000_000_000_000);
    let ascii = parse("a.pcd", good.clone() + "DATA ascii\n1 2\n3");
    assert_eq!(numbers(&ascii.table, "x"), [1.0]);
    assert_eq!(
        ascii.report.notes,
        ["row 2 is cut and was left out", "POINTS says 4000000000000, the file has 1 rows"]
    );
    let mut bytes = (good + "DATA binary\n").into_bytes();
    bytes.extend([0, 0, 0, 0, 7, 0, 0, 0, 1, 2, 3]);
    let binary = parse("a.pcd", bytes);
    assert_eq!(numbers(&binary.table, "i"), [7.0]);
    assert_eq!(binary.report.notes, ["the file ends early: POINTS says 4000000000000, found 1"]);
}
