//! OBJ: vertices in the file's order, with colours and normals where every vertex has its own.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use common::{f64_table, names, numbers, parse, real_files, refusal};
use footpoint_io::{Column, Data, Format, Table, WriteOptions, check_table, read, write};

#[test]
fn vertices_keep_their_order_and_faces_are_counted() {
    let file = "# a square\no square\nv 0 0 0\nv 1 0 0\r\nv 1 1 0 # corner\n\nv 0 1 -1e-3\nvt 0 0\ns off\n\
                f 1 2 3 \\\n4\nl 1 2\nvp 1\n";
    let input = parse("a.obj", file);
    assert_eq!(input.format, Format::Obj);
    assert_eq!(names(&input.table), ["x", "y", "z"]);
    assert_eq!(numbers(&input.table, "x"), [0.0, 1.0, 1.0, 0.0]);
    assert_eq!(numbers(&input.table, "z"), [0.0, 0.0, 0.0, -0.001]);
    assert_eq!(input.table.comments, ["a square"]);
    let counts = ["2 faces, lines and points", "1 texture coordinates", "1 lines of curves"];
    assert_eq!(input.report.notes, counts.map(|count| format!("{count} passed over")));
}

#[test]
fn the_content_tells_the_format_without_the_name() {
    assert_eq!(parse("a.txt", "# x\nvn 0 0 1\nv 1 2 3\n").format, Format::Obj);
    assert_eq!(parse("a.txt", "v w\n1 2\n").format, Format::Text);
}

#[test]
fn weights_and_colours_are_columns() {
    assert_eq!(names(&parse("a.obj", "v 1 2 3 0.5\n").table), ["x", "y", "z", "w"]);
    let colours = parse("a.obj", "v 1 2 3 0.25 0.5 1\n").table;
    assert_eq!(names(&colours), ["x", "y", "z", "red", "green", "blue"]);
    assert_eq!(numbers(&colours, "red"), [0.25]);
    let all = parse("a.obj", "v 1 2 3 4 0.25 0.5 1\n").table;
    assert_eq!(names(&all), ["x", "y", "z", "w", "red", "green", "blue"]);
}

#[test]
fn normals_are_kept_where_each_vertex_has_its_own() {
    let start = "vn 0 0 1\nv 0 0 0\nvn 0 1 0\nv 1 0 0\nvn 1 0 0\nv 0 1 0\n";
    for faces in ["", "f 1//1 2//2 3//3\n", "f 1/7/1 2/7/2 -1/7/-1\n", "f 1 2 3\n", "f 1/1 2/2 3/1\n"] {
        let table = parse("a.obj", format!("{start}{faces}")).table;
        assert_eq!(names(&table), ["x", "y", "z", "nx", "ny", "nz"], "{faces}");
        assert_eq!(numbers(&table, "ny"), [0.0, 1.0, 0.0]);
    }
    for (start, faces) in
        [(start, "f 1//1 2//1 3//1\n"), (start, "f 1//1 2//2 -1//-2\n"), ("vn 0 0 1\nv 0 0 0\nv 1 1 1\n", "")]
    {
        let input = parse("a.obj", format!("{start}{faces}"));
        assert_eq!(names(&input.table), ["x", "y", "z"], "{faces}");
        assert!(input.report.notes[0].contains("normals passed over"), "{:?}", input.report);
    }
}

#[test]
fn broken_files_are_refused_with_their_place() {
    for (file, reason) in [
        ("v 1 2\n", "line 1: a vertex of 2 numbers"),
        ("v 1 2 3 4 5\n", "line 1: a vertex of 5 numbers"),
        ("v 1 2 3 4 5 6 7 8\n", "line 1: a vertex of 8 numbers"),
        ("\nv 1 2 3\nv 1 2 3 4\n", "line 3: a vertex of 4 numbers, but the first vertex, line 2, has 3"),
        ("v 1 2 3\nvn 1 2\n", "line 2: a normal wants three numbers"),
        ("v 1 2 x\n", "line 1: `x` is not a number"),
        ("v 1 2 3\nhello there\n", "line 2: not a line of an OBJ file: `hello there`"),
        ("# nothing\n", "no line `v x y z`"),
        ("v 1 2 3\n\0", "byte 8: binary content"),
    ] {
        let message = refusal("a.obj", file);
        assert!(message.contains(reason), "{message}");
    }
}

/// Written and read again.
fn back(table: &Table) -> Table {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    write(&path, table, &WriteOptions::default()).unwrap();
    read(&path).unwrap().table
}

#[test]
fn what_obj_holds_is_written_and_read_again() {
    let mut table = f64_table(&[
        ("x", &[0.1, 1e300]),
        ("y", &[-0.0, 2.0]),
        ("z", &[3.0, 1.0 / 3.0]),
        ("w", &[1.0, 0.5]),
        ("red", &[0.25, 1.0]),
        ("green", &[0.0, 0.1]),
        ("blue", &[0.0, 0.7]),
        ("nx", &[1.0, 0.0]),
        ("ny", &[0.0, 0.6]),
        ("nz", &[0.0, 0.8]),
    ]);
    table.comments.push("by a test".to_owned());
    assert_eq!(back(&table), table);
    let plain = f64_table(&[("x", &[1.0]), ("y", &[2.0]), ("z", &[3.0])]);
    assert_eq!(back(&plain), plain);
}

#[test]
fn colours_are_written_as_shares_of_full_light() {
    let mut table = f64_table(&[("x", &[0.0; 2]), ("y", &[0.0; 2]), ("z", &[0.0; 2])]);
    for (data, share) in [
        (Data::U8(vec![1, 0]), 1.0 / 255.0),
        (Data::U16(vec![13_107, 0]), 0.2),
        (Data::F64(vec![51.0, 0.0]), 0.2),
        (Data::I32(vec![13_107, 0]), 0.2),
        (Data::F32(vec![0.5, 0.0]), 0.5),
    ] {
        for name in ["red", "green", "blue"] {
            table.set(Column::new(name, data.clone()));
        }
        assert_eq!(numbers(&back(&table), "blue"), [share, 0.0], "{data:?}");
    }
}

#[test]
fn what_obj_cannot_hold_is_refused_by_name() {
    let path = std::path::Path::new("a.obj");
    let mut table =
        f64_table(&[("x", &[0.0]), ("y", &[0.0]), ("red", &[0.0]), ("nx", &[0.0]), ("time", &[0.0])]);
    let message = check_table(path, &table).unwrap_err().to_string();
    assert!(message.contains("OBJ needs columns x, y and z"), "{message}");
    table.set(Column::new("z", Data::F64(vec![0.0])));
    let message = check_table(path, &table).unwrap_err().to_string();
    assert!(message.contains("leave out red, nx, time, or write PLY"), "{message}");
}

#[test]
fn real_normals_and_colours() {
    let Some(data) = real_files() else { return };
    let table = read(&data.join("obj/pdal_1.2-with-color.obj")).unwrap().table;
    assert_eq!(names(&table), ["x", "y", "z", "red", "green", "blue", "nx", "ny", "nz"]);
    let length = |row: usize| ["nx", "ny", "nz"].iter().map(|n| numbers(&table, n)[row].powi(2)).sum::<f64>();
    assert!((0..table.rows()).step_by(50).all(|row| (length(row) - 1.0).abs() < 1e-3));
    assert_eq!(numbers(&table, "green")[1], 1.0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    write(&path, &table, &WriteOptions::default()).unwrap();
    assert!(read(&path).unwrap().table == table);
}
