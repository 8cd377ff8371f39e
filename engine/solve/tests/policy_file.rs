//! Policy files: what is written is read back, and what is broken is refused in words.

mod problems;

use std::ops::ControlFlow;
use std::path::PathBuf;

use pubs_solve::{AlphaPolicy, Pomdp, PomdpError, PomdpParts, SolveOptions, solve};

fn policy(pomdp: &Pomdp) -> AlphaPolicy {
    solve(pomdp, &SolveOptions::default(), |_| {
        ControlFlow::Continue(())
    })
    .policy
}

fn path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    std::fs::create_dir_all(&folder).expect("the folder for tests can be made");
    folder.join(name)
}

#[test]
fn a_policy_is_read_back_to_the_last_bit() {
    let pomdp = problems::file("tiger");
    let written = policy(&pomdp);
    let path = path("tiger.json");
    written.write(&path).expect("the folder can be written");
    let read = AlphaPolicy::read(&path).expect("the file is whole");
    assert_eq!(read, written);
    read.check_problem(&pomdp).expect("it is the same problem");
    for weight in [0.01, 0.2, 0.5, 0.9] {
        let belief = [weight, 1.0 - weight];
        assert_eq!(read.choose(&belief), written.choose(&belief));
    }
    let other = read
        .check_problem(&problems::file("two_state"))
        .expect_err("another problem");
    assert!(other.to_string().contains("`tiger`"), "{other}");
}

#[test]
fn broken_files_are_refused_in_words() {
    let whole = policy(&problems::file("two_state"));
    let path = path("broken.json");
    whole.write(&path).expect("the folder can be written");
    let text = std::fs::read_to_string(&path).expect("it was written");
    for (broken, words) in [
        ("{}".to_owned(), "missing field `format`"),
        (
            text.replace("pubs-solve alpha vectors", "else"),
            "its format is `else`",
        ),
        (
            text.replace("\"version\":1", "\"version\":2"),
            "its version is 2",
        ),
        (
            text.replace("\"states\":2", "\"states\":3"),
            "has 2 values for 3 states",
        ),
        (
            text.replace("\"action\":1", "\"action\":9"),
            "action number 9",
        ),
        (text[..text.len() / 2].to_owned(), "EOF"),
    ] {
        assert_ne!(broken, text, "the case {words} changes nothing");
        std::fs::write(&path, broken).expect("the folder can be written");
        let error = AlphaPolicy::read(&path).expect_err(words).to_string();
        assert!(error.contains(words), "{error}, not {words}");
    }
    std::fs::remove_file(&path).expect("it was written");
    let error = AlphaPolicy::read(&path)
        .expect_err("it is gone")
        .to_string();
    assert!(error.starts_with("cannot read"), "{error}");
}

#[test]
fn parts_that_do_not_hold_together_are_refused() {
    let whole = || PomdpParts {
        name: "one".to_owned(),
        states: vec!["a".to_owned(), "b".to_owned()],
        actions: vec!["go".to_owned()],
        observations: vec!["x".to_owned()],
        discount: 0.9,
        start: vec![1.0, 0.0],
        transitions: vec![vec![vec![(1, 0.5), (0, 0.25), (1, 0.25)], vec![(1, 1.0)]]],
        observation_rows: vec![vec![vec![(0, 1.0)], vec![(0, 1.0)]]],
        rewards: vec![vec![1.0, 0.0]],
    };
    let pomdp = Pomdp::new(whole()).expect("the parts are whole");
    assert_eq!(
        pomdp.transition(0, 0).collect::<Vec<_>>(),
        [(0, 0.25), (1, 0.75)]
    );
    assert!(pomdp.is_terminal(1) && !pomdp.is_terminal(0));
    type Case = (fn(&mut PomdpParts), &'static str);
    let cases: [Case; 9] = [
        (|parts| parts.states.clear(), "at least one state"),
        (|parts| parts.discount = 1.0, "the discount is 1"),
        (|parts| parts.discount = f64::NAN, "the discount is NaN"),
        (
            |parts| parts.start = vec![1.0],
            "the initial belief has 1 entries, 2 are needed",
        ),
        (
            |parts| parts.start = vec![0.7, 0.7],
            "the initial belief sums to 1.4",
        ),
        (
            |parts| parts.transitions[0][1] = vec![(2, 1.0)],
            "names number 2",
        ),
        (
            |parts| parts.transitions[0][1] = vec![(0, -0.5), (1, 1.5)],
            "probability -0.5",
        ),
        (
            |parts| parts.observation_rows[0][0].clear(),
            "action `go` and state `a` sums to 0",
        ),
        (
            |parts| parts.rewards[0][1] = f64::INFINITY,
            "state `b` is inf",
        ),
    ];
    for (change, words) in cases {
        let mut parts = whole();
        change(&mut parts);
        let error: PomdpError = Pomdp::new(parts).expect_err(words);
        assert!(error.to_string().contains(words), "{error}, not {words}");
    }
}
