//! Text files of every usual layout give their columns, and word of what was guessed.

mod common;

use common::{names, numbers, parse};
use footpoint_io::{Data, Format};

#[test]
fn separators_may_be_mixed() {
    let files = [
        "1 2 3\n4 5 6\n",
        "1\t2\t3\n4\t5\t6\n",
        "1,2,3\n4,5,6\n",
        "1;2;3\n4;5;6\n",
        " 1 , 2 ,3 \r\n4, 5,\t6\r\n",
        "1 2 3\r4 5 6\r",
    ];
    for text in files {
        let input = parse("a.txt", text);
        assert_eq!(input.format, Format::Text);
        assert_eq!(names(&input.table), ["x", "y", "z"], "{text:?}");
        assert_eq!(numbers(&input.table, "y"), [2.0, 5.0], "{text:?}");
        assert_eq!(input.report.notes, ["no header: columns taken by position as x y z"]);
    }
}

#[test]
fn a_header_names_the_columns() {
    for text in [
        "X Y Z Time\n1 2 3 4\n",
        "\"X\",\"Y\",\"Z\",\"Time\"\n1,2,3,4\n",
        "\u{feff}X,Y,Z,Time,\n1,2,3,4\n",
        "X Y Z Time\n\n\n1, 2, 3, 4,\n\n",
    ] {
        let input = parse("a.csv", text);
        assert_eq!(names(&input.table), ["X", "Y", "Z", "Time"], "{text:?}");
        assert_eq!(numbers(&input.table, "Time"), [4.0]);
        assert!(input.report.notes.is_empty());
    }
    let input = parse("a.csv", "x,y,,2020\n1,2,3,4\n");
    assert_eq!(names(&input.table), ["x", "y", "column_3", "2020"]);
}

#[test]
fn a_header_in_a_comment_names_the_columns_if_it_fits() {
    for text in ["# x y z id\n1 2 3 4\n", "#x,y,z,id\n1,2,3,4\n", "//X Y Z id\n1\n1 2 3 4\n"] {
        let table = parse("a.xyz", text).table;
        assert_eq!(names(&table)[3], "id", "{text:?}");
        assert!(table.comments.is_empty());
    }
    for text in ["# from our scan\n1 2 3\n", "# x y\n1 2 3\n"] {
        let table = parse("a.xyz", text).table;
        assert_eq!(names(&table), ["x", "y", "z"], "{text:?}");
        assert_eq!(table.comments.len(), 1);
    }
}

#[test]
fn columns_without_a_header_are_named_by_position() {
    let cases: [(&str, &str, &[&str]); 10] = [
        ("a.txt", "1", &["column_1"]),
        ("a.txt", "1 2", &["x", "y"]),
        ("a.txt", "1 2 3 4", &["x", "y", "z", "column_4"]),
        ("a.pts", "1 2 3 4", &["x", "y", "z", "intensity"]),
        ("a.txt", "1 2 3 4 5", &["x", "y", "z", "column_4", "column_5"]),
        ("a.txt", "1 2 3 0.5 0 -1", &["x", "y", "z", "nx", "ny", "nz"]),
        ("a.txt", "1 2 3 0 0 1", &["x", "y", "z", "nx", "ny", "nz"]),
        ("a.txt", "1 2 3 0 0 255", &["x", "y", "z", "red", "green", "blue"]),
        ("a.pts", "1 2 3 -9 4 5 6", &["x", "y", "z", "intensity", "red", "green", "blue"]),
        ("a.xy", "1 2 3", &["x", "y", "column_3"]),
    ];
    for (name, row, wanted) in cases {
        let input = parse(name, format!("{row}\n{row}\n"));
        assert_eq!(names(&input.table), wanted, "{row}");
        assert_eq!(input.table.rows(), 2, "{row}");
    }
}

#[test]
fn a_lone_first_number_is_a_count() {
    let input = parse("a.xyz", "2\n1 2 3\n4 5 6\n");
    assert_eq!(numbers(&input.table, "x"), [1.0, 4.0]);
    let input = parse("a.pts", "8\n1 2 3\n4 5 6\n");
    assert_eq!(input.report.notes[0], "PTS count says 8, file has 2 rows");
}

