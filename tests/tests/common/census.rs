//! Which texts of errors stand in the code, and whether a snapshot shows each.
//!
//! Looked at are the texts in `#[error("…")]` everywhere and those of the object file's faults.
//! What no command line can provoke is accounted for in `tests/errors/elsewhere.tsv`: source
//! file, text, and where else it is held or why it cannot be.
#![allow(
    clippy::unwrap_used,
    reason = "a test may fail, and says with what it failed"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::root;

/// Between two fixed pieces of a text stands no value longer than this, in bytes.
const LONGEST_VALUE: usize = 300;
/// Files of `engine/core/src/object` whose texts describe keys and are no faults.
const DESCRIPTIONS: [&str; 3] = ["keys.rs", "schema.rs", "json_schema.rs"];

/// A text in the code.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Text {
    /// Path in the checkout.
    file: String,
    literal: String,
}

/// The texts that neither a snapshot shows nor the list of the others names, and the entries of
/// the list that are of no use any more; a line each.
pub fn unaccounted(kept: &[String]) -> Vec<String> {
    let shown = one_line(&kept.join("\n"));
    let mut elsewhere = elsewhere();
    let mut missing = Vec::new();
    for text in texts() {
        let listed = elsewhere.remove(&(text.file.clone(), text.literal.clone()));
        let line = format!("{}\t{}", text.file, text.literal);
        match (is_shown(&text.literal, &shown), listed) {
            (true, Some(_)) => missing.push(format!("shown, but listed as well: {line}")),
            (false, None) => missing.push(line),
            _ => {}
        }
    }
    let stale = elsewhere.into_keys();
    missing.extend(stale.map(|(file, text)| format!("listed, but in no code: {file}\t{text}")));
    missing
}

/// The keys of the object file that no snapshot refuses. What is a plugin's own is left to it.
pub fn keys_never_refused(kept: &[String]) -> Vec<String> {
    let source = fs::read_to_string(root().join("engine/core/src/object/keys.rs")).unwrap();
    let shown = without_places(&kept.join("\n"));
    let keys = source.split(" key(\"").skip(1);
    let own = keys.filter(|entry| !entry.contains("Kind::Plugin"));
    own.filter_map(|entry| entry.split('"').next())
        .filter(|key| {
            let refused = ["is", "has", "goes"].map(|verb| format!("`{key}` {verb} "));
            !refused.iter().any(|words| shown.contains(words))
        })
        .map(str::to_owned)
        .collect()
}

/// `action.3.move` as the key table has it, `action.*.move`.
fn without_places(text: &str) -> String {
    let parts = text.split('.').map(|part| {
        let is_place = !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        if is_place { "*" } else { part }
    });
    parts.collect::<Vec<_>>().join(".")
}

/// Source file and text of what is accounted for without a snapshot.
fn elsewhere() -> BTreeMap<(String, String), String> {
    let file = root().join("tests/errors/elsewhere.tsv");
    let text = fs::read_to_string(&file).unwrap();
    let entries = text
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty());
    entries
        .map(|line| {
            let columns: Vec<&str> = line.split('\t').collect();
            let [file, text, why] = columns[..] else {
                panic!("elsewhere.tsv: three columns are wanted: {line}");
            };
            // Where a test holds the text, that test must be there.
            let path = why.split(' ').next().unwrap_or_default();
            let there = !path.ends_with(".rs") || root().join(path).is_file();
            assert!(there, "elsewhere.tsv: there is no {path}");
            ((file.to_owned(), text.to_owned()), why.to_owned())
        })
        .collect()
}

fn texts() -> BTreeSet<Text> {
    let mut files = Vec::new();
    for folder in ["engine", "plugins"] {
        sources(&root().join(folder), &mut files);
    }
    files.sort();
    let mut texts = BTreeSet::new();
    for file in files {
        let source = fs::read_to_string(&file).unwrap();
        let source = source
            .split("#[cfg(test)]\nmod tests {")
            .next()
            .unwrap_or_default();
        let name = file.strip_prefix(root()).unwrap().display().to_string();
        let literals = match is_of_faults(&name) {
            true => sentences(source),
            false => attributes(source),
        };
        texts.extend(literals.into_iter().map(|literal| Text {
            file: name.clone(),
            literal,
        }));
    }
    texts
}

