//! How fast LAZ is read, against the `las` crate used directly, and what memory it takes; `scripts/bench files` runs both.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

mod common;

use std::hint::black_box;
use std::time::Duration;

use common::real_files;
use footpoint_io::{Data, read};
use rustix::time::{ClockId, clock_gettime};

/// The least time of the processor that each work took, of seven runs in turns: a busy machine slows all alike.
fn cpu_times<const N: usize>(works: [&dyn Fn(); N]) -> [Duration; N] {
    let now = || Duration::try_from(clock_gettime(ClockId::ProcessCPUTime)).unwrap();
    let mut least = [Duration::MAX; N];
    for _ in 0..7 {
        for (work, least) in works.iter().zip(&mut least) {
            let start = now();
            work();
            *least = (*least).min(now() - start);
        }
    }
    least
}

#[test]
#[ignore = "measures; wants a release build"]
fn laz_is_read_as_fast_as_by_the_las_crate() {
    let Some(data) = real_files() else { return };
    for file in ["las/autzen_south6.laz", "copc/lone-star.copc.laz", "las/ahn3_cropped_2.laz"] {
        let path = data.join(file);
        let records = || las::Reader::from_path(&path).unwrap().read_all().unwrap();
        let columns = || _ = black_box(read(&path).unwrap());
        let as_records = || _ = black_box(records());
        let as_points = || _ = black_box(records().points().map(Result::unwrap).collect::<Vec<_>>());
        let [ours, theirs, points] = cpu_times([&columns, &as_records, &as_points]);
        let rows = read(&path).unwrap().table.rows() as f64;
        let rate = |time: Duration| rows / time.as_secs_f64() / 1e6;
        let ratio = theirs.as_secs_f64() / ours.as_secs_f64();
        println!(
            "{file}: {:.2} million points a second; las: {:.2} as records ({ratio:.2}), {:.2} as points ({:.2})",
            rate(ours),
            rate(theirs),
            rate(points),
            points.as_secs_f64() / ours.as_secs_f64(),
        );
        assert!(ratio >= 0.9, "{file}: slower than the las crate");
    }
}

/// The most memory this process has held so far, in bytes; Linux tells it.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes * 1024.0)
}

#[test]
#[ignore = "measures its whole process; run it alone, with --ignored --nocapture"]
fn memory_of_reading_is_that_of_the_columns() {
    let (Some(data), Some(before)) = (real_files(), peak()) else { return };
    let table = read(&data.join("las/autzen_south6.laz")).unwrap().table;
    let taken = peak().unwrap() - before;
    let rows = table.rows() as f64;
    let bytes = |data: &Data| match data {
        Data::F64(_) => 8.0,
        Data::U16(_) => 2.0,
        _ => 1.0,
    };
    let columns: f64 = table.columns.iter().map(|column| bytes(&column.data)).sum();
    println!("{:.1} bytes a point, of which the columns are {columns}", taken / rows);
    assert!(taken / rows > 0.9 * columns, "another test has held as much before; run this one alone");
    assert!(taken / rows < columns + 6.0);
}
