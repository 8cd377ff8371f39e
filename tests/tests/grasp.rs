//! The handle slips out of the fingers, the object jams, somebody pulls it by hand: each is noticed
//! within its time and ends in a stop that nothing resumes after.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{door2, door2_policy, pubs};

/// When the trouble begins, s after the first command.
const BEGINS_S: f64 = 0.5;

#[test]
fn trouble_with_the_handle_is_noticed_in_time() {
    let (object, policy) = (door2(), door2_policy());
    let push = |force_n: f64| format!("push={{at_s={BEGINS_S},for_s=5.0,force_n={force_n}}}");
    // What befalls the object, the words that name it, and how long it may go unnoticed: half a
    // second of motion for a lost grasp, a reversal of which some may be lost besides; for forces
    // the time until they have risen.
    let cases = [
        (format!("slips_at_s={BEGINS_S}"), "lost grasp?", 0.8),
        (format!("jams_at_s={BEGINS_S}"), "force_limit_n", 0.6),
        (push(90.0), "force_limit_n", 0.3),
        (push(-90.0), "force_limit_n", 0.3),
        (push(30.0), "force_limit_n", 0.6),
    ];
    for (trouble, words, within_s) in cases {
        for seed in ["1", "2", "3"] {
            let folder = tempfile::tempdir().unwrap();
            let set = format!("driver.params.trouble.{trouble}");
            let arguments = [
                "run",
                &object,
                "--policy",
                &policy,
                "--goal",
                "0.9",
                "--lockstep",
                "--seed",
                seed,
                "--set",
                "driver.params.start=0.1",
                "--set",
                &set,
                "--json",
            ];
            let answer = pubs(folder.path(), &arguments);
            let report = answer.assert_code(4).json();
            let case = format!("{trouble}, seed {seed}");
            assert_eq!(report["outcome"], "safety_stop", "{case}: {report}");
            assert_eq!(report["guard_stops"], 1, "{case}: {report}");
            let reason = report["reason"].as_str().unwrap_or_default();
            assert!(reason.contains(words), "{case}: {reason}");
            let noticed_s = report["time_s"].as_f64().unwrap() - BEGINS_S;
            assert!(
                (0.0..within_s).contains(&noticed_s),
                "{case}: noticed after {noticed_s:.2} s, which may be {within_s} s"
            );
        }
    }
}

#[test]
fn a_handle_that_is_held_fast_from_the_start_is_not_pushed_for_ever() {
    let (object, policy) = (door2(), door2_policy());
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "run",
        &object,
        "--policy",
        &policy,
        "--goal",
        "0.5",
        "--lockstep",
        "--set",
        "driver.params.start=0.0",
        "--set",
        "driver.params.trouble.jams_at_s=0.0",
        "--json",
    ];
    let report = pubs(folder.path(), &arguments).json();
    assert_ne!(report["outcome"], "reached", "{report}");
    let time_s = report["time_s"].as_f64().unwrap();
    assert!(time_s < 6.0, "pushed for {time_s} s: {report}");
}
