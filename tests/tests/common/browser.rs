//! A real browser without a window, driven over WebDriver on loopback.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by tests that each use a part of it, and a test may fail"
)]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// No step of a test takes longer than this.
const PATIENCE: Duration = Duration::from_secs(30);

/// Chromium and what drives it; both end with the test.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
}

impl Browser {
    /// `None`, and a word about it, where Chromium and its driver are not installed.
    pub fn start() -> Option<Self> {
        let driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut driver) = driver else {
            println!("skipped: no chromedriver (Debian: apt-get install chromium chromium-driver)");
            return None;
        };
        let mut lines = BufReader::new(driver.stdout.take().unwrap()).lines();
        let port = lines.find_map(|line| {
            let line = line.ok()?;
            let (_, port) = line.split_once("started successfully on port ")?;
            port.trim_end_matches('.').parse().ok()
        });
        let mut browser = Self {
            driver,
            port: port.expect("chromedriver names its port"),
            session: String::new(),
        };
        let options = json!({ "args": [
            "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-quic",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
        ]});
        let capabilities =
            json!({ "goog:chromeOptions": options, "goog:loggingPrefs": { "browser": "ALL" } });
        let asked = json!({ "capabilities": { "alwaysMatch": capabilities } });
        let session = browser.request("POST", "/session", Some(&asked));
        browser.session = session["sessionId"].as_str().unwrap().to_owned();
        Some(browser)
    }

    pub fn open(&self, url: &str) {
        self.ask("/url", &json!({ "url": url }));
    }

    /// The value of a JavaScript expression.
    pub fn value(&self, expression: &str) -> Value {
        let script = format!("return {expression};");
        self.ask("/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// The text attribute `data-value` of an element, as the number that it is.
    pub fn number(&self, id: &str) -> f64 {
        let value = self.value(&format!("document.getElementById('{id}').dataset.value"));
        let text = value
            .as_str()
            .unwrap_or_else(|| panic!("#{id} shows {value}"));
        text.parse()
            .unwrap_or_else(|_| panic!("#{id} shows {text:?}"))
    }

    /// Waits until an expression is true.
    pub fn wait_for(&self, expression: &str) {
        let deadline = Instant::now() + PATIENCE;
        while self.value(expression) != Value::Bool(true) {
            let page = || self.value("document.body.innerText");
            assert!(Instant::now() < deadline, "never: {expression}\n{}", page());
            thread::sleep(Duration::from_millis(30));
        }
    }

    pub fn click(&self, id: &str) {
        let found = json!({ "using": "css selector", "value": format!("#{id}") });
        let element = self.ask("/element", &found);
        let name = element.as_object().unwrap().values().next().unwrap();
        let name = name.as_str().unwrap();
        self.ask(&format!("/element/{name}/click"), &json!({}));
    }

    /// A command of Chromium's own protocol.
    pub fn command(&self, name: &str, parameters: &Value) -> Value {
        let asked = json!({ "cmd": name, "params": parameters });
        self.ask("/goog/cdp/execute", &asked)
    }

    /// What the page has complained of.
    pub fn complaints(&self) -> Vec<String> {
        let log = self.ask("/se/log", &json!({ "type": "browser" }));
        let complaint = |entry: &Value| entry["message"].as_str().unwrap_or_default().to_owned();
        log.as_array().unwrap().iter().map(complaint).collect()
    }

    fn ask(&self, path: &str, body: &Value) -> Value {
        let path = format!("/session/{}{path}", self.session);
        self.request("POST", &path, Some(body))
    }

    fn request(&self, method: &str, path: &str, body: Option<&Value>) -> Value {
        let body = body.map(Value::to_string).unwrap_or_default();
        let (status, text) = http(self.port, method, path, &[], &body);
        let answer: Value = serde_json::from_str(&text).unwrap_or_default();
        assert_eq!(status, 200, "{method} {path} {body}: {text}");
        answer["value"].clone()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The browser ends with its session; a test that failed may have none.
        if !self.session.is_empty() && !thread::panicking() {
            self.request("DELETE", &format!("/session/{}", self.session), None);
        }
        _ = self.driver.kill();
        _ = self.driver.wait();
    }
}

/// One request to a server on loopback; its status and body.
pub fn http(
    port: u16,
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: &str,
) -> (u16, String) {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    let host = format!("127.0.0.1:{port}");
    let mut request = format!("{method} {path} HTTP/1.1\r\nConnection: close\r\n");
    if !headers.iter().any(|(name, _)| *name == "Host") {
        request += &format!("Host: {host}\r\n");
    }
    for (name, value) in headers {
        request += &format!("{name}: {value}\r\n");
    }
    request += &format!(
        "Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut stream = BufReader::new(stream);
    let mut line = String::new();
    stream.read_line(&mut line).unwrap();
    let status = line.split(' ').nth(1).and_then(|code| code.parse().ok());
    let mut length = None;
    loop {
        line.clear();
        stream.read_line(&mut line).unwrap();
        let line = line.trim_end().to_ascii_lowercase();
        if line.is_empty() {
            break;
        }
        if let Some(bytes) = line.strip_prefix("content-length:") {
            length = bytes.trim().parse().ok();
        }
    }
    let mut body = Vec::new();
    match length {
        Some(length) => {
            body.resize(length, 0);
            stream.read_exact(&mut body).unwrap();
        }
        None => _ = stream.read_to_end(&mut body).unwrap(),
    }
    (status.unwrap(), String::from_utf8(body).unwrap())
}
