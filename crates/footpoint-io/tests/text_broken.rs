//! A text file without a clear table is refused with the line and the reason.

mod common;

use common::refusal;

#[track_caller]
fn refuses(name: &str, bytes: impl AsRef<[u8]>, reason: &str) {
    let message = refusal(name, bytes);
    assert!(message.contains(reason), "wanted `{reason}` in: {message}");
}

#[test]
fn rows_of_differing_length_name_both_lines() {
    refuses("a.xyz", "1 2 3\n4 5 6\n7 8\n", "line 3: 2 fields, but the first row, line 1, has 3");
    refuses("a.xyz", "# hi\n1 2 3\n4 5 6 7\n", "line 3: 4 fields, but the first row, line 2, has 3");
    refuses(
        "a.csv",
        "x,y,z\n1,2,3,\n1,2,3,4\n",
        "line 3: 4 fields, but the header in line 1 names 3 columns",
    );
    refuses("a.csv", "x,y\n1,2,3\n", "line 2: 3 fields, but the header in line 1 names 2 columns");
}

#[test]
fn a_wrong_count_is_forgiven_in_pts_only() {
    refuses("a.xyz", "9\n1 2 3\n", "line 2: 3 fields, but the first row, line 1, has 1");
}

#[test]
fn a_field_that_is_no_number_names_line_and_column() {
    refuses("a.xyz", "1 2 3\n4 5..0 6\n", "line 2, column 2 (`y`): `5..0` is not a number");
    refuses("a.xyz", "1 2 3\n4 0x10 6\n", "`0x10` is not a number");
    refuses("a.csv", "x,y\na,2\n", "line 2, column 1 (`x`): `a` is not a number");
    refuses("a.csv", "x,y,i\n1,2,3\n1,2,n/a\n", "line 3, column 3 (`i`): `n/a` is not a number");
}

#[test]
fn a_name_may_stand_once() {
    refuses("a.txt", "X,Y,X\n1,2,3\n", "line 1: the header names column `X` twice");
}

#[test]
fn decimal_commas_are_refused() {
    for row in ["1,5 2,5 3,5\n", "1,5;2,5;3,5\n", "1,5\t2,5\t3,5\n", "1,000.5 2,000.5\n"] {
        refuses("a.xyz", row, "line 1: commas stand between digits");
    }
}

#[test]
fn a_file_without_rows_is_refused() {
    refuses("a.txt", "These words are no points\n", "no row of numbers; the first line is `These words");
    refuses("a.txt", "to be or not to be\nthat is\n", "no row of numbers; the first line is `to be");
    refuses("a.txt", "# only a comment\n", "no row of numbers");
    refuses("a.txt", "\n\n", "no row of numbers");
    refuses("a.pts", "5\n", "no row of numbers");
    refuses("a.txt", "", "is empty");
}

#[test]
fn binary_content_is_refused() {
    refuses("a.pts", b"points\0\0", "byte 6: binary content");
    refuses("a.xyz", b"1 2 3\n\xff\xfe\n", "byte 6: binary content");
    refuses("a", b"\x80\x81", "byte 0: binary content");
    let mut late = b"1 2 3\n".repeat(20_000);
    late.extend(b"# \xff\n");
    refuses("a.xyz", late, "line 20001: not UTF-8 text");
}

#[test]
fn content_of_another_format_than_the_name_says_is_refused_by_name() {
    for (name, bytes, wanted) in [
        ("a.las", "x", "LAS"),
        ("a.e57", "x", "E57"),
        ("a.pcd", "x", "no line `DATA`"),
        ("a.ptx", "x", "line 1"),
        ("a.xyz", "LASF....", "the header wants 227 bytes"),
        ("a.xyz", "ASTM-E57", "the header states 24 bytes"),
    ] {
        let message = refusal(name, bytes);
        assert!(message.contains(wanted), "{name}: {message}");
    }
}

#[test]
fn a_path_that_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let message = footpoint_io::read(folder.path()).unwrap_err().to_string();
    assert!(message.ends_with("is a folder; name a file"), "{message}");
    let missing = folder.path().join("none.ply");
    let message = footpoint_io::read(&missing).unwrap_err().to_string();
    assert!(message.contains("none.ply: cannot read: No such file"), "{message}");
}
