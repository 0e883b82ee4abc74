//! Writing refuses early, replaces in one step, and leaves no partial file behind.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::fs;
use std::path::Path;

use common::f64_table;
use footpoint_io::{Column, Data, Overwrite, Table, WriteOptions, check_table, check_writable, read, write};

fn points() -> Table {
    f64_table(&[("x", &[1.0, 2.0]), ("y", &[3.0, 4.0])])
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Both the early check and the writing itself must refuse, and change nothing.
#[track_caller]
fn refuses(path: &Path, overwrite: Overwrite, reason: &str) {
    let options = WriteOptions { overwrite, ..WriteOptions::default() };
    for result in [check_writable(path, overwrite), write(path, &points(), &options)] {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(reason) && message.contains(&path.display().to_string()), "{message}");
    }
}

#[test]
fn an_existing_file_stays_without_permission() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.xyz");
    fs::write(&path, "mine").unwrap();
    refuses(&path, Overwrite::Refuse, "exists already");
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    check_writable(&path, Overwrite::Replace).unwrap();
    let options = WriteOptions { overwrite: Overwrite::Replace, ..WriteOptions::default() };
    write(&path, &points(), &options).unwrap();
    assert_eq!(read(&path).unwrap().table, points());
    assert_eq!(files(folder.path()), ["a.xyz"]);
}

#[test]
fn places_that_cannot_be_written_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    refuses(
        &folder.path().join("a.doc"),
        Overwrite::Refuse,
        "end it in one of: ply las laz e57 pcd xyz csv txt pts pwn xy obj npy npz",
    );
    refuses(&folder.path().join("a.ply.gz"), Overwrite::Refuse, "no format to write");
    refuses(&folder.path().join("ply"), Overwrite::Refuse, "no format to write");
    refuses(&folder.path().join("no/a.ply"), Overwrite::Refuse, "does not exist; create it first");
    let inner = folder.path().join("folder.ply");
    fs::create_dir(&inner).unwrap();
    refuses(&inner, Overwrite::Replace, "is a folder");
    fs::remove_dir(&inner).unwrap();
    assert!(files(folder.path()).is_empty());
}

#[test]
fn a_protected_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    fs::write(&path, "mine").unwrap();
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions).unwrap();
    refuses(&path, Overwrite::Replace, "cannot write here");
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn tables_a_format_cannot_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [ply, csv, npy] = ["a.ply", "a.csv", "a.npy"].map(|name| folder.path().join(name));
    let with = |column| {
        let mut table = points();
        table.columns.push(column);
        table
    };
    let text = |value: &str| Data::Text(vec![value.to_owned(); 2]);
    let two = || Data::U8(vec![0; 2]);
    let cases = [
        (&ply, with(Column::new("t", Data::U8(vec![1]))), "column `t` has 1 rows, the first column has 2"),
        (&ply, with(Column::new("x", two())), "two columns are named `x`"),
        (&ply, with(Column::new("t", text("a"))), "column `t` holds text, which PLY cannot"),
        (&ply, with(Column::new("a b", two())), "column name \"a b\" cannot stand"),
        (&npy, with(Column::new("t", text("a"))), "column `t` holds text, which NumPy cannot"),
        (&npy, with(Column::new("a\tb", two())), "column name \"a\\tb\" cannot stand"),
        (&csv, with(Column::new("a\nb", two())), "column name \"a\\nb\" cannot stand"),
        (&csv, with(Column::new("t", text("a\nb"))), "column `t`, row 1: the text has a line break"),
    ];
    for (path, table, reason) in cases {
        for result in [check_table(path, &table), write(path, &table, &WriteOptions::default())] {
            let message = result.unwrap_err().to_string();
            assert!(message.contains(reason), "{message}");
        }
    }
    assert!(files(folder.path()).is_empty());
}

#[test]
fn a_bare_name_is_written_to_the_working_folder() {
    check_writable(Path::new("footpoint-io-test.ply"), Overwrite::Refuse).unwrap();
    assert!(!Path::new("footpoint-io-test.ply").exists());
}

#[cfg(unix)]
#[test]
fn the_result_has_the_permissions_of_an_ordinary_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("a.ply"), folder.path().join("b"));
    write(&ours, &points(), &WriteOptions::default()).unwrap();
    fs::write(&plain, "").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[cfg(unix)]
#[test]
fn a_device_is_never_replaced() {
    refuses_device(Path::new("/dev/null"));
}

#[cfg(unix)]
fn refuses_device(device: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("a.ply");
    std::os::unix::fs::symlink(device, &link).unwrap();
    refuses(&link, Overwrite::Replace, "special file");
}
