//! What several tests need: the shared golden numbers and data, where they stand beside the project.
#![allow(dead_code)]

use serde_json::Value;
use std::path::PathBuf;

/// A folder of the shared material, or `None` with a message where it is absent (a fresh clone).
pub(crate) fn shared(folder: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder);
    if path.is_dir() {
        return Some(path);
    }
    eprintln!("skipped: no shared/{folder} beside the project");
    None
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

pub(crate) fn vector<const D: usize>(value: &Value) -> [f64; D] {
    numbers(value).try_into().unwrap()
}

pub(crate) fn vectors<const D: usize>(value: &Value) -> Vec<[f64; D]> {
    value.as_array().unwrap().iter().map(vector).collect()
}

pub(crate) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

pub(crate) fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn scale<const D: usize>(a: [f64; D], s: f64) -> [f64; D] {
    a.map(|c| c * s)
}

pub(crate) fn length<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

/// The part of `a` across the unit vector `n`.
pub(crate) fn across<const D: usize>(a: [f64; D], n: [f64; D]) -> [f64; D] {
    sub(a, scale(n, dot(a, n)))
}
