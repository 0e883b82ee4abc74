//! PTX: all scans in their common frame, with every cell of every grid.

mod common;

use common::{bits, names, numbers, parse, real_files, refusal};
use footpoint_io::{Data, Format, read};

const IDENTITY: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
/// A quarter turn about z, then a move by (10, 20, 30).
const TURNED: &str = "10 20 30\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";

#[test]
fn poses_are_applied_and_scans_counted() {
    let file = format!("1\n2\n{IDENTITY}1 2 3 0.5\n-0 0.1 7 0.25\n2\n1\n{TURNED}1 2 3 0.5\n4 5 6 0.125");
    let input = parse("a.ptx", &file);
    assert_eq!(input.format, Format::Ptx);
    assert_eq!(names(&input.table), ["x", "y", "z", "intensity", "scan"]);
    assert_eq!(numbers(&input.table, "x"), [1.0, 0.0, 8.0, 5.0]);
    assert_eq!(numbers(&input.table, "y"), [2.0, 0.1, 21.0, 24.0]);
    assert_eq!(numbers(&input.table, "z"), [3.0, 7.0, 33.0, 36.0]);
    assert_eq!(numbers(&input.table, "intensity"), [0.5, 0.25, 0.5, 0.125]);
    assert_eq!(input.table.columns[4].data, Data::U32(vec![0, 0, 1, 1]));
    assert_eq!(bits(&input.table.columns[0].data)[1], (-0.0_f64).to_bits(), "the identity changes no bit");
    assert_eq!(
        input.table.comments,
        ["scan 0: 1 columns of 2 rows, scanner at 0 0 0", "scan 1: 2 columns of 1 rows, scanner at 10 20 30"]
    );
    assert_eq!(parse("a.txt", &file).format, Format::Ptx, "the content tells it");
}

#[test]
fn cells_without_a_return_stay_as_nan() {
    let input = parse("a.ptx", format!("2\n1\n{TURNED}0 0 0 0.5 7 8 9\n1 0 0 0.25 1 2 3\n"));
    assert_eq!(names(&input.table), ["x", "y", "z", "intensity", "red", "green", "blue"]);
    assert!(numbers(&input.table, "z")[0].is_nan());
    assert_eq!(numbers(&input.table, "x")[1], 10.0);
    assert_eq!(numbers(&input.table, "green"), [8.0, 2.0]);
    assert_eq!(input.report.notes, ["1 grid cells without a return have nan for coordinates"]);
}

#[test]
fn scans_may_differ_in_their_attributes() {
    let file = format!(
        "1\n1\n{IDENTITY}1 2 3\n0\n5\n{IDENTITY}1\n1\n{IDENTITY}1 2 3 7 8 9\n1\n1\n{IDENTITY}1 2 3 4\n"
    );
    let table = parse("a.ptx", file).table;
    assert_eq!(names(&table), ["x", "y", "z", "intensity", "red", "green", "blue", "scan"]);
    let known = |name: &str| numbers(&table, name).iter().map(|v| !v.is_nan()).collect::<Vec<_>>();
    assert_eq!(known("intensity"), [false, false, true]);
    assert_eq!(known("blue"), [false, true, false]);
    assert_eq!(numbers(&table, "scan"), [0.0, 2.0, 3.0]);
}

#[test]
fn broken_files_are_refused_with_their_place() {
    let cell = "1 2 3 0.5\n";
    for (file, reason) in [
        ("\n".to_owned(), "no scan"),
        ("5\n5\n0 0\n".to_owned(), "line 3: 2 values, but line 3 of the head of scan 0 has 3"),
        ("5\n5\n0 0 0\n".to_owned(), "end of file in the head of scan 0, after line 3"),
        (format!("1.5\n1\n{IDENTITY}"), "line 1 or the next: 1.5 is no number"),
        (format!("1\n-1\n{IDENTITY}"), "line 1 or the next: -1 is no number"),
        (format!("2\n3\n{IDENTITY}{cell}{cell}"), "end of file in scan 0, cell 3 of 6"),
        (format!("99999999\n9999999\n{IDENTITY}{cell}"), "cell 2 of 999999890000001"),
        (
            format!("2\n1\n{IDENTITY}{cell}1 2 3\n"),
            "line 12: 3 values, but the first cell of the scan, line 11, has 4",
        ),
        (format!("1\n1\n{IDENTITY}1 2 3 4 5\n"), "line 11: a cell of 5 values"),
        (format!("1\n1\n{IDENTITY}1 2 3 high\n"), "line 11: `high` is not a number"),
        (
            format!("1\n1\n{}{cell}", IDENTITY.replace("0 0 0 1", "0 0 0 2")),
            "line 10: the matrix of scan 0 is no pose",
        ),
        (
            format!("1\n1\n{}{cell}", IDENTITY.replace("0 0 0 1", "nan 0 0 1")),
            "line 10: the matrix of scan 0 is no pose",
        ),
        (format!("1\n1\n{IDENTITY}{cell}7\n"), "end of file in the head of scan 1, after line 12"),
    ] {
        let message = refusal("a.ptx", file);
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn real_scans() {
    let Some(data) = real_files() else { return };
    let table = |name: &str| read(&data.join("text").join(name)).expect(name).table;
    let many = table("pdal_multiple-and-transform.ptx");
    assert_eq!(many.rows(), 8);
    // The first scan is the second in a frame of its own.
    for name in ["x", "y", "z"] {
        let values = numbers(&many, name);
        for row in 0..4 {
            assert!((values[row] - values[row + 4]).abs() < 1e-6, "{name} {row}");
        }
    }
    let complex = table("pdal_complex-transform.ptx");
    assert_eq!((complex.rows(), numbers(&complex, "x").iter().filter(|x| x.is_nan()).count()), (12, 8));
    assert_eq!(table("pdal_1.2-with-color.ptx").rows(), 15 * 71);
}
