//! What several tests need: running the command in a folder of its own, and reading what it wrote.

#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests, which are exempt")]

use footpoint_io::Table;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

/// What a call of the command left on its streams.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// A folder of its own, in which the command runs: file names in its arguments are relative to it.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// Puts a copy of a file of the shared data here and gives its name.
    pub(crate) fn copy(&self, file: &Path) -> String {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        self.write(&name, std::fs::read(file).unwrap());
        name
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub(crate) fn table(&self, name: &str) -> Table {
        footpoint_io::read(&self.path(name)).unwrap().table
    }

    pub(crate) fn csv(&self, name: &str) -> Csv {
        Csv::parse(&self.text(name))
    }

    /// Every file with its size, hidden ones and folders too.
    pub(crate) fn listing(&self) -> Vec<(PathBuf, u64)> {
        let mut folders = vec![self.0.path().to_owned()];
        let mut found = Vec::new();
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let entry = entry.unwrap();
                let kind = entry.file_type().unwrap();
                if kind.is_dir() {
                    folders.push(entry.path());
                }
                found.push((entry.path(), if kind.is_file() { entry.metadata().unwrap().len() } else { 0 }));
            }
        }
        found.sort();
        found
    }

    /// Runs `footpoint` with these words, separated by blanks.
    pub(crate) fn run(&self, words: &str) -> Ran {
        let mut command = Command::new(env!("CARGO_BIN_EXE_footpoint"));
        let output = command.current_dir(self.0.path()).args(words.split_whitespace()).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let code = output.status.code().unwrap_or_else(|| panic!("{words}: ended by a signal"));
        let ran = Ran { code, stdout: text(output.stdout), stderr: text(output.stderr) };
        for stream in [&ran.stdout, &ran.stderr] {
            assert!(!stream.contains("panicked") && !stream.contains("RUST_BACKTRACE"), "{words}: {ran:?}");
        }
        ran
    }

    /// Starts it with both streams in our hands.
    pub(crate) fn start(&self, words: &str) -> Child {
        Command::new(env!("CARGO_BIN_EXE_footpoint"))
            .args(words.split(' '))
            .current_dir(self.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// Runs it and expects success with nothing on standard output.
    pub(crate) fn done(&self, words: &str) -> Ran {
        let ran = self.run(words);
        assert_eq!((ran.code, ran.stdout.as_str()), (0, ""), "{words}: {}", ran.stderr);
        ran
    }

    /// Runs it with `--json`, expects success with nothing on standard error, and gives the report.
    pub(crate) fn report(&self, words: &str) -> Value {
        let ran = self.run(&format!("{words} --json --quiet"));
        assert_eq!((ran.code, ran.stderr.as_str()), (0, ""), "{words}");
        serde_json::from_str(&ran.stdout).unwrap_or_else(|e| panic!("{words}: {e} in {}", ran.stdout))
    }
}

/// A comma-separated file as its words, for tests that must not trust the project's own reader.
pub(crate) struct Csv {
    pub(crate) names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Csv {
    fn parse(text: &str) -> Self {
        let split = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let names = split(lines.next().unwrap());
        let rows: Vec<_> = lines.map(split).collect();
        assert!(rows.iter().all(|row| row.len() == names.len()), "ragged rows");
        Self { names, rows }
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn words(&self, name: &str) -> Vec<&str> {
        let column = self.names.iter().position(|n| n == name);
        let column = column.unwrap_or_else(|| panic!("no column {name} in {:?}", self.names));
        self.rows.iter().map(|row| row[column].as_str()).collect()
    }

    pub(crate) fn numbers(&self, name: &str) -> Vec<f64> {
        self.words(name).iter().map(|word| word.parse().unwrap()).collect()
    }

    /// `prefix_x`, `prefix_y`, … as vectors.
    pub(crate) fn vectors<const D: usize>(&self, prefix: &str) -> Vec<[f64; D]> {
        self.arrays(std::array::from_fn(|k| format!("{prefix}_{}", ["x", "y", "z"][k])))
    }

    pub(crate) fn points<const D: usize>(&self) -> Vec<[f64; D]> {
        self.arrays(std::array::from_fn(|k| ["x", "y", "z"][k].to_owned()))
    }

    pub(crate) fn arrays<const D: usize>(&self, names: [String; D]) -> Vec<[f64; D]> {
        let columns = names.map(|name| self.numbers(&name));
        (0..self.len()).map(|i| std::array::from_fn(|k| columns[k][i])).collect()
    }
}

/// Rows of numbers under a header, each number with all digits that it needs.
pub(crate) fn csv_of<'a>(names: &str, rows: impl Iterator<Item = Vec<f64>> + 'a) -> String {
    let mut text = format!("{names}\n");
    for row in rows {
        let words: Vec<String> = row.iter().map(f64::to_string).collect();
        text += &words.join(",");
        text.push('\n');
    }
    text
}

/// A sphere of radius 1 with outward normals, as csv: a cloud on which everything works.
pub(crate) fn sphere_csv(count: usize) -> String {
    let sphere = footpoint::samples::sphere(1.0, count, 7);
    let rows = sphere.points.iter().zip(&sphere.normals).map(|(p, n)| [*p, *n].concat());
    csv_of("x,y,z,nx,ny,nz", rows)
}

pub(crate) fn numbers_of(table: &Table, name: &str) -> Vec<f64> {
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    let column = table.column(name).unwrap_or_else(|| panic!("no column {name} in {names:?}"));
    column.data.to_f64().unwrap()
}

pub(crate) fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

/// Compares a text with `tests/snapshots/NAME`, or writes it there with `FOOTPOINT_WRITE_GOLDEN=1`.
pub(crate) fn check_snapshot(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots").join(name);
    if std::env::var_os("FOOTPOINT_WRITE_GOLDEN").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        text == expected,
        "{name} has changed; look at it and run with FOOTPOINT_WRITE_GOLDEN=1 if that is meant:\n{text}"
    );
}

/// A folder of the shared material beside the project, or `None` with a message where it is absent.
pub(crate) fn shared(folder: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    println!("skipped: no shared/{folder} beside the project");
    None
}

pub(crate) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

/// |a − s b|.
pub(crate) fn gap<const D: usize>(a: [f64; D], s: f64, b: [f64; D]) -> f64 {
    (0..D).map(|k| (a[k] - s * b[k]).powi(2)).sum::<f64>().sqrt()
}
