//! Reading a part of a file, and being told how far reading has come.

mod common;

use std::ops::ControlFlow;
use std::sync::Mutex;

use common::{Sample, f64_table};
use footpoint_io::{Bounds, Data, ReadOptions, ReadProblem, Watch, WriteOptions, read_with, write};

/// Keeps what it is told and stops after so many words.
struct Words {
    said: Mutex<Vec<(u64, u64)>>,
    most: usize,
}

impl Watch for Words {
    fn at(&self, done: u64, all: u64) -> ControlFlow<()> {
        let mut said = self.said.lock().unwrap();
        said.push((done, all));
        if said.len() < self.most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

fn rows(count: usize) -> String {
    (0..count).map(|i| format!("{i} 0 0.125000000000\n")).collect()
}

#[test]
fn a_box_keeps_the_points_inside_and_their_columns() {
    let sample = Sample::new("points.csv", "x,y,z,label\n0,0,0,5\n2,2,2,6\n1,1,1,7\nnan,1,1,8\n");
    let within = Some(Bounds { low: [0.5; 3], high: [2.0; 3] });
    let input = read_with(&sample.path, &ReadOptions { within, watch: None }).unwrap();
    assert_eq!(input.table.column("label").unwrap().data, Data::F64(vec![6.0, 7.0]));
    let counted = Sample::new("points.pts", "4\n0 0 0\n2 2 2\n1 1 1\n");
    let input = read_with(&counted.path, &ReadOptions { within, watch: None }).unwrap();
    // One is missing; the one outside is not.
    assert_eq!((input.table.rows(), input.report.stated_rows), (2, Some(3)));
    let plane = Sample::new("points.xy", "0 0\n2 2\n1 1\n");
    let input = read_with(&plane.path, &ReadOptions { within, watch: None }).unwrap();
    assert_eq!(input.table.column("x").unwrap().data, Data::F64(vec![2.0, 1.0]));
}

#[test]
fn the_watch_hears_of_every_megabyte_and_may_stop() {
    let sample = Sample::new("points.xyz", rows(200_000));
    let size = sample.path.metadata().unwrap().len();
    let all = Words { said: Mutex::default(), most: usize::MAX };
    read_with(&sample.path, &ReadOptions { within: None, watch: Some(&all) }).unwrap();
    let said = all.said.into_inner().unwrap();
    assert_eq!(said.len() as u64, size >> 20, "{size} bytes");
    assert!(said.is_sorted() && said.iter().all(|&(done, all)| done <= all && all == size), "{said:?}");

    let once = Words { said: Mutex::default(), most: 1 };
    let stopped = read_with(&sample.path, &ReadOptions { within: None, watch: Some(&once) }).unwrap_err();
    assert!(matches!(*stopped.problem, ReadProblem::Stopped), "{stopped}");
}

#[test]
fn every_format_tells_and_stops() {
    let many = vec![0.125; 100_000];
    let table = f64_table(&[("x", &many), ("y", &many), ("z", &many)]);
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for name in ["a.obj", "a.npy", "a.npz", "a.ply", "a.csv"] {
        let path = folder.path().join(name);
        write(&path, &table, &WriteOptions::default()).unwrap();
        files.push(path);
    }
    let head = "100000\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    let ptx = folder.path().join("a.ptx");
    std::fs::write(&ptx, format!("{head}{}", "0.125 0.125 0.125 1\n".repeat(100_000))).unwrap();
    files.push(ptx);
    for path in files {
        let size = path.metadata().unwrap().len();
        let all = Words { said: Mutex::default(), most: usize::MAX };
        let input = read_with(&path, &ReadOptions { within: None, watch: Some(&all) }).unwrap();
        assert_eq!(input.table.rows(), 100_000);
        let said = all.said.into_inner().unwrap();
        assert!(!said.is_empty() && said.iter().all(|&(done, all)| done <= all && all == size), "{said:?}");
        let once = Words { said: Mutex::default(), most: 1 };
        let stopped = read_with(&path, &ReadOptions { within: None, watch: Some(&once) }).unwrap_err();
        assert!(matches!(*stopped.problem, ReadProblem::Stopped), "{stopped}");
    }
}
