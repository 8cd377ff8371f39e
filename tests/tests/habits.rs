//! Manners of the program: quiet and verbose, colours, readers that go away, completions, manual.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::path::Path;
use std::process::{Command, Stdio};

use common::{Answer, command, door2, door2_policy, path_text, program, pubs, root, words};

const LOCKSTEP: &str = "--goal 0.5 --lockstep --seed 7 --no-record";

fn run(folder: &Path, options: &str) -> Answer {
    let (object, policy) = (door2(), door2_policy());
    let mut arguments = vec!["run", &object, "--policy", &policy];
    arguments.extend(words(LOCKSTEP));
    arguments.extend(words(options));
    pubs(folder, &arguments)
}

#[test]
fn quiet_says_nothing_and_verbose_says_what_is_read_from_where() {
    let folder = tempfile::tempdir().unwrap();
    let quiet = run(folder.path(), "--quiet");
    quiet.assert_code(0);
    assert_eq!(quiet.stderr, "");
    let verbose = run(folder.path(), "-v --set belief.particles=300");
    verbose.assert_code(0);
    assert_eq!(
        verbose.stdout, quiet.stdout,
        "the result does not depend on the talk"
    );
    for word in [
        "object: ",
        "door2.toml",
        "overridden: --set belief.particles=300",
        "observation model: segments",
        "policy runtime: ",
        "driver: virtual-arm",
    ] {
        assert!(
            verbose.stderr.contains(word),
            "no `{word}` in: {}",
            verbose.stderr
        );
    }
    let usual = run(folder.path(), "");
    assert!(!usual.stderr.contains("object: "), "{}", usual.stderr);
    run(folder.path(), "--quiet --verbose").assert_code(2);
    // Faults are heard all the same.
    pubs(folder.path(), &["check", "missing.toml", "--quiet"])
        .assert_code(2)
        .assert_says(&["missing.toml"]);
}

#[test]
fn quiet_leaves_out_notes_of_a_training() {
    let folder = tempfile::tempdir().unwrap();
    let object = path_text(&root().join("objects/door2.toml"));
    let line = "--goal 0.5 --lockstep --no-record --policies new";
    let mut arguments = vec!["run", &object];
    arguments.extend(words(line));
    for (option, expected) in [("--quiet", ""), ("--verbose", "policy: ")] {
        let answer = pubs(folder.path(), &[&arguments[..], &[option]].concat());
        assert!([0, 3].contains(&answer.code), "{}", answer.stderr);
        match expected {
            "" => assert_eq!(answer.stderr, ""),
            // The policy that the quiet run has trained.
            word => assert!(answer.stderr.contains(word), "{}", answer.stderr),
        }
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let objects = path_text(&root().join("objects"));
    let (object, policy) = (door2(), door2_policy());
    let of_object: &[&str] = &[&object, "--policy", &policy];
    let run_line = [&["run"], of_object, &words(LOCKSTEP)].concat();
    let lines: Vec<Vec<&str>> = vec![
        vec!["--help"],
        vec!["run", "--help"],
        vec!["--version"],
        vec!["config"],
        vec!["config", "--schema"],
        vec!["check", &objects],
        vec!["check", &objects, "--json"],
        vec!["plugins", "list"],
        vec!["plugins", "list", "--schema"],
        vec!["completions", "bash"],
        vec!["man"],
        vec!["evaluate", &policy, "--trials", "50", "--object", &object],
        run_line.clone(),
        [&run_line[..], &["--json"]].concat(),
    ];
    for line in lines {
        let mut child = command(folder.path(), &line)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let answer = Answer::from_output(line.join(" "), child.wait_with_output().unwrap());
        answer.assert_code(0);
        assert_eq!(answer.stderr, "", "{}", line.join(" "));
    }
}

/// What the program writes on a terminal.
fn on_a_terminal(folder: &Path, line: &str, variables: &[(&str, &str)]) -> Option<String> {
    let words = format!("{} {line}", program().display());
    let mut script = Command::new("script");
    script
        .current_dir(folder)
        .args(["-qec", &words, "/dev/null"])
        .env("TERM", "xterm-256color")
        .env_remove("NO_COLOR")
        .envs(variables.iter().copied())
        .stdin(Stdio::null());
    match script.output() {
        Ok(output) => Some(String::from_utf8_lossy(&output.stdout).into_owned()),
        Err(_) => {
            println!("skipped: no `script`, which makes a terminal");
            None
        }
    }
}

#[test]
fn colours_are_for_terminals_that_want_them() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.toml"), "schema = 1\nnam = \"x\"\n").unwrap();
    std::fs::write(folder.path().join("bad.pomdp"), "discount: 2\n").unwrap();
    let lines = [
        "check bad.toml",
        "solve bad.pomdp",
        "run --goal",
        "--help",
        "doctor",
    ];
    const ESCAPE: char = '\u{1b}';
    for line in lines {
        let answer = pubs(folder.path(), &words(line));
        let told = format!("{}{}", answer.stdout, answer.stderr);
        assert!(
            !told.contains(ESCAPE),
            "{line}: colours without a terminal: {told:?}"
        );
        let Some(told) = on_a_terminal(folder.path(), line, &[("NO_COLOR", "1")]) else {
            continue;
        };
        assert!(
            !told.contains("\u{1b}[3"),
            "{line}: colours although NO_COLOR: {told:?}"
        );
    }
    if let Some(told) = on_a_terminal(folder.path(), "check bad.toml", &[]) {
        assert!(
            told.contains("\u{1b}[3") || told.contains("\u{1b}[1m"),
            "no colours: {told:?}"
        );
    }
}