/// Whether all texts of a file are those of faults.
fn is_of_faults(name: &str) -> bool {
    name.strip_prefix("engine/core/src/object/")
        .is_some_and(|rest| !DESCRIPTIONS.contains(&rest) && !rest.starts_with("tests/"))
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("tests") && !path.ends_with("benches") {
            sources(&path, files);
        } else if path.extension().is_some_and(|end| end == "rs") {
            files.push(path);
        }
    }
}

/// The texts of `#[error("…")]`.
fn attributes(source: &str) -> Vec<String> {
    let pieces = source.split("#[error(").skip(1);
    let literals = pieces.filter_map(|piece| literals(piece.trim_start()).into_iter().next());
    literals
        .filter(|(at, _)| *at == 0)
        .map(|(_, literal)| literal)
        .filter(|literal| has_words(literal))
        .collect()
}

/// The literals that are sentences: four words and more.
fn sentences(source: &str) -> Vec<String> {
    let all = literals(source).into_iter().map(|(_, literal)| literal);
    all.filter(|literal| literal.split_whitespace().count() >= 4 && has_words(literal))
        .collect()
}

/// Whether anything of a text is fixed.
fn has_words(literal: &str) -> bool {
    pieces(literal)
        .iter()
        .any(|piece| piece.contains(char::is_alphabetic))
}

/// The string literals of a source text and where they begin, white space made one space.
fn literals(source: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(at) = rest.find(['"', '/', '\'']) {
        let begun = source.len() - rest.len() + at;
        let piece = &rest[at..];
        rest = if piece.starts_with("//") {
            piece.split_once('\n').map_or("", |(_, after)| after)
        } else if let Some(inside) = piece.strip_prefix('"') {
            let (literal, after) = literal(inside);
            found.push((begun, one_line(&literal)));
            after
        } else {
            // A quotation mark as a letter is not the start of a text.
            let quoted = ["'\"'", "'\\\"'", "'/'"];
            let letter = quoted.into_iter().find(|letter| piece.starts_with(letter));
            &piece[letter.map_or(1, str::len)..]
        };
    }
    found
}

/// A literal without its escapes, and what comes after it.
fn literal(inside: &str) -> (String, &str) {
    let mut text = String::new();
    let mut letters = inside.char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            '"' => return (text, &inside[at + 1..]),
            '\\' => match letters.next() {
                // A line that goes on: the white space is no part of it.
                Some((_, '\n')) => {
                    while letters.as_str().starts_with([' ', '\n']) {
                        letters.next();
                    }
                }
                Some((_, 'n')) => text.push('\n'),
                Some((_, escaped)) => text.push(escaped),
                None => {}
            },
            letter => text.push(letter),
        }
    }
    (text, "")
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether the fixed pieces of a text follow each other somewhere in what is shown.
fn is_shown(literal: &str, shown: &str) -> bool {
    let pieces = pieces(literal);
    let Some((first, rest)) = pieces.split_first() else {
        return true;
    };
    shown.match_indices(first.as_str()).any(|(at, _)| {
        let mut after = &shown[at + first.len()..];
        rest.iter().all(|piece| {
            let found = after
                .find(piece.as_str())
                .filter(|gap| *gap <= LONGEST_VALUE);
            found
                .inspect(|gap| after = &after[gap + piece.len()..])
                .is_some()
        })
    })
}

/// What stands between the placeholders of a format text.
fn pieces(literal: &str) -> Vec<String> {
    let mut pieces = vec![String::new()];
    let mut letters = literal.chars().peekable();
    while let Some(letter) = letters.next() {
        let piece = pieces.last_mut().unwrap();
        match letter {
            '{' | '}' if letters.peek() == Some(&letter) => piece.extend(letters.next()),
            '{' => {
                letters.by_ref().find(|letter| *letter == '}');
                pieces.push(String::new());
            }
            letter => piece.push(letter),
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}
