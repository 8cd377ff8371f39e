//! Snapshots: what the program answers to a command, word for word, beside what leads up to it.
//!
//! A file of `tests/errors` holds a word about itself and then cases:
//!
//! ```text
//! ## a radius that is not a number
//! change door.toml
//!     radius_m = 0.3
//!     =>
//!     radius_m = nan
//! $ pubs-engine check door.toml
//! [exit 2]
//! [stdout]
//! …
//! ```
//!
//! Every case has a folder of its own, with the files of `tests/errors/files` in it. Lines before
//! `$` prepare it ([`Step`]); in them and in the command `CHECKOUT`, `BUILD` and `PORT` stand for
//! the checkout, the folder of the built plugins, and a port that is taken. In what is kept,
//! places and versions are put back into those words.
#![allow(
    clippy::unwrap_used,
    reason = "a test may fail, and says with what it failed"
)]

use std::collections::BTreeMap;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use crate::common::{Answer, command, command_of, path_text, root, shipped_plugins};
use crate::damage;
use crate::in_time::answer_in_time;

/// Where the snapshots lie.
pub fn folder() -> PathBuf {
    root().join("tests/errors")
}

/// One file of cases.
pub struct Family {
    pub file: PathBuf,
    /// What stands before the first case.
    preface: String,
    pub cases: Vec<Case>,
}

/// One command and its answer.
pub struct Case {
    pub title: String,
    /// The lines before the command, as they stand.
    given: String,
    steps: Vec<Step>,
    line: String,
    /// The answer as it is kept.
    pub kept: String,
}

/// What is done before the command.
#[derive(Debug)]
enum Step {
    /// `change FILE`: a text that stands in a file once, `=>`, and what takes its place.
    Change(String, String, String),
    /// `file NAME`: writes a file.
    File(String, String),
    /// `copy FROM NAME`.
    Copy(String, String),
    /// `cut FILE BYTES`: keeps its first bytes.
    Cut(String, usize),
    /// `flip FILE PLACE`: turns the bits of a byte over.
    Flip(String, usize),
    /// `overwrite FILE`: a change of bytes that leaves the length as it is.
    Overwrite(String, String, String),
    /// `foreign-policy FILE`: takes the contract out.
    ForeignPolicy(String),
    /// `foreign-mcap NAME`: writes another program's.
    ForeignMcap(String),
    /// `ramp NAME FAULT`: a plugin in C that is broken.
    Ramp(String, Option<String>),
    /// `folder NAME`.
    Folder(String),
    /// `environment NAME=VALUE`.
    Environment(String, String),
    /// `before COMMAND`: one that succeeds. It is run once, on the files as they are at first, and
    /// what it writes is put into each folder that asks for it.
    Before(String),
}

/// Every family, by name.
pub fn families() -> Vec<Family> {
    let entries = fs::read_dir(folder()).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "txt"));
    files.sort();
    files.into_iter().map(Family::read).collect()
}

impl Family {
    fn read(file: PathBuf) -> Self {
        let text = fs::read_to_string(&file).unwrap();
        let (preface, cases) = text.split_once("\n## ").unwrap_or((&text, ""));
        let cases = cases.split("\n## ").filter(|case| !case.is_empty());
        Self {
            preface: preface.to_owned(),
            cases: cases.map(|case| Case::read(case, &file)).collect(),
            file,
        }
    }

    /// Writes the file with other answers, case by case.
    pub fn write(&self, answers: &[String]) {
        let mut text = format!("{}\n", self.preface.trim_end());
        for (case, answer) in self.cases.iter().zip(answers) {
            text += &format!(
                "\n## {}\n{}$ {}\n{answer}",
                case.title, case.given, case.line
            );
        }
        fs::write(&self.file, text).unwrap();
    }
}

impl Case {
    fn read(text: &str, file: &Path) -> Self {
        let (title, rest) = text.split_once('\n').unwrap_or((text, ""));
        let at = match rest.starts_with("$ ") {
            true => 0,
            false => {
                1 + rest.find("\n$ ").unwrap_or_else(|| {
                    panic!("{}: {title}: no line begins with `$ `", file.display())
                })
            }
        };
        let (given, asked) = rest.split_at(at);
        let (line, kept) = asked.split_once('\n').unwrap_or((asked, ""));
        Self {
            title: title.to_owned(),
            given: given.to_owned(),
            steps: steps(given),
            line: line["$ ".len()..].to_owned(),
            kept: format!("{}\n", kept.trim_end_matches('\n')),
        }
    }