#[test]
fn comments_and_blank_lines_are_passed_over_and_kept() {
    let input = parse("a.xyz", "# one\n\n  1 2 3\n// two\n#three\n4 5 6\n\n\n");
    assert_eq!(input.table.rows(), 2);
    assert_eq!(input.table.comments, ["one", "two", "three"]);
}

#[test]
fn numbers_come_in_every_spelling() {
    let input = parse("a.txt", "x y\nnan -inf\nNaN +inf\n.5 5.\n+1e-3 -1E+3\nInf \"7\"\n");
    let (x, y) = (numbers(&input.table, "x"), numbers(&input.table, "y"));
    assert!(x[0].is_nan() && x[1].is_nan());
    assert_eq!(x[2..], [0.5, 1e-3, f64::INFINITY]);
    assert_eq!(y, [f64::NEG_INFINITY, f64::INFINITY, 5.0, -1e3, 7.0]);
}

#[test]
fn empty_fields_are_nan_with_a_note() {
    let input = parse("a.csv", "x,y,w\n1,2,\n3,,4\n,5,6\n");
    assert!(numbers(&input.table, "w")[0].is_nan());
    assert!(numbers(&input.table, "y")[1].is_nan());
    assert!(numbers(&input.table, "x")[2].is_nan());
    assert_eq!(input.report.notes, ["3 empty fields read as nan, the first in line 2"]);
}

#[test]
fn a_column_of_words_is_text() {
    for text in ["x,y,what\n1,2,\"a, \"\"b\"\"\"\n3,4,7\n", "1,2,\"a, \"\"b\"\"\"\n3,4,7\n"] {
        let input = parse("a.xy", text);
        assert_eq!(input.table.columns[2].data, Data::Text(vec!["a, \"b\"".into(), "7".into()]), "{text:?}");
        let note = input.report.notes.last().unwrap();
        assert!(note.ends_with("holds no numbers: kept as text"), "{note}");
    }
}

#[test]
fn unknown_extensions_are_read_as_text() {
    assert_eq!(parse("points", "1 2 3\n").table.rows(), 1);
    assert_eq!(parse("points.asc", "1 2 3\n").table.rows(), 1);
}

#[test]
fn numbers_of_any_length_are_the_nearest_doubles() {
    let odd = [
        "-0",
        "00012.50",
        ".5",
        "-.5",
        "5.",
        "0.30000000000000004",
        "9007199254740992",
        "9007199254740993",
        "9007199254740993.0",
        "123456789012345678",
        "1234567890123456789",
        "18446744073709551616",
        "1e5",
        "-2.5E-3",
        "0.000000000000000001",
        "4.9e-324",
        "1e400",
        "inf",
        "-inf",
        "596000.123",
        "0.1",
        "1.7976931348623157e308",
    ];
    let mut random = 1_u64;
    let digits = (0..20_000).map(|index| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let (whole, decimals) = ((random >> 30).to_string(), index % 17);
        let point = whole.len().saturating_sub(decimals);
        format!("{}{}.{}", if index % 2 == 0 { "-" } else { "" }, &whole[..point], &whole[point..])
    });
    let written: Vec<String> = odd.iter().map(ToString::to_string).chain(digits).collect();
    let text: String = written.iter().map(|number| format!("{number} 1 {number}\n")).collect();
    let table = parse("a.xyz", text).table;
    for column in [0, 2] {
        let Data::F64(read) = &table.columns[column].data else { panic!("numbers") };
        for (written, read) in written.iter().zip(read) {
            let wanted: f64 = written.parse().unwrap();
            assert_eq!(read.to_bits(), wanted.to_bits(), "{written}");
        }
    }
}

#[test]
fn plain_rows_and_odd_ones_stay_in_order() {
    let line = |index: usize| match index % 1000 {
        7 => format!("{index},1,\n"),
        8 => format!("# between\n{index} 1 {index}.5\n"),
        _ => format!("{index}, 1 ;{index}.5\n"),
    };
    let text: String = (0..20_000).map(line).collect();
    let table = parse("a.csv", text).table;
    let wanted: Vec<f64> = (0..20_000).map(f64::from).collect();
    assert_eq!(numbers(&table, "x"), wanted);
    let z = numbers(&table, "z");
    assert!(z.iter().enumerate().all(|(i, z)| if i % 1000 == 7 { z.is_nan() } else { *z == i as f64 + 0.5 }));
    assert_eq!(table.comments.len(), 20);
}