#[test]
fn completions_are_scripts_that_know_the_verbs() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let answer = pubs(folder.path(), &["completions", shell]);
        answer
            .assert_code(0)
            .assert_says(&["calibrate", "dashboard", "lockstep"]);
        let script = folder.path().join(shell);
        std::fs::write(&script, &answer.stdout).unwrap();
        // Where the shell is there, it reads the script without a complaint.
        if let Ok(output) = Command::new(shell).arg("-n").arg(&script).output() {
            assert!(
                output.status.success(),
                "{shell}: {}",
                String::from_utf8_lossy(&output.stderr)
            );
        }
    }
    pubs(folder.path(), &["completions", "cmd"])
        .assert_code(2)
        .assert_says(&["bash"]);
}

#[test]
fn the_manual_has_a_page_for_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    pubs(folder.path(), &["man"])
        .assert_code(0)
        .assert_says(&[".TH pubs-engine 1"]);
    let answer = pubs(folder.path(), &["man", "--out", "pages"]);
    answer.assert_code(0);
    let pages: Vec<&str> = answer.stdout.lines().collect();
    for verb in [
        "run",
        "calibrate",
        "replay",
        "plugins",
        "plugins-list",
        "man",
    ] {
        let page = format!("pages/pubs-engine-{verb}.1");
        assert!(pages.contains(&page.as_str()), "no {page} among {pages:?}");
        let text = std::fs::read_to_string(folder.path().join(&page)).unwrap();
        assert!(
            text.contains(&format!(".TH pubs-engine-{verb} 1")),
            "{page}: {text}"
        );
    }
    std::fs::write(folder.path().join("taken"), "").unwrap();
    pubs(folder.path(), &["man", "--out", "taken"])
        .assert_code(2)
        .assert_says(&["taken", "--out"]);
}

#[test]
fn doctor_says_where_recordings_and_live_views_find_room() {
    let folder = tempfile::tempdir().unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:8780");
    let report = pubs(folder.path(), &["doctor", "--json"]).json();
    let found = |name: &str| {
        let checks = report["checks"].as_array().unwrap();
        let check = checks.iter().find(|check| check["name"] == name);
        check
            .unwrap_or_else(|| panic!("no {name} in {report}"))
            .clone()
    };
    assert_eq!(found("recordings")["state"], "ok", "{report}");
    let dashboard = found("dashboard");
    assert_eq!(dashboard["state"], "warn", "{dashboard}");
    assert!(
        dashboard["cure"].as_str().unwrap().contains("--dashboard"),
        "{dashboard}"
    );
    found("foxglove");
    drop(taken);
    // A folder that cannot be written, if only because a file is in its place.
    let mut doctor = command(folder.path(), &["doctor", "--json"]);
    let answer = Answer::of(doctor.env("PUBS_RECORD", "/proc/recordings"));
    answer
        .assert_code(1)
        .assert_says(&["/proc", "--record DIR"]);
}