    /// What the program answers today; what is kept, where this machine cannot try the case.
    pub fn answer(&self) -> String {
        let place = tempfile::tempdir().unwrap();
        let taken = TcpListener::bind("127.0.0.1:0").unwrap();
        let bench = Bench {
            folder: place.path(),
            port: taken.local_addr().unwrap().port(),
        };
        copy_files(&folder().join("files"), place.path());
        let mut environment = Vec::new();
        for step in &self.steps {
            if !bench.take(step, &mut environment, &self.title) {
                println!("skipped: {}: no C compiler (`cc`)", self.title);
                return self.kept.clone();
            }
        }
        bench.shown(&bench.run(&self.line, &environment))
    }
}

/// Names and contents.
type Files = Vec<(String, Vec<u8>)>;

/// Where a case is tried.
struct Bench<'a> {
    folder: &'a Path,
    port: u16,
}

impl Bench<'_> {
    /// Takes one step; false where this machine lacks what it needs.
    fn take(&self, step: &Step, environment: &mut Vec<(String, String)>, title: &str) -> bool {
        match step {
            Step::Change(file, old, new) => {
                let text = self.text(file);
                let count = text.matches(old.as_str()).count();
                assert_eq!(count, 1, "{title}: {file} has this {count} times: {old}");
                self.write(file, text.replacen(old, new, 1).as_bytes());
            }
            Step::File(name, text) => self.write(name, text.as_bytes()),
            Step::Copy(from, name) => {
                let from = self.folder.join(self.meant(from));
                fs::copy(&from, self.folder.join(name))
                    .unwrap_or_else(|error| panic!("{title}: {}: {error}", from.display()));
            }
            Step::Cut(name, bytes) => {
                let mut content = fs::read(self.folder.join(name)).unwrap();
                content.truncate(*bytes);
                self.write(name, &content);
            }
            Step::Flip(name, at) => damage::flip(&self.folder.join(name), *at),
            Step::Overwrite(name, old, new) => {
                damage::overwrite(&self.folder.join(name), old, new);
            }
            Step::ForeignPolicy(name) => damage::without_contract(&self.folder.join(name)),
            Step::ForeignMcap(name) => damage::foreign_mcap(&self.folder.join(name)),
            Step::Ramp(name, fault) => {
                return damage::ramp(&self.folder.join(name), fault.as_deref());
            }
            Step::Folder(name) => fs::create_dir_all(self.folder.join(name)).unwrap(),
            Step::Environment(name, value) => {
                environment.push((name.clone(), self.meant(value)));
            }
            Step::Before(line) => {
                for (name, content) in self.written_by(line) {
                    self.write(&name, &content);
                }
            }
        }
        true
    }

    /// Names and contents of the files that a command writes.
    fn written_by(&self, line: &str) -> Files {
        static WRITTEN: Mutex<BTreeMap<String, Files>> = Mutex::new(BTreeMap::new());
        let mut written = WRITTEN.lock().unwrap();
        let files = written.entry(line.to_owned()).or_insert_with(|| {
            let place = tempfile::tempdir().unwrap();
            copy_files(&folder().join("files"), place.path());
            let bench = Bench {
                folder: place.path(),
                port: self.port,
            };
            let answer = bench.run(line, &[]);
            assert_eq!(answer.code, 0, "{line}: {}", answer.stderr);
            let entries = fs::read_dir(place.path()).unwrap();
            let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            let new = names.filter(|name| !folder().join("files").join(name).exists());
            new.map(|name| (name.clone(), fs::read(place.path().join(name)).unwrap()))
                .collect()
        });
        files.clone()
    }

    fn text(&self, file: &str) -> String {
        fs::read_to_string(self.folder.join(file)).unwrap()
    }

    fn write(&self, file: &str, content: &[u8]) {
        fs::write(self.folder.join(file), content).unwrap();
    }

    fn run(&self, line: &str, environment: &[(String, String)]) -> Answer {
        let words: Vec<String> = split(line).iter().map(|word| self.meant(word)).collect();
        let mut command = match words[0].as_str() {
            "pubs-engine" => command(self.folder, &words[1..]),
            // A copy in the case's own folder, which has no plugins beside it.
            "./pubs-engine" => {
                command_of(&self.folder.join("pubs-engine"), self.folder, &words[1..])
            }
            other => panic!("{other} is not this program: {line}"),
        };
        for name in ["COLUMNS", "NO_COLOR", "CLICOLOR_FORCE"] {
            command.env_remove(name);
        }
        answer_in_time(line, command.envs(environment.iter().cloned()))
    }

    /// The words that stand for places, as these places.
    fn meant(&self, text: &str) -> String {
        let mut text = text.replace("CHECKOUT", &path_text(root()));
        if text.contains("BUILD") {
            text = text.replace("BUILD", &path_text(shipped_plugins()));
        }
        text.replace("PORT", &self.port.to_string())
    }

    /// An answer as it is kept: the same in every checkout and every version.
    fn shown(&self, answer: &Answer) -> String {
        let mut text = format!("[exit {}]\n", answer.code);
        for (name, stream) in [("stdout", &answer.stdout), ("stderr", &answer.stderr)] {
            if !stream.is_empty() {
                text += &format!("[{name}]\n{}\n", self.placeless(stream).trim_end());
            }
        }
        text
    }

    fn placeless(&self, text: &str) -> String {
        let mut text = text.replace(&path_text(self.folder), "FOLDER");
        // The build's folder lies in the checkout as a rule.
        let build = std::env::current_exe().unwrap();
        let build = build.ancestors().nth(2).unwrap();
        for (place, name) in [(build, "BUILD"), (root(), "CHECKOUT")] {
            text = text.replace(&path_text(place), name);
        }
        text.replace(&format!("127.0.0.1:{}", self.port), "127.0.0.1:PORT")
            .replace(env!("CARGO_PKG_VERSION"), "VERSION")
    }
}

