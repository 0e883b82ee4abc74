//! Writing refuses early, replaces in one step, and leaves no partial file behind.

#![allow(clippy::unwrap_used, reason = "helpers of tests, which are exempt")]

mod common;

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;

use common::f64_table;
use footpoint_io::{
    Column, Data, Encoding, Overwrite, PcdEncoding, Table, Watch, WriteOptions, WriteProblem, check_table,
    check_writable, read, write, write_with,
};

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

/// Keeps what it is told, and ends the work once it has been told so often.
struct Listener {
    told: Mutex<Vec<(u64, u64)>>,
    most: usize,
}

impl Watch for Listener {
    fn at(&self, done: u64, all: u64) -> ControlFlow<()> {
        let mut told = self.told.lock().unwrap();
        told.push((done, all));
        if told.len() < self.most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

#[test]
fn every_format_tells_how_far_it_is_and_can_be_ended() {
    const ROWS: u64 = 200_000;
    let values: Vec<f64> = (0..ROWS).map(|i| (i % 1000) as f64).collect();
    let table = f64_table(&[("x", &values), ("y", &values), ("z", &values)]);
    let folder = tempfile::tempdir().unwrap();
    let usual = WriteOptions::default();
    let names = ["a.ply", "a.las", "a.laz", "a.e57", "a.pcd", "a.xyz", "a.pts", "a.obj", "a.npy", "a.npz"];
    let kinds = [
        ("b.ply", WriteOptions { ply: Encoding::Ascii, ..usual }),
        ("b.pcd", WriteOptions { pcd: PcdEncoding::Ascii, ..usual }),
        ("c.pcd", WriteOptions { pcd: PcdEncoding::Compressed, ..usual }),
    ];
    for (name, options) in names.map(|name| (name, usual)).into_iter().chain(kinds) {
        let path = folder.path().join(name);
        let ending = Listener { told: Mutex::default(), most: 2 };
        let stopped = write_with(&path, &table, &options, Some(&ending)).unwrap_err();
        assert!(matches!(stopped.problem, WriteProblem::Stopped), "{name}: {stopped}");
        assert!(files(folder.path()).is_empty(), "{name}");
        let all = Listener { told: Mutex::default(), most: usize::MAX };
        write_with(&path, &table, &options, Some(&all)).unwrap();
        let told = all.told.into_inner().unwrap();
        assert!((2..=4).contains(&told.len()), "{name}: {told:?}");
        assert!(
            told.is_sorted() && told.iter().all(|&(done, all)| done <= ROWS && all == ROWS),
            "{name}: {told:?}"
        );
        assert_eq!(read(&path).unwrap().table.rows() as u64, ROWS, "{name}");
        fs::remove_file(&path).unwrap();
    }
}
