//! Every text with which the program refuses something, word for word (`tests/errors`).
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "common/census.rs"]
mod census;
mod common;
#[path = "common/damage.rs"]
mod damage;
#[path = "common/in_time.rs"]
mod in_time;
#[path = "common/snapshots.rs"]
mod snapshots;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use similar::TextDiff;
use snapshots::{Case, Family, families};

/// Set to write the snapshots anew.
const UPDATE: &str = "UPDATE_SNAPSHOTS";

/// What each case of each family is answered today.
fn answers(families: &[Family]) -> Vec<Vec<String>> {
    let all: Vec<&Case> = families.iter().flat_map(|family| &family.cases).collect();
    let answers = Mutex::new(vec![String::new(); all.len()]);
    let next = AtomicUsize::new(0);
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some(index) = Some(next.fetch_add(1, Ordering::Relaxed))
                    && let Some(case) = all.get(index)
                {
                    let answer = case.answer();
                    answers.lock().unwrap()[index] = answer;
                }
            });
        }
    });
    let mut answers = answers.into_inner().unwrap().into_iter();
    families
        .iter()
        .map(|family| answers.by_ref().take(family.cases.len()).collect())
        .collect()
}

#[test]
fn every_error_reads_as_it_is_kept() {
    let families = families();
    let answers = answers(&families);
    if std::env::var_os(UPDATE).is_some() {
        for (family, answers) in families.iter().zip(&answers) {
            family.write(answers);
        }
        return;
    }
    let mut differences = String::new();
    for (family, answers) in families.iter().zip(&answers) {
        for (case, answer) in family.cases.iter().zip(answers) {
            if case.kept != *answer {
                differences += &difference(family, case, answer);
            }
        }
    }
    assert!(
        differences.is_empty(),
        "{differences}\n{UPDATE}=1 writes the snapshots anew; read what changes"
    );
}

fn difference(family: &Family, case: &Case, answer: &str) -> String {
    let name = family.file.file_name().unwrap_or_default().display();
    let diff = TextDiff::from_lines(&case.kept, answer);
    let diff = diff.unified_diff().context_radius(3).to_string();
    format!("\n{name}: {}\n{diff}", case.title)
}

/// A text for people has no value as the compiler prints it, and no trace of a crash.
#[test]
fn no_text_shows_the_insides_of_the_program() {
    let insides = [
        "Some(",
        "None)",
        "Os {",
        "Error {",
        "Custom {",
        "kind: ",
        "Ok(",
        "Err(",
        "RUST_BACKTRACE",
    ];
    for family in families() {
        for case in &family.cases {
            for word in insides {
                let name = family.file.display();
                assert!(!case.kept.contains(word), "{name}: {}: {word}", case.title);
            }
        }
    }
}

fn kept() -> Vec<String> {
    let cases = families().into_iter().flat_map(|family| family.cases);
    cases.map(|case| case.kept).collect()
}

#[test]
fn every_text_in_the_code_is_in_a_snapshot_or_accounted_for() {
    let missing = census::unaccounted(&kept());
    assert!(
        missing.is_empty(),
        "no snapshot shows these texts; add a case to tests/errors, or the reason why there can be none \
         to tests/errors/elsewhere.tsv:\n{}",
        missing.join("\n")
    );
}

#[test]
fn every_key_of_the_object_file_is_refused_in_a_snapshot() {
    let missing = census::keys_never_refused(&kept());
    assert!(
        missing.is_empty(),
        "no snapshot refuses a value of these keys; add them to tests/errors/objects-values.txt:\n{}",
        missing.join("\n")
    );
}
