//! A reader that closes its end of the pipe early is no error.

mod common;

use common::{Folder, sphere_csv};
use std::io::Read;
use std::process::{Command, Stdio};

#[test]
fn results_may_go_unread() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(500));
    for words in ["info cloud.csv", "info cloud.csv --json", "normals cloud.csv -o n.csv --force --json"] {
        let mut child = folder.start(words);
        // Closed before a byte is written.
        drop(child.stdout.take());
        let mut messages = String::new();
        child.stderr.take().unwrap().read_to_string(&mut messages).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(0), "{words}: {messages}");
        assert!(!messages.contains("panicked") && !messages.contains("pipe"), "{words}: {messages}");
    }
    assert_eq!(folder.csv("n.csv").len(), 500, "the file is complete");
}

#[test]
fn messages_may_go_unread() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(500));
    for (words, code) in [("normals cloud.csv -o n.csv", 0), ("normals missing.csv -o m.csv", 2)] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_footpoint"))
            .args(words.split(' '))
            .current_dir(folder.path(""))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stderr.take());
        assert_eq!(child.wait().unwrap().code(), Some(code), "{words}");
    }
    assert_eq!(folder.csv("n.csv").len(), 500);
}
