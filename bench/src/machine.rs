//! Where and when a record was made.

use serde_json::{Value, json};
use std::process::Command;

/// Machine, version, commit and date, as a record carries them.
pub(crate) fn circumstances() -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": said_by("git", &["describe", "--always", "--dirty", "--abbrev=12"]),
        "date": said_by("date", &["-u", "+%Y-%m-%dT%H:%MZ"]),
        "machine": name(),
        "cores": std::thread::available_parallelism().map_or(1, usize::from),
        "instructions": instructions(),
        // Another program on the machine costs cache and memory bandwidth: a reader should know.
        "load_average": load_average(),
    })
}

/// The processor's name, where the system tells it.
pub(crate) fn name() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or("unknown", |(_, name)| name).to_owned()
}

/// The widest vector unit that the processor has, of those that the library distinguishes.
fn instructions() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            "AVX-512"
        } else if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            "AVX2"
        } else {
            "SSE2"
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    std::env::consts::ARCH
}

fn load_average() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

fn said_by(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
