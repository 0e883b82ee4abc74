//! NumPy files: layouts of `numpy.save` and `numpy.savez`, and what is refused of them.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::io::{Cursor, Write};

use common::{names, numbers, parse, refusal};
use footpoint_io::{Data, Format};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// A file as `numpy.save` writes it.
fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn f4(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// An archive of these files.
fn npz(method: CompressionMethod, files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        archive.start_file(*name, SimpleFileOptions::default().compression_method(method)).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn stored(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    npz(CompressionMethod::Stored, files)
}

#[test]
fn widths_decide_the_names() {
    let values: Vec<f32> = (0..14).map(|i| i as f32 + 0.5).collect();
    for (width, wanted) in
        [(1, "column_1"), (2, "x y"), (3, "x y z"), (5, "x y z column_4 column_5"), (6, "x y z nx ny nz")]
    {
        let input = parse("a.npy", npy("'<f4'", false, &format!("(2, {width})"), &f4(&values[..2 * width])));
        assert_eq!(input.format, Format::Npy);
        assert_eq!(names(&input.table).join(" "), wanted);
        assert_eq!(
            input.table.columns[width - 1].data,
            Data::F32(vec![width as f32 - 0.5, 2.0 * width as f32 - 0.5])
        );
    }
}

#[test]
fn orders_and_types_are_kept() {
    let rows = [[1_i16, -2], [3, 4], [5, 600]];
    let wanted = [Data::I16(vec![1, 3, 5]), Data::I16(vec![-2, 4, 600])];
    let row_by_row = || rows.iter().flatten();
    let column_by_column = || [0, 1].into_iter().flat_map(|k| rows.iter().map(move |row| row[k]));
    for bytes in [
        npy("'<i2'", false, "(3, 2)", &row_by_row().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()),
        npy("'>i2'", false, "(3, 2)", &row_by_row().flat_map(|v| v.to_be_bytes()).collect::<Vec<_>>()),
        npy("'<i2'", true, "(3, 2)", &column_by_column().flat_map(i16::to_le_bytes).collect::<Vec<_>>()),
        npy("'>i2'", true, "(3, 2)", &column_by_column().flat_map(i16::to_be_bytes).collect::<Vec<_>>()),
    ] {
        let table = parse("a.npy", bytes).table;
        assert!(table.columns.iter().map(|column| &column.data).eq(&wanted), "{table:?}");
    }
    for (descr, wanted) in [
        ("'|b1'", Data::U8(vec![7])),
        ("'|u1'", Data::U8(vec![7])),
        ("'|i1'", Data::I8(vec![7])),
        ("'<u2'", Data::U16(vec![7])),
        ("'<i4'", Data::I32(vec![7])),
        ("'<u4'", Data::U32(vec![7])),
        ("'<i8'", Data::I64(vec![7])),
        ("'<u8'", Data::U64(vec![7])),
        ("'<f8'", Data::F64(vec![f64::from_bits(7)])),
    ] {
        let size: usize = descr[3..4].parse().unwrap();
        let mut bytes = vec![0; size];
        bytes[0] = 7;
        assert_eq!(
            parse("a.npy", npy(descr, false, "(1, 1)", &bytes)).table.columns[0].data,
            wanted,
            "{descr}"
        );
    }
}

#[test]
fn many_blocks_stay_in_order() {
    let rows = 100_000_usize;
    let values: Vec<f32> = (0..3 * rows).map(|i| i as f32).collect();
    let shape = format!("({rows}, 3)");
    let table = parse("a.npy", npy("'<f4'", false, &shape, &f4(&values))).table;
    assert_eq!(numbers(&table, "y")[rows - 1], (3 * rows - 2) as f64);
    let table = parse("a.npy", npy("'<f4'", true, &shape, &f4(&values))).table;
    assert_eq!(
        (numbers(&table, "y")[7], numbers(&table, "z")[rows - 1]),
        ((rows + 7) as f64, (3 * rows - 1) as f64)
    );
}

#[test]
fn records_are_columns_with_their_parts() {
    let descr = "[('x', '<f4'), ('', '|V2'), ('c', '|u1', (2, 2)), ('n', [('a', '>i2'), ('b', '|S3')]), ('t', '<U2')]";
    let row = |x: f32, a: i16, b: &[u8; 3], t: [char; 2]| {
        let mut bytes = x.to_le_bytes().to_vec();
        bytes.extend([9, 9, 1, 2, 3, 4]);
        bytes.extend(a.to_be_bytes());
        bytes.extend(b);
        t.iter().for_each(|c| bytes.extend((*c as u32).to_le_bytes()));
        bytes
    };
    let data = [row(1.5, -2, b"ab\0", ['ü', '\0']), row(2.5, 300, b"cde", ['x', 'y'])].concat();
    let table = parse("a.npy", npy(descr, false, "(2,)", &data)).table;
    assert_eq!(names(&table), ["x", "c_0_0", "c_0_1", "c_1_0", "c_1_1", "n_a", "n_b", "t"]);
    assert_eq!(numbers(&table, "x"), [1.5, 2.5]);
    assert_eq!(numbers(&table, "c_1_0"), [3.0, 3.0]);
    assert_eq!(numbers(&table, "n_a"), [-2.0, 300.0]);
    assert_eq!(table.column("n_b").unwrap().data, Data::Text(vec!["ab".into(), "cde".into()]));
    assert_eq!(table.column("t").unwrap().data, Data::Text(vec!["ü".into(), "xy".into()]));
}

#[test]
fn grids_are_taken_row_by_row() {
    let values: Vec<f32> = (0..12).map(|i| i as f32).collect();
    let input = parse("a.npy", npy("'<f4'", false, "(2, 2, 3)", &f4(&values)));
    assert_eq!(numbers(&input.table, "y"), [1.0, 4.0, 7.0, 10.0]);
    assert_eq!(input.report.notes, ["array of shape [2, 2, 3] taken row by row"]);
}

#[test]
fn arrays_of_an_archive_are_columns() {
    let points = npy("'<f4'", false, "(2, 3)", &f4(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let colours = npy("'|u1'", false, "(2, 3)", &[1, 2, 3, 4, 5, 6]);
    let classes = npy("'|u1'", false, "(2,)", &[7, 8]);
    let other = npy("'|u1'", false, "(2, 2)", &[1, 2, 3, 4]);
    let files = [
        ("points.npy", points.clone()),
        ("normals.npy", points.clone()),
        ("colors.npy", colours),
        ("class.npy", classes),
        ("uv.npy", other),
        ("scale.npy", npy("'<f4'", false, "()", &f4(&[1.0]))),
        ("objects.npy", npy("'|O'", false, "(2,)", b"pickle")),
        ("readme.txt", b"hello".to_vec()),
    ];
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        let input = parse("a.npz", npz(method, &files));
        assert_eq!(input.format, Format::Npz);
        let wanted = "x y z nx ny nz red green blue class uv_0 uv_1";
        assert_eq!(names(&input.table).join(" "), wanted);
        assert_eq!(numbers(&input.table, "z"), [3.0, 6.0]);
        assert_eq!(numbers(&input.table, "class"), [7.0, 8.0]);
        assert_eq!(numbers(&input.table, "uv_1"), [2.0, 4.0]);
        assert_eq!(input.report.notes.len(), 3, "{:?}", input.report.notes);
    }
    let alone = parse("a.npz", stored(&[("arr_0.npy", points)]));
    assert_eq!(names(&alone.table), ["x", "y", "z"], "a single array is read as a file of its own");
}

#[test]
fn what_holds_no_rows_is_refused_with_the_way_out() {
    let deep = format!("{}'<f4'{}", "[('a', ".repeat(30), ")]".repeat(30));
    let long = |n: u32| [b"\x93NUMPY\x02\x00".as_slice(), &n.to_le_bytes(), b"{}"].concat();
    let x = f4(&[1.0]);
    for (bytes, reason) in [
        (npy("'<f4'", false, "(1,)", &x), "one dimension of 1 numbers; save shape (n, 2) or (n, 3)"),
        (npy("'<f4'", false, "()", &x), "a single value"),
        (npy("'|O'", false, "(1,)", &x), "an array of Python objects"),
        (npy("'<f2'", false, "(2, 1)", &x), "column `column_1` is of the type <f2"),
        (npy("[('t', '<M8[s]')]", false, "(0,)", &x), "column `t` is of the type <M8[s]"),
        (npy("'<f4'", true, "(1, 1, 1)", &x), "more than two dimensions in Fortran's order"),
        (npy("[]", false, "(9999999,)", &x), "rows without any bytes"),
        (npy("'|S0'", false, "(9999999, 2)", &x), "rows without any bytes"),
        (npy("'<f4'", false, "(0, 99999999)", &x), "more than 4096 columns"),
        (npy("[('a', '<f4', (99999999999,))]", false, "(0,)", &x), "more than 4096 columns"),
        (npy("'<f4'", false, "(9, 3)", &x), "the rows of the array want 108 bytes, found 4"),
        (npy("'<f4'", true, "(9, 3)", &x), "the rows of the array want 108 bytes, found 4"),
        (npy("'<f4'", false, "(4294967296, 4294967296, 3)", &x), "its shape is beyond all files"),
        (npy("'<f4'", false, "(0, 4294967296, 4294967296, 3)", &x), "its shape is beyond all files"),
        (npy("'<f4'", false, "(-1, 3)", &x), "its shape has no lengths"),
        (npy(&deep, false, "(1,)", &x), "its brackets stand too deep"),
        (npy("", false, "(1,)", &x), "it is no Python dictionary"),
        (npy("7", false, "(1,)", &x), "the header of the array is broken"),
        (long(4_000_000_000), "it has 4000000000 bytes"),
        (long(3), "the file ends in it"),
        (b"\x93NUMPY".to_vec(), "the file ends in it"),
    ] {
        let message = refusal("a.npy", bytes);
        assert!(message.contains(reason), "wanted `{reason}` in {message}");
    }
}

#[test]
fn archives_of_no_table_are_refused() {
    let two = npy("'|u1'", false, "(2,)", &[1, 2]);
    let three = npy("'|u1'", false, "(3,)", &[1, 2, 3]);
    let points = npy("'|u1'", false, "(2, 3)", &[0; 6]);
    for (bytes, reason) in [
        (stored(&[("x.npy", two.clone()), ("y.npy", three)]), "array `y`: 3 rows, but array `x` has 2"),
        (stored(&[("x.npy", two.clone()), ("points.npy", points)]), "array `points`: a second column `x`"),
        (stored(&[("x.npy", two[..two.len() - 1].to_vec())]), "array `x`: unexpected end of file"),
        (stored(&[("x.txt", two.clone())]), "a zip archive without a NumPy array"),
        (stored(&[]), "a zip archive without a NumPy array"),
        (stored(&[("x.npy", two)])[..90].to_vec(), "cannot read the archive"),
    ] {
        let message = refusal("a.npz", bytes);
        assert!(message.contains(reason), "wanted `{reason}` in {message}");
    }
}

#[test]
fn a_wrong_checksum_is_refused() {
    let mut bytes = stored(&[("x.npy", npy("'|u1'", false, "(2,)", b"QZ"))]);
    let at = bytes.windows(2).position(|pair| pair == b"QZ").unwrap();
    bytes[at] ^= 1;
    let message = refusal("a.npz", bytes);
    assert!(message.contains("array `x`: cannot read") && message.contains("hecksum"), "{message}");
}

#[test]
fn an_archive_that_unpacks_without_end_is_refused() {
    let mebibytes = 160;
    let header = npy("'|u1'", false, &format!("({},)", mebibytes << 20), &[]);
    let zeros = vec![0; 1 << 20];
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // Each alone would be let through.
    for name in ["a.npy", "b.npy"] {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        archive.start_file(name, options.compression_level(Some(1))).unwrap();
        archive.write_all(&header).unwrap();
        (0..mebibytes).for_each(|_| archive.write_all(&zeros).unwrap());
    }
    let message = refusal("a.npz", archive.finish().unwrap().into_inner());
    assert!(message.contains("array `b`: cannot read") && message.contains("over 100 times"), "{message}");
}

#[test]
fn six_columns_of_bytes_are_colours() {
    let values = [0.0, 1.0, 2.0, 255.0, 7.0, 0.0, 3.0, 4.0, 5.0, 0.0, 1.0, 1.0];
    let input = parse("a.npy", npy("'<f4'", false, "(2, 6)", &f4(&values)));
    assert_eq!(names(&input.table), ["x", "y", "z", "red", "green", "blue"]);
    assert_eq!(input.report.notes, ["no names: columns taken by position as x y z red green blue"]);
}
