//! The program as a user has it: built once, started in a folder of the test's own.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by tests that each use a part of it, and a test may fail"
)]

use std::ffi::OsStr;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;

use serde_json::Value;

/// The checkout.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

pub fn door2() -> String {
    path_text(&root().join("objects/door2.toml"))
}

pub fn door2_policy() -> String {
    path_text(&root().join("policies/door2.onnx"))
}

pub fn path_text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

/// Where this test was built to: `target/PROFILE`.
fn build_folder() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.ancestors().nth(2).unwrap().to_owned()
}

/// Builds with the profile of the tests themselves, so that nothing is compiled twice.
fn cargo_build(what: &[&str]) {
    let folder = build_folder();
    let profile = match folder.file_name().and_then(OsStr::to_str).unwrap() {
        "debug" => "dev",
        name => name,
    };
    // `cargo test` names itself here; its lock on the target folder is free while tests run.
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .current_dir(root())
        .args(["build", "--profile", profile, "--target-dir"])
        .arg(folder.parent().unwrap())
        .args(what)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "cargo build {what:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// The program, built on the first call.
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        cargo_build(&["--bin", "pubs-engine"]);
        build_folder().join(format!("pubs-engine{}", std::env::consts::EXE_SUFFIX))
    })
}

/// The observation model of `plugins/ramp.rs`, alone in `folder`.
pub fn ramp_in_rust(folder: &Path) -> PathBuf {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let name = format!("{prefix}ramp_in_rust{suffix}");
    let built = LIBRARY.get_or_init(|| {
        cargo_build(&["-p", "pubs-tests", "--example", "ramp_in_rust"]);
        build_folder().join("examples").join(&name)
    });
    let library = folder.join(&name);
    std::fs::copy(built, &library).unwrap();
    library
}

/// Where the plugins of this repository that are loaded lie, built on the first call.
pub fn shipped_plugins() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        cargo_build(&["--workspace"]);
        build_folder()
    })
}

/// The program with these arguments, started in `folder`, deaf to the settings of whoever runs the tests.
pub fn command<T: AsRef<OsStr>>(folder: &Path, arguments: &[T]) -> Command {
    command_of(program(), folder, arguments)
}

/// The same of a copy of the program.
pub fn command_of<T: AsRef<OsStr>>(program: &Path, folder: &Path, arguments: &[T]) -> Command {
    let mut command = Command::new(program);
    command.current_dir(folder).args(arguments);
    let own = |name: &OsStr| name.to_string_lossy().starts_with("PUBS_");
    for (name, _) in std::env::vars_os().filter(|(name, _)| own(name)) {
        command.env_remove(name);
    }
    command.env_remove("ORT_DYLIB_PATH").stdin(Stdio::null());
    command
}

/// What the program answered.
pub struct Answer {
    pub arguments: String,
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Answer {
    pub fn of(command: &mut Command) -> Self {
        let output = command.output().unwrap();
        Self::from_output(format!("{command:?}"), output)
    }

    /// A signal is a crash, whatever was asked.
    pub fn from_output(arguments: String, output: Output) -> Self {
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        let signal = output.status.signal();
        assert!(
            signal.is_none(),
            "{arguments}: died of signal {signal:?}: {stderr}"
        );
        assert!(!stderr.contains("panicked at"), "{arguments}: {stderr}");
        Self {
            arguments,
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr,
        }
    }

    pub fn assert_code(&self, code: i32) -> &Self {
        assert_eq!(
            self.code, code,
            "{}\nstdout: {}\nstderr: {}",
            self.arguments, self.stdout, self.stderr
        );
        self
    }

    /// Looks in both streams: a fault is a result of `check`, which goes to stdout, and talk elsewhere.
    pub fn assert_says(&self, words: &[&str]) -> &Self {
        let told = format!("{}{}", self.stdout, self.stderr);
        for word in words {
            assert!(
                told.contains(word),
                "{}\n`{word}` is missing in: {told}",
                self.arguments
            );
        }
        self
    }

    /// The one JSON object that is all of stdout.
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("{}: {error}: {}", self.arguments, self.stdout));
        assert!(value.is_object(), "{}: {value}", self.arguments);
        value
    }
}

/// Runs the program in `folder`.
pub fn pubs<T: AsRef<OsStr>>(folder: &Path, arguments: &[T]) -> Answer {
    Answer::of(&mut command(folder, arguments))
}

/// Sends a signal to a program that was started here.
pub fn signal(child: &Child, signal: i32) {
    let id = i32::try_from(child.id()).unwrap();
    // SAFETY: a plain system call, to a child that has not been waited for, so that the number is
    // still its own.
    let sent = unsafe { libc::kill(id, signal) };
    assert_eq!(sent, 0, "the signal did not go out");
}

/// Arguments in one line, none of which holds a space.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// Fails where a promised field is missing; fields beyond the promise are free to come and go.
pub fn assert_fields(value: &Value, fields: &[&str]) {
    for field in fields {
        assert!(
            value.get(field).is_some(),
            "`{field}` is missing in {value}"
        );
    }
}

/// The text of `objects/door2.toml` with another observation table.
pub fn door2_with_observation(observation: &str) -> String {
    let text = std::fs::read_to_string(door2()).unwrap();
    let (head, _) = text.split_once("\n[observation]\n").unwrap();
    format!("{head}\n[observation]\n{observation}\n")
}

/// Start of each occurrence.
pub fn all(bytes: &[u8], mark: &str) -> Vec<usize> {
    let windows = bytes.windows(mark.len()).enumerate();
    windows
        .filter(|(_, window)| *window == mark.as_bytes())
        .map(|(at, _)| at)
        .collect()
}

/// Takes the checksum off the chunk around `at` (0 stands for none), so that a changed value in it
/// passes for one that was recorded.
pub fn forgive(bytes: &mut [u8], at: usize) {
    let mut position = 8;
    loop {
        let length = u64::from_le_bytes(bytes[position + 1..position + 9].try_into().unwrap());
        let next = position + 9 + length as usize;
        if next > at {
            assert_eq!(bytes[position], 6, "a chunk holds the value");
            bytes[position + 33..position + 37].fill(0);
            return;
        }
        position = next;
    }
}
