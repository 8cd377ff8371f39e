//! A run with live views, and those who look at it.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by tests that each use a part of it, and a test may fail"
)]

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

use crate::common::{Answer, command, door2, door2_policy, signal, words};

/// A run with live views, on its way.
pub struct Watched {
    process: Child,
    stderr: BufReader<ChildStderr>,
    line: String,
}

impl Watched {
    /// Starts `run` of door2.
    pub fn start(folder: &Path, line: &str) -> Self {
        let (object, policy) = (door2(), door2_policy());
        let mut arguments = vec!["run", &object, "--policy", &policy, "--json"];
        arguments.extend(words(line));
        Self::of(&mut command(folder, &arguments), line)
    }

    pub fn of(command: &mut Command, line: &str) -> Self {
        let mut process = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let stderr = BufReader::new(process.stderr.take().unwrap());
        Self {
            process,
            stderr,
            line: line.to_owned(),
        }
    }

    /// The address that the program prints after `what`.
    pub fn address(&mut self, what: &str) -> String {
        let mut told = String::new();
        loop {
            let mut line = String::new();
            let count = self.stderr.read_line(&mut line).unwrap();
            assert!(count > 0, "no address of the {what} in: {told}");
            if let Some(address) = line.strip_prefix(&format!("{what}: ")) {
                return address.trim_end().to_owned();
            }
            told += &line;
        }
    }

    /// As Ctrl-C does.
    pub fn interrupt(&self) {
        signal(&self.process, libc::SIGINT);
    }

    /// Waits for the end.
    pub fn end(mut self) -> Answer {
        let mut told = Vec::new();
        self.stderr.read_to_end(&mut told).unwrap();
        let mut output = self.process.wait_with_output().unwrap();
        output.stderr = told;
        Answer::from_output(self.line, output)
    }
}

/// The port of an address.
pub fn port(address: &str) -> u16 {
    let (_, rest) = address.rsplit_once(':').unwrap();
    let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().unwrap()
}

/// A connection that asks for the events.
pub fn watch(port: u16, path: &str) -> TcpStream {
    let mut viewer = TcpStream::connect(("127.0.0.1", port)).unwrap();
    let request = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    viewer.write_all(request.as_bytes()).unwrap();
    viewer
        .set_read_timeout(Some(Duration::from_secs(30)))
        .unwrap();
    viewer
}

/// Time and bytes of messages, by topic.
pub type Messages = HashMap<String, Vec<(u64, Vec<u8>)>>;

/// A viewer that speaks as the Foxglove app does.
pub struct Foxglove(WebSocket<MaybeTlsStream<TcpStream>>);

impl Foxglove {
    pub fn connect(address: &str) -> Self {
        let mut request = address.into_client_request().unwrap();
        let protocol = "foxglove.sdk.v1".parse().unwrap();
        request
            .headers_mut()
            .insert("Sec-WebSocket-Protocol", protocol);
        Self(tungstenite::connect(request).unwrap().0)
    }

    /// Subscribes to every topic and hears until the server goes.
    pub fn hear_all(mut self) -> Messages {
        let mut topics: HashMap<u64, String> = HashMap::new();
        let mut heard = Messages::new();
        while let Ok(message) = self.0.read() {
            match message {
                Message::Text(text) => {
                    self.subscribe(&serde_json::from_str(&text).unwrap(), &mut topics)
                }
                // Messages carry the number of the subscription and their time.
                Message::Binary(bytes) if bytes[0] == 1 => {
                    let id = u32::from_le_bytes(bytes[1..5].try_into().unwrap());
                    let time_ns = u64::from_le_bytes(bytes[5..13].try_into().unwrap());
                    let topic = topics[&u64::from(id)].clone();
                    heard
                        .entry(topic)
                        .or_default()
                        .push((time_ns, bytes[13..].to_vec()));
                }
                _ => {}
            }
        }
        heard
    }

    /// To all channels that are announced.
    fn subscribe(&mut self, told: &Value, topics: &mut HashMap<u64, String>) {
        if told["op"] != "advertise" {
            return;
        }
        let mut asked = Vec::new();
        for channel in told["channels"].as_array().unwrap() {
            assert_eq!(channel["encoding"], "json", "{channel}");
            let id = channel["id"].as_u64().unwrap();
            topics.insert(id, channel["topic"].as_str().unwrap().to_owned());
            asked.push(json!({ "id": id, "channelId": id }));
        }
        let asked = json!({ "op": "subscribe", "subscriptions": asked }).to_string();
        self.0.send(Message::text(asked)).unwrap();
    }
}
