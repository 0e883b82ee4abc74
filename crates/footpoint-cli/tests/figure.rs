//! `footpoint figure` writes whole figures, overwrites nothing unasked, and refuses what it cannot draw.

mod common;

use common::Folder;

/// Points of a sphere in a text file.
fn sphere() -> String {
    footpoint::samples::sphere(1.0, 2000, 1).points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect()
}

#[test]
fn the_surface_of_figure_3_takes_options() {
    let folder = Folder::new();
    folder.write("cloud.xyz", sphere());
    folder.done("figure 3 cloud.xyz --width 150 -o usual");
    folder.done("figure 3 cloud.xyz --width 150 -o wide --radius 0.5");
    folder.done("figure 3 cloud.xyz --width 90 -o small");
    let picture = |name: &str| folder.bytes(&format!("{name}/figure-3.png"));
    assert!(picture("usual") != picture("wide") && picture("small").len() < picture("usual").len());
}

#[test]
fn one_figure_and_all() {
    let folder = Folder::new();
    let report = folder.report("figure 4 -o new/figures");
    assert_eq!(report["job"], "figure");
    let written = report["outputs"].as_array().unwrap();
    assert_eq!(written.len(), 1);
    assert!(written[0].as_str().unwrap().ends_with("figure-4.svg"));
    let one = folder.bytes("new/figures/figure-4.svg");
    assert!(one.starts_with(b"<svg "));

    folder.write("cloud.xyz", sphere());
    let ran = folder.done("figure all cloud.xyz --width 150 -o all");
    assert!(folder.bytes("all/figure-3.png").starts_with(b"\x89PNG"));
    for number in [1, 2, 4, 5, 6] {
        let name = format!("figure-{number}.svg");
        assert!(ran.stderr.contains(&name), "{}", ran.stderr);
        assert!(folder.text(&format!("all/{name}")).contains("</svg>"));
    }
    assert_eq!(folder.bytes("all/figure-4.svg"), one);
}

#[test]
fn nothing_is_overwritten_unasked() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    folder.write("out/figure-5.svg", "mine");
    let before = folder.listing();
    let ran = folder.run("figure all -o out");
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("figure-5.svg") && ran.stderr.contains("--force"), "{}", ran.stderr);
    assert_eq!(folder.listing(), before, "something was written");
    folder.write("cloud.xyz", sphere());
    folder.done("figure all cloud.xyz --width 150 -o out --force");
    assert!(folder.text("out/figure-5.svg").starts_with("<svg "));
    assert_eq!(folder.listing().len(), 8, "a partial file is left behind");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = Folder::new();
    folder.write("cloud.xy", "0 0\n1 0\n");
    folder.write("file", "");
    for (words, expected) in [
        ("figure 0 -o out", "1, 2, 3, 4, 5, 6"),
        ("figure some -o out", "1, 2, 3, 4, 5, 6"),
        ("figure 1", "--output"),
        ("figure 1 cloud.xy -o out", "takes no file"),
        ("figure 2 -o out --weight poly4", "options of the surface are for figure 3"),
        ("figure 6 -o out --radius 0.1", "options of the surface are for figure 3"),
        ("figure 1 -o file", "cannot make this folder"),
    ] {
        let ran = folder.run(words);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{words}");
        assert!(ran.stderr.contains(expected), "{words}: {}", ran.stderr);
    }
    assert!(!folder.path("out").exists());
}
