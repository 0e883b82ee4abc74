//! Interrupts, full disks and read-only places: the right exit code, and no partial file.
#![cfg(unix)]

mod common;

use common::{Folder, sphere_csv};
use std::os::unix::fs::PermissionsExt;
use std::process::Command;
use std::time::{Duration, Instant};

#[test]
fn an_interrupt_ends_with_130_soon_and_leaves_nothing() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(4000));
    let before = folder.listing();
    for words in ["render cloud.csv --size 8000x6000 --samples 16", "project cloud.csv -o p.ply --auto 3000"]
    {
        let mut child = folder.start(words);
        std::thread::sleep(Duration::from_millis(300));
        let told = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        let since = Instant::now();
        let ended = child.wait().unwrap();
        assert!(told.success(), "{words} had ended already: {ended}");
        assert_eq!(ended.code(), Some(130), "{words}");
        assert!(since.elapsed() < Duration::from_secs(5), "{words} took {:?}", since.elapsed());
        assert_eq!(folder.listing(), before, "{words}");
    }
}

#[test]
fn a_full_disk_leaves_nothing() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(4000));
    let before = folder.listing();
    // A limit on the size of files stands for the end of the disk.
    for output in ["n.ply", "n.csv"] {
        let footpoint = env!("CARGO_BIN_EXE_footpoint");
        let script = format!("trap '' XFSZ; ulimit -f 64; exec '{footpoint}' normals cloud.csv -o {output}");
        let ran = Command::new("bash").args(["-c", &script]).current_dir(folder.path("")).output().unwrap();
        let said = String::from_utf8(ran.stderr).unwrap();
        assert_eq!(ran.status.code(), Some(2), "{said}");
        assert!(said.contains(output) && said.contains("nothing is left behind"), "{said}");
        assert_eq!(folder.listing(), before);
    }
}

#[test]
fn a_read_only_folder_is_told_before_the_work() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(100));
    std::fs::create_dir(folder.path("kept")).unwrap();
    std::fs::set_permissions(folder.path("kept"), std::fs::Permissions::from_mode(0o555)).unwrap();
    let is_root = std::fs::write(folder.path("kept/probe"), "").is_ok();
    if is_root {
        println!("skipped: this user may write everywhere");
        return;
    }
    let ran = folder.run("normals cloud.csv -o kept/n.ply");
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("cannot write here"), "{}", ran.stderr);
}
