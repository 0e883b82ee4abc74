//! Times evaluations of a batch on one thread, for fronts that take turns with it: `batch CLOUD POINTS`, both files of
//! doubles, three a point, as the machine has them. For every line of input it evaluates once and prints the seconds.

use footpoint::{Cloud, Definition, Run, Surface, Want};
use footpoint_jobs::USUAL;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

fn points(path: &Path) -> std::io::Result<Vec<[f64; 3]>> {
    let bytes = std::fs::read(path)?;
    let numbers: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|&eight| f64::from_ne_bytes(eight)).collect();
    Ok(numbers.as_chunks::<3>().0.to_vec())
}

fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<_> = std::env::args_os().skip(1).collect();
    let [cloud, at] = &files[..] else { return Err("usage: batch CLOUD POINTS".into()) };
    let surface = Surface::new(Cloud::new(points(cloud.as_ref())?), Definition::default())?;
    let at = points(at.as_ref())?;
    let want = USUAL.into_iter().reduce(|a, b| a | b).unwrap_or(Want::VALUE);
    let run = Run::new().threads(1);
    // The last answer is held while the next is computed, as callers do.
    let mut found;
    for line in std::io::stdin().lines() {
        line?;
        let begin = Instant::now();
        found = surface.with(&run).evaluate(&at, want)?;
        println!("{}", begin.elapsed().as_secs_f64());
        assert_eq!(found.value.len(), at.len());
    }
    Ok(())
}
