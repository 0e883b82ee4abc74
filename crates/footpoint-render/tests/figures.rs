//! The figures in `docs/` are those that the program draws, on every processor.
//!
//! After a wanted change: `footpoint figure all -o docs/figures --force`, and look at them.

use footpoint::{Instructions, Run};
use footpoint_render::figure::{FigureError, NUMBERS, figure};
use std::path::PathBuf;

fn docs() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

fn committed(number: u8) -> String {
    let path = docs().join(format!("figures/figure-{number}.svg"));
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The text with `#` for every number, and the numbers.
fn parts(text: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers, mut digits) = (String::new(), Vec::new(), String::new());
    for c in text.chars().chain(['\n']) {
        let begins = digits.is_empty() && c == '-';
        if begins || c.is_ascii_digit() || (c == '.' && !digits.is_empty()) {
            digits.push(c);
            continue;
        }
        match digits.parse() {
            Ok(number) => {
                numbers.push(number);
                words.push('#');
            }
            Err(_) => words.push_str(&digits),
        }
        digits.clear();
        words.push(c);
    }
    (words, numbers)
}

/// The largest difference between their numbers, which are hundredths of a pixel; infinite where anything else differs.
fn difference(a: &str, b: &str) -> f64 {
    let ((words_a, numbers_a), (words_b, numbers_b)) = (parts(a), parts(b));
    if words_a != words_b {
        return f64::INFINITY;
    }
    numbers_a.iter().zip(&numbers_b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Processors without fused multiply-adds round the last bits of f in their own way, and so do platforms' sines.
const ALLOWED: f64 = 0.025;

#[test]
fn those_in_the_docs_are_drawn_anew_on_every_processor() {
    for number in NUMBERS {
        for instructions in [Instructions::Best, Instructions::Baseline] {
            let drawn = figure(number, &Run::new().instructions(instructions)).unwrap();
            let found = difference(&drawn, &committed(number));
            println!("figure {number}, {instructions:?}: {found} px");
            assert!(
                found <= ALLOWED,
                "figure {number} has changed: look at it, then `footpoint figure all -o docs/figures --force`"
            );
        }
    }
}

#[test]
fn a_change_would_be_noticed() {
    let figure = committed(1);
    assert_eq!(difference(&figure, &figure), 0.0);
    let point = "cx=\"";
    let at = figure.find(point).unwrap() + point.len();
    let moved = format!("{}9{}", &figure[..at], &figure[at..]);
    assert!(difference(&moved, &figure) > 100.0);
    assert_eq!(difference(&figure.replace("a(x)", "b(x)"), &figure), f64::INFINITY);
    assert!(difference(&figure.replace("#0067a5", "#0067a6"), &figure) > ALLOWED);
}

#[test]
fn they_are_small_whole_and_shown() {
    let page = std::fs::read_to_string(docs().join("figures.md")).unwrap();
    for number in NUMBERS {
        let run = Run::new().threads(1);
        let drawn = figure(number, &run).unwrap();
        assert_eq!(drawn, figure(number, &Run::new()).unwrap(), "other bytes with other threads");
        assert!(drawn.len() < 40_000, "figure {number}: {} bytes", drawn.len());
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "figure {number}");
        assert!(drawn.starts_with("<svg ") && drawn.ends_with("</svg>\n"));
        assert!(drawn.contains("<title>") && drawn.contains("viewBox="));
        assert!(page.contains(&format!("(figures/figure-{number}.svg)")), "figure {number} is not shown");
    }
}

#[test]
fn others_are_refused() {
    for number in [0, 3, 7, 255] {
        assert_eq!(figure(number, &Run::new()), Err(FigureError::Number(number)));
    }
}