fn copy_files(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

/// The steps of the lines before a command; what belongs to a step is set in by four spaces.
fn steps(given: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut lines = given.lines().peekable();
    while let Some(line) = lines.next() {
        let mut block = Vec::new();
        while let Some(line) = lines.next_if(|line| line.starts_with("    ") || line.is_empty()) {
            block.push(line.get(4..).unwrap_or_default());
        }
        steps.push(step(line, &block));
    }
    steps
}

fn step(line: &str, block: &[&str]) -> Step {
    let (verb, rest) = line.split_once(' ').unwrap_or((line, ""));
    let owned = |text: &str| text.to_owned();
    let two = || {
        let (first, second) = rest.split_once(' ').unwrap();
        (owned(first), owned(second))
    };
    match verb {
        "change" | "overwrite" => {
            let middle = block.iter().position(|line| *line == "=>").unwrap();
            let (old, new) = (block[..middle].join("\n"), block[middle + 1..].join("\n"));
            match verb {
                "change" => Step::Change(owned(rest), old, new),
                _ => Step::Overwrite(owned(rest), old, new),
            }
        }
        "file" => Step::File(owned(rest), format!("{}\n", block.join("\n"))),
        "copy" => {
            let (from, name) = two();
            Step::Copy(from, name)
        }
        "cut" => {
            let (file, bytes) = two();
            Step::Cut(file, bytes.parse().unwrap())
        }
        "flip" => {
            let (file, at) = two();
            Step::Flip(file, at.parse().unwrap())
        }
        "foreign-policy" => Step::ForeignPolicy(owned(rest)),
        "foreign-mcap" => Step::ForeignMcap(owned(rest)),
        "ramp" => {
            let (name, fault) = rest.split_once(' ').unwrap_or((rest, ""));
            Step::Ramp(owned(name), (!fault.is_empty()).then(|| owned(fault)))
        }
        "folder" => Step::Folder(owned(rest)),
        "environment" => {
            let (name, value) = rest.split_once('=').unwrap();
            Step::Environment(owned(name), owned(value))
        }
        "before" => Step::Before(owned(rest)),
        _ => panic!("no step of a case begins with {verb:?}: {line}"),
    }
}

/// The words of a command line; single quotes hold spaces.
fn split(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word = None::<String>;
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '\'' => {
                quoted = !quoted;
                word.get_or_insert_default();
            }
            ' ' if !quoted => words.extend(word.take()),
            _ => word.get_or_insert_default().push(letter),
        }
    }
    words.extend(word);
    words
}
