//! Dependencies point one way: between the crates, and between the library's rooms.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

/// What each crate may use of the others.
const CRATES: [(&str, &[&str]); 6] = [
    ("footpoint", &[]),
    ("footpoint-io", &[]),
    ("footpoint-render", &["footpoint"]),
    ("footpoint-jobs", &["footpoint", "footpoint-io", "footpoint-render"]),
    ("footpoint-cli", &["footpoint-jobs"]),
    ("footpoint-python", &["footpoint", "footpoint-io", "footpoint-render", "footpoint-jobs"]),
];

/// The library's rooms, lowest first: each may use only those before it.
const ROOMS: [&str; 39] = [
    "written",
    "lane",
    "dual",
    "status",
    "algebra",
    "samples",
    "curvature",
    "eigen",
    "polynomial",
    "weight",
    "field",
    "columns",
    "run",
    "noise",
    "least_squares",
    "cloud",
    "support",
    "grid",
    "domain",
    "neighbours",
    "engine",
    "frame",
    "heights",
    "regression",
    "definition",
    "choose",
    "evaluator",
    "surface",
    "queries",
    "variance",
    "evaluate",
    "average",
    "project",
    "ray",
    "contour",
    "degree",
    "uncertainty",
    "orient",
    "compare",
];

/// Questions see the surface and its evaluator, never the engine or the index.
const QUESTIONS: [&str; 9] =
    ["evaluate", "average", "project", "ray", "contour", "degree", "uncertainty", "orient", "compare"];
const INTERNALS: [&str; 2] = ["engine", "grid"];

const LONGEST_FILE: usize = 600;

fn workspace() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Rust files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found
}

/// The file without its tests, which may look anywhere.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod tests")
        .next()
        .unwrap()
        .split("#[cfg(test)]\npub(crate) mod tests")
        .next()
        .unwrap()
}

fn dependencies(manifest: &str) -> Vec<String> {
    let mut section = "";
    let mut found = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            section = line;
        } else if section.ends_with("dependencies]") && !section.contains("dev-") && line.contains('=') {
            let name = line.split(['.', ' ', '=']).next().unwrap();
            found.push(name.to_owned());
        }
    }
    found
}

#[test]
fn crates_use_only_what_they_may() {
    for (name, allowed) in CRATES {
        let manifest = fs::read_to_string(workspace().join("crates").join(name).join("Cargo.toml")).unwrap();
        let found = dependencies(&manifest);
        assert!(!found.is_empty(), "{name}: no dependency found, so this test sees nothing");
        for used in found.iter().filter(|d| d.starts_with("footpoint")) {
            assert!(allowed.contains(&used.as_str()), "{name} must not use {used}");
        }
    }
}

#[test]
fn rooms_use_only_lower_rooms() {
    let src = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut arrows = 0;
    for path in sources(&src) {
        let inside = path.strip_prefix(&src).unwrap().to_str().unwrap();
        let room = inside.split(['/', '.']).next().unwrap();
        if room == "lib" || inside == "engine/oracle.rs" || inside == "evaluator/tests.rs" {
            continue;
        }
        let rank =
            ROOMS.iter().position(|r| *r == room).unwrap_or_else(|| panic!("{room} is not a known room"));
        let text = fs::read_to_string(&path).unwrap();
        for after in without_tests(&text).split("crate::").skip(1) {
            let used = after.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
            let Some(used_rank) = ROOMS.iter().position(|r| *r == used) else { continue };
            arrows += 1;
            // Links in documentation name the public type, not the room.
            assert!(used_rank <= rank, "{inside} uses {used}, which is above it");
            let internal = QUESTIONS.contains(&room) && INTERNALS.contains(&used);
            assert!(!internal, "{inside} is a question and must not use {used}");
        }
    }
    assert!(arrows > 40, "only {arrows} arrows found, so this test sees too little");
}

#[test]
fn no_unsafe_and_no_overlong_file() {
    for (name, _) in CRATES {
        for path in sources(&workspace().join("crates").join(name).join("src")) {
            let text = fs::read_to_string(&path).unwrap();
            let lines = text.lines().count();
            assert!(lines <= LONGEST_FILE, "{}: {lines} lines", path.display());
            // The compiler denies it everywhere but for one line of the room of vectors: a hint to the processor.
            let allowed = usize::from(path.ends_with("footpoint/src/lane.rs"));
            assert!(text.matches("unsafe {").count() <= allowed, "{} holds unsafe code", path.display());
            assert!(text.starts_with("//! "), "{} does not say its subject first", path.display());
        }
    }
}
