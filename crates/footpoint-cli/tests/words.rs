//! Help, manual pages, completions, reports and errors read as they are meant to: snapshots in `tests/snapshots`.

mod common;

use common::{Folder, check_snapshot, sphere_csv};

const VERBS: [&str; 9] =
    ["demo", "info", "evaluate", "normals", "orient", "project", "distance", "figure", "render"];
/// Lines of a screen.
const SCREEN: usize = 50;

/// What is printed, with nothing on standard error.
fn printed(words: &str) -> String {
    let ran = Folder::new().run(words);
    assert_eq!((ran.code, ran.stderr.as_str()), (0, ""), "{words}");
    ran.stdout
}

#[test]
fn short_help_fits_a_screen_and_shows_examples() {
    check_snapshot("help.txt", &printed("-h"));
    for verb in VERBS {
        let help = printed(&format!("{verb} -h"));
        let lines = help.lines().count();
        assert!(lines <= SCREEN, "{verb} -h has {lines} lines");
        assert!(help.contains(&format!("Examples:\n  footpoint {verb}")), "{help}");
        check_snapshot(&format!("help-{verb}.txt"), &help);
    }
}

#[test]
fn long_help_has_every_option_and_can_be_asked_for_in_two_ways() {
    for verb in VERBS {
        let (short, long) = (printed(&format!("{verb} -h")), printed(&format!("{verb} --help")));
        assert_eq!(long, printed(&format!("help {verb}")), "{verb}");
        for hidden in ["--accept-gap", "--support-column", "--threads"] {
            assert!(long.contains(hidden) && !short.contains(hidden), "{verb} {hidden}");
        }
    }
    assert_eq!(printed("help"), printed("--help"));
}

#[test]
fn the_definition_is_explained_with_every_name_that_options_take() {
    let text = printed("help definition");
    for word in "poly2 poly3 poly4 wendland gaussian centred covariance averaged axes levin --auto --per-sample --radius \
                 --support-column --cut outside degenerate boundary singular not_converged invalid"
        .split_whitespace()
    {
        assert!(text.contains(word), "no word about {word}");
    }
    let wrong = Folder::new().run("help normal");
    assert_eq!(wrong.code, 2);
    assert!(wrong.stderr.contains("definition") && wrong.stderr.contains("normals"), "{}", wrong.stderr);
}

#[test]
fn manual_pages_and_completions_name_every_command() {
    let page = printed("man");
    assert!(page.contains(".TH footpoint 1"), "{page}");
    for verb in VERBS {
        assert!(page.contains(verb), "{verb}");
        assert!(printed(&format!("man {verb}")).contains("accept\\-gap"), "{verb}");
    }
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = printed(&format!("completions {shell}"));
        assert!(VERBS.iter().all(|verb| script.contains(verb)), "{shell}");
        assert!(script.contains("per-sample"), "{shell}");
    }
}

/// Without what changes from run to run.
fn steady(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("seconds: "));
    lines.map(|line| format!("{line}\n")).collect()
}

#[test]
fn reports_in_words() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(500) + "nan,0,0,0,0,1\n");
    folder.write("points.csv", "x,y,z\n0,0,1.1\n0,0.9,0\n9,9,9\n");
    let runs = [
        ("info", "info cloud.csv"),
        ("normals", "normals cloud.csv -o normals.csv --auto best"),
        ("project", "project points.csv --onto cloud.csv -o feet.csv --noise 0.01"),
        (
            "distance",
            "distance points.csv --to cloud.csv --compare points -o off.csv --noise 0.01 --largest 1",
        ),
        ("orient", "orient cloud.csv -o oriented.ply --drop normals"),
        ("evaluate", "evaluate cloud.csv --at points.csv -o f.csv --verbose"),
        ("dry-run", "normals cloud.csv -o other.csv --dry-run"),
    ];
    for (name, words) in runs {
        let ran = folder.run(words);
        assert_eq!(ran.code, 0, "{words}: {}", ran.stderr);
        check_snapshot(&format!("report-{name}.txt"), &steady(&(ran.stdout + &ran.stderr)));
    }
}

#[test]
fn errors_say_where_and_what_to_do() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(100));
    folder.write("plane.xy", "0 0\n1 0\n1 1\n");
    folder.write("words.txt", "not a table\n");
    folder.write(
        "cut.ply",
        "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nend_header\n1 2\n",
    );
    folder.write("empty.xyz", "");
    let mut text = String::new();
    for words in [
        "normals missing.ply -o out.ply",
        "normals cloud.csv -o out.docx",
        "normals cloud.csv -o nowhere/out.ply",
        "normals cloud.csv -o cloud.csv",
        "project cloud.csv -o out.obj",
        "normals words.txt -o out.ply",
        "normals cut.ply -o out.ply",
        "normals empty.xyz -o out.ply",
        "normals . -o out.ply",
        "normals cloud.csv -o out.ply --radius 0",
        "normals cloud.csv -o out.ply --support-column r",
        "normals cloud.csv -o out.ply --field averaged --drop normals",
        "project plane.xy --onto cloud.csv -o out.ply",
        "render plane.xy",
        "evaluate cloud.csv --at cloud.csv -o f.csv --with sigma",
        "normals cloud.csv -o out.ply --definition words.txt",
    ] {
        let ran = folder.run(words);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{words}");
        text += &format!("$ footpoint {words}\n{}\n", ran.stderr);
    }
    check_snapshot("errors.txt", &text);
}
