//! A MELFA controller on loopback, started for one test and ended with it.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by tests that each use a part of it, and a test may fail"
)]

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::common::{Answer, command, path_text, root, shipped_plugins};

/// The emulator's process, its ports and its control socket.
pub struct Emulator {
    process: Child,
    ports: Value,
    control: BufReader<TcpStream>,
}

impl Emulator {
    /// Starts one with fingers that close at the first motion, as somebody would do it.
    pub fn start(arguments: &[&str]) -> Self {
        let program =
            shipped_plugins().join(format!("melfa-emulator{}", std::env::consts::EXE_SUFFIX));
        let ports = [
            "--r3-port",
            "--mxt-port",
            "--monitor-port",
            "--control-port",
        ];
        let mut process = Command::new(program)
            .args(ports.iter().flat_map(|port| [*port, "0"]))
            .args(["--grasp", "on-motion", "--mxtout", "100"])
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut stdout = BufReader::new(process.stdout.take().unwrap());
        stdout.read_line(&mut line).unwrap();
        let ports: Value = serde_json::from_str(&line).unwrap();
        let port = ports["control"].as_u64().unwrap() as u16;
        let control = TcpStream::connect(("127.0.0.1", port)).unwrap();
        control
            .set_read_timeout(Some(Duration::from_secs(10)))
            .unwrap();
        Self {
            process,
            ports,
            control: BufReader::new(control),
        }
    }

    /// What `run` needs to reach it; the shipped objects were made with the virtual arm's sensor.
    pub fn settings(&self) -> Vec<String> {
        let port = |name: &str| format!("driver.params.{name}_port={}", self.ports[name]);
        let params = [
            "driver.params.host=127.0.0.1".to_owned(),
            port("r3"),
            port("mxt"),
            port("monitor"),
            "driver.params.sensor=virtual-arm".to_owned(),
            "driver.params.log=true".to_owned(),
        ];
        let words = params.into_iter().flat_map(|set| ["--set".to_owned(), set]);
        ["--driver", "melfa"]
            .map(str::to_owned)
            .into_iter()
            .chain(words)
            .collect()
    }

    /// One command over the control socket.
    pub fn tell(&mut self, command: &Value) -> Value {
        let stream = self.control.get_mut();
        stream.write_all(format!("{command}\n").as_bytes()).unwrap();
        let mut line = String::new();
        self.control.read_line(&mut line).unwrap();
        let answer: Value = serde_json::from_str(&line).unwrap();
        assert_eq!(answer["ok"], true, "{command}: {answer}");
        answer
    }

    /// What is true of arm and object just now.
    pub fn state(&mut self) -> Value {
        self.tell(&json!({ "do": "state" }))
    }

    /// Waits until `met` holds; false where it does not in time.
    pub fn wait(&mut self, seconds: f64, met: impl Fn(&Value) -> bool) -> bool {
        let begun = Instant::now();
        while begun.elapsed().as_secs_f64() < seconds {
            if met(&self.state()) {
                return true;
            }
            thread::sleep(Duration::from_millis(20));
        }
        false
    }

    /// Waits until the arm moves, and a little longer.
    pub fn wait_for_motion(&mut self) {
        let moves = |state: &Value| state["tool_speed_m_s"].as_f64().unwrap() > 0.02;
        assert!(self.wait(20.0, moves), "the arm never moved");
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The words of a run of a shipped object with a shipped policy, goals one after the other.
pub fn run_words(object: &str, policy: &str, goals: &[&str], settings: &[String]) -> Vec<String> {
    let object = path_text(&root().join(format!("objects/{object}.toml")));
    let policy = path_text(&root().join("policies").join(policy));
    let plugins = path_text(shipped_plugins());
    let fixed = [
        "run",
        &object,
        "--policy",
        &policy,
        "--json",
        "--plugin-dir",
        &plugins,
        "--no-record",
    ];
    let goals = goals.iter().flat_map(|goal| ["--goal", goal]);
    let words = fixed.into_iter().chain(goals).map(str::to_owned);
    words.chain(settings.iter().cloned()).collect()
}

/// A run under way, in a folder of its own.
pub struct Running {
    process: Option<Child>,
    words: String,
    _folder: tempfile::TempDir,
}

impl Running {
    pub fn start(words: &[String]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let process = command(folder.path(), words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self {
            process: Some(process),
            words: words.join(" "),
            _folder: folder,
        }
    }

    pub fn signal(&self, signal: i32) {
        crate::common::signal(self.process.as_ref().unwrap(), signal);
    }

    /// Waits for its answer; one that was killed has none.
    pub fn end(mut self) -> Answer {
        let output = self.process.take().unwrap().wait_with_output().unwrap();
        Answer::from_output(self.words.clone(), output)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(process) = &mut self.process {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}
