//! Live views: the page in a real browser, the Foxglove server, and viewers that misbehave.
#![allow(clippy::unwrap_used, missing_docs)]

#[path = "common/browser.rs"]
mod browser;
mod common;
#[path = "common/watched.rs"]
mod watched;

use std::collections::HashMap;
use std::io::{BufReader, Read};
use std::net::TcpStream;
use std::path::Path;
use std::process::Command;

use browser::{Browser, http};
use common::{command, door2, door2_policy, words};
use serde_json::{Value, json};
use watched::{Foxglove, Messages, Watched, port, watch};

/// Messages of a recording by topic, read by a reader that is not ours.
fn messages(file: &Path) -> Messages {
    let bytes = std::fs::read(file).unwrap();
    let mut topics = Messages::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = topics.entry(message.channel.topic.clone()).or_default();
        topic.push((message.log_time, message.data.to_vec()));
    }
    topics
}

fn parsed(message: &(u64, Vec<u8>)) -> Value {
    serde_json::from_slice(&message.1).unwrap()
}

fn spread(belief: &Value) -> f64 {
    let histogram = &belief["histogram"];
    let number = |value: &Value| value.as_f64().unwrap();
    let (lower, upper) = (number(&histogram["lower"]), number(&histogram["upper"]));
    let mass = histogram["mass"].as_array().unwrap();
    let width = (upper - lower) / mass.len() as f64;
    let square = |(bin, part): (usize, &Value)| {
        let middle = lower + (bin as f64 + 0.5) * width;
        number(part) * (middle - number(&belief["mean"])).powi(2)
    };
    mass.iter().enumerate().map(square).sum::<f64>().sqrt()
}

#[test]
fn the_page_shows_what_is_recorded() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let line = "--goal 0.5 --goal 0.2 --dashboard 0 --wait-for-viewer --record seen.mcap";
    let mut run = Watched::start(folder.path(), line);
    browser.open(&run.address("dashboard"));
    browser.wait_for("document.body.dataset.state === 'live'");
    let shown = "{ step: document.getElementById('mean').dataset.step, \
        mean: document.getElementById('mean').dataset.value, \
        spread: document.getElementById('spread').dataset.value, \
        entropy: document.getElementById('entropy').dataset.value }";
    let during: Vec<Value> = (0..10)
        .map(|_| browser.value(&format!("({shown})")))
        .collect();
    browser.wait_for("document.body.dataset.state === 'ended'");
    browser.wait_for("document.getElementById('time').dataset.value > 3");
    // The last drawing may be a little behind the last message.
    browser.value("new Promise((done) => setTimeout(done, 200)).then(() => true)");
    let report = run.end().assert_code(0).json();
    let recorded = messages(&folder.path().join("seen.mcap"));
    let beliefs: HashMap<String, Value> = recorded["/belief"]
        .iter()
        .map(parsed)
        .map(|belief| (belief["step"].to_string(), belief))
        .collect();
    let mut compared = 0;
    for seen in during {
        let (Some(step), Some(mean)) = (seen["step"].as_str(), seen["mean"].as_str()) else {
            continue;
        };
        let number = |text: &Value| text.as_str().unwrap().parse::<f64>().unwrap();
        let belief = &beliefs[step];
        if mean.is_empty() {
            assert_eq!(belief["valid"], false, "step {step}");
            continue;
        }
        assert_eq!(
            number(&seen["mean"]),
            belief["mean"].as_f64().unwrap(),
            "step {step}"
        );
        assert_eq!(
            number(&seen["entropy"]),
            belief["entropy"].as_f64().unwrap(),
            "step {step}"
        );
        let spread = spread(belief);
        assert!(
            (number(&seen["spread"]) - spread).abs() < 1e-9,
            "step {step}: {spread}"
        );
        compared += 1;
    }
    assert!(
        compared > 0,
        "the page showed no belief while the arm moved"
    );
    let last = |topic: &str| parsed(recorded[topic].last().unwrap());
    let (belief, observation, action) = (last("/belief"), last("/observation"), last("/action"));
    for (id, expected) in [
        ("mean", &belief["mean"]),
        ("entropy", &belief["entropy"]),
        ("f_d", &observation["f_d"]),
        ("f_z", &observation["f_z"]),
        ("f_n", &observation["f_n"]),
        ("speed", &action["speed_m_s"]),
        ("goal", &report["goals"][1]["goal"]),
    ] {
        assert_eq!(browser.number(id), expected.as_f64().unwrap(), "#{id}");
    }
    let word = browser.value("document.getElementById('action').dataset.value");
    assert_eq!(word, action["action"]);
    assert_eq!(
        browser.value("document.getElementById('state').textContent"),
        "goal reached"
    );
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn the_stop_button_stops_the_arm() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // Long enough that only the button can end it this soon.
    let goals = "--goal 0.9 --goal 0.1 ".repeat(20);
    let line = format!("{goals}--dashboard 0 --wait-for-viewer --record stopped.mcap");
    let mut run = Watched::start(folder.path(), &line);
    browser.open(&run.address("dashboard"));
    browser.wait_for("document.getElementById('time').dataset.value > 1.5");
    browser.click("stop");
    browser.wait_for("document.body.dataset.state === 'stopped'");
    let report = run.end().assert_code(4).json();
    assert_eq!(report["outcome"], "safety_stop");
    assert_eq!(report["reason"], "interrupted");
    assert!(report["time_s"].as_f64().unwrap() < 30.0, "{report}");
    let banner = browser.value("document.getElementById('banner').textContent");
    assert!(banner.as_str().unwrap().contains("interrupted"), "{banner}");
    let recorded = messages(&folder.path().join("stopped.mcap"));
    let speeds: Vec<f64> = recorded["/action"]
        .iter()
        .map(|message| parsed(message)["speed_m_s"].as_f64().unwrap())
        .collect();
    assert!(
        speeds.iter().any(|speed| speed.abs() > 0.04),
        "the arm never moved"
    );
    assert_eq!(
        speeds.last(),
        Some(&0.0),
        "the arm does not rest at the end"
    );
    // 5 m/s² is the deceleration of every stop, and a tick lasts 10 ms.
    let steepest = speeds
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .fold(0.0, f64::max);
    assert!(
        steepest <= 0.05 + 1e-9,
        "one tick changes the speed by {steepest} m/s"
    );
}

#[test]
fn the_page_fits_a_phone_and_the_dark() {
    let Some(browser) = Browser::start() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let line = "--goal 0.5 --goal 0.2 --dashboard 0 --wait-for-viewer --no-record";
    let mut run = Watched::start(folder.path(), line);
    let screen = json!({ "width": 360, "height": 740, "deviceScaleFactor": 2, "mobile": true });
    browser.command("Emulation.setDeviceMetricsOverride", &screen);
    browser.open(&run.address("dashboard"));
    browser.wait_for("document.body.dataset.state === 'ended'");
    run.end().assert_code(0);
    let width = browser.value("document.documentElement.scrollWidth");
    assert!(width.as_u64().unwrap() <= 360, "the page is {width} wide");
    let button = browser.value("document.getElementById('stop').getBoundingClientRect().toJSON()");
    let (bottom, height) = (
        button["bottom"].as_f64().unwrap(),
        button["height"].as_f64().unwrap(),
    );
    assert!(
        bottom <= 740.0 && height >= 44.0,
        "the stop button is at {button}"
    );
    let luminance = "(selector, property) => { const colour = getComputedStyle(document.querySelector(selector))[property]; \
        const [r, g, b] = colour.match(/[0-9.]+/g).map((part) => { const c = part / 255; \
        return c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; }); \
        return 0.2126 * r + 0.7152 * g + 0.0722 * b; }";
    for (theme, is_dark) in [("dark", true), ("light", false)] {
        let features = json!({ "features": [{ "name": "prefers-color-scheme", "value": theme }] });
        browser.command("Emulation.setEmulatedMedia", &features);
        let of = |selector: &str, property: &str| {
            let value = browser.value(&format!("({luminance})('{selector}', '{property}')"));
            value.as_f64().unwrap()
        };
        let ground = of("section", "backgroundColor");
        assert_eq!(
            ground < 0.2,
            is_dark,
            "{theme}: the ground has luminance {ground}"
        );
        for selector in ["h2", "dd", "dt", ".legend", "figcaption", "td"] {
            let ink = of(selector, "color");
            let contrast = (ink.max(ground) + 0.05) / (ink.min(ground) + 0.05);
            assert!(
                contrast >= 4.5,
                "{theme}: {selector} has a contrast of {contrast:.1}"
            );
        }
        // What is drawn has to follow: the particle cloud's picture is not empty.
        let drawn = "(() => { const canvas = document.getElementById('object-picture'); \
            const bytes = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data; \
            return bytes.some((byte) => byte > 0); })()";
        assert_eq!(browser.value(drawn), true, "{theme}: nothing is drawn");
    }
}

#[test]
fn who_does_not_know_the_token_sees_nothing_and_stops_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let token = "not-to-be-guessed";
    let line = format!(
        "--goal 0.5 --dashboard 0 --foxglove 0 --token {token} --wait-for-viewer --no-record"
    );
    let mut run = Watched::start(folder.path(), &line);
    let address = run.address("dashboard");
    assert!(address.ends_with(&format!("/?token={token}")), "{address}");
    let foxglove = run.address("foxglove");
    let dashboard = port(&address);
    for (method, path) in [
        ("GET", "/scene.json"),
        ("GET", "/events"),
        ("POST", "/stop"),
        ("POST", "/stop?token=not-to-be-guesse"),
        ("GET", "/scene.json?token="),
    ] {
        let (status, text) = http(dashboard, method, path, &[], "");
        assert_eq!(status, 403, "{method} {path}: {text}");
        assert!(text.contains("token"), "{method} {path}: {text}");
    }
    let (status, text) = http(port(&foxglove), "GET", "/", &[], "");
    assert_eq!(status, 403, "{text}");
    let (status, page) = http(dashboard, "GET", "/", &[], "");
    assert!(
        status == 200 && page.contains("<title>"),
        "the page itself needs no token"
    );
    let (status, scene) = http(
        dashboard,
        "GET",
        &format!("/scene.json?token={token}"),
        &[],
        "",
    );
    assert_eq!(status, 200, "{scene}");
    // Whoever knows it may look, and then the arm begins.
    let viewer = watch(dashboard, &format!("/events?token={token}"));
    let report = run.end().assert_code(0).json();
    assert_eq!(report["outcome"], "reached");
    drop(viewer);
}

#[test]
fn a_page_of_another_site_sees_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Watched::start(
        folder.path(),
        "--goal 0.5 --dashboard 0 --wait-for-viewer --no-record",
    );
    let port = port(&run.address("dashboard"));
    for headers in [
        [("Host", "rebound.example"), ("Accept", "*/*")],
        [("Origin", "http://other.example"), ("Accept", "*/*")],
    ] {
        for (method, path) in [
            ("GET", "/scene.json"),
            ("GET", "/events"),
            ("POST", "/stop"),
        ] {
            let (status, text) = http(port, method, path, &headers, "");
            assert_eq!(status, 403, "{method} {path} {headers:?}: {text}");
        }
    }
    let viewer = watch(port, "/events");
    run.end().assert_code(0);
    drop(viewer);
}

#[test]
fn viewers_that_read_nothing_or_vanish_are_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let goals = "--goal 0.9 --goal 0.1 ".repeat(2);
    let line = format!("{goals}--dashboard 0 --wait-for-viewer --record slow.mcap");
    let mut run = Watched::start(folder.path(), &line);
    let port = port(&run.address("dashboard"));
    let silent: Vec<TcpStream> = (0..8).map(|_| watch(port, "/events")).collect();
    for _ in 0..4 {
        let mut vanishing = watch(port, "/events");
        vanishing.read_exact(&mut [0; 64]).unwrap();
    }
    let answer = run.end();
    let report = answer.assert_code(0).json();
    assert_eq!(report["recording_dropped"], 0, "{report}");
    assert_eq!(report["goals"].as_array().unwrap().len(), 4);
    drop(silent);
}

#[test]
fn without_a_recording_and_on_the_virtual_clock_viewers_see_all() {
    let folder = tempfile::tempdir().unwrap();
    let line = "--goal 0.5 --lockstep --seed 7 --dashboard 0 --wait-for-viewer --no-record";
    let mut run = Watched::start(folder.path(), line);
    let port = port(&run.address("dashboard"));
    let mut viewer = BufReader::new(watch(port, "/events"));
    let mut text = String::new();
    viewer.read_to_string(&mut text).unwrap();
    let report = run.end().assert_code(0).json();
    assert_eq!(report["recording"], Value::Null);
    let again = command(
        folder.path(),
        &[
            words("run"),
            vec![&door2()],
            vec!["--policy", &door2_policy()],
            words("--goal 0.5 --lockstep --seed 7 --record same.mcap"),
        ]
        .concat(),
    )
    .output()
    .unwrap();
    assert!(again.status.success());
    let seen = seen(&text);
    let beliefs: Vec<&Value> = seen
        .iter()
        .filter(|pair| pair[0] == "/belief")
        .map(|pair| &pair[1])
        .collect();
    let recorded = messages(&folder.path().join("same.mcap"));
    let expected: Vec<Value> = recorded["/belief"].iter().map(parsed).collect();
    assert_eq!(beliefs, expected.iter().collect::<Vec<_>>());
    assert_eq!(seen.last().unwrap()[0], "end");
    assert_eq!(seen.last().unwrap()[1]["outcome"], report["outcome"]);
}

#[test]
fn a_disk_that_is_full_does_not_blind_the_viewers() {
    let folder = tempfile::tempdir().unwrap();
    let (object, policy) = (door2(), door2_policy());
    // Room for object file and policy and a second of the run; what is beyond is an error.
    let line = format!(
        "trap '' XFSZ; ulimit -f 600; exec \"$0\" run {object} --policy {policy} --json \
         --goal 0.9 --goal 0.1 --dashboard 0 --wait-for-viewer --record full.mcap"
    );
    let program = common::program();
    let mut shell = Command::new("sh");
    shell
        .current_dir(folder.path())
        .arg("-c")
        .arg(&line)
        .arg(program);
    let mut run = Watched::of(&mut shell, &line);
    let port = port(&run.address("dashboard"));
    let mut text = String::new();
    let mut viewer = BufReader::new(watch(port, "/events"));
    viewer.read_to_string(&mut text).unwrap();
    let report = run.end().assert_code(3).json();
    let fault = report["recording_fault"].as_str().unwrap();
    assert!(fault.contains("full.mcap"), "{fault}");
    let seen = seen(&text);
    let last = seen.iter().rfind(|pair| pair[0] == "/policy").unwrap();
    assert_eq!(last[1]["verdict"], "done", "the viewer saw no end: {last}");
    assert_eq!(seen.last().unwrap()[0], "end");
}

/// The pairs of topic and message in a stream of events.
fn seen(text: &str) -> Vec<Value> {
    text.lines()
        .filter_map(|line| line.strip_prefix("data: "))
        .flat_map(|line| serde_json::from_str::<Vec<Value>>(line).unwrap())
        .collect()
}

#[test]
fn the_foxglove_app_is_given_the_topics_of_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "--goal 0.5 --foxglove 0 --token of-the-foxglove --wait-for-viewer --record fox.mcap";
    let mut run = Watched::start(folder.path(), line);
    let address = run.address("foxglove");
    let heard = Foxglove::connect(&address).hear_all();
    run.end().assert_code(0);
    let recorded = messages(&folder.path().join("fox.mcap"));
    for topic in [
        "/pose",
        "/wrench",
        "/belief",
        "/policy",
        "/action",
        "/observation",
    ] {
        let heard = heard.get(topic).map_or(&[][..], Vec::as_slice);
        assert!(
            heard.len() > 20,
            "{topic}: {} messages were heard",
            heard.len()
        );
        let recorded = &recorded[topic];
        let start = recorded.iter().position(|message| *message == heard[0]);
        let start =
            start.unwrap_or_else(|| panic!("{topic}: the first message was never recorded"));
        let part = &recorded[start..start + heard.len()];
        assert!(
            part == heard,
            "{topic}: what was heard is not what was recorded"
        );
    }
    assert_eq!(
        heard["/limits"].len(),
        1,
        "who comes late is told the limits once"
    );
}

#[test]
fn who_gives_up_waiting_for_a_viewer_has_moved_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let line = "--goal 0.5 --dashboard 0 --wait-for-viewer --record never.mcap";
    let mut run = Watched::start(folder.path(), line);
    run.address("dashboard");
    run.interrupt();
    run.end().assert_code(4).assert_says(&["nothing has moved"]);
    assert!(!folder.path().join("never.mcap").exists());
}

#[test]
fn bad_addresses_are_refused_before_anything_moves() {
    let folder = tempfile::tempdir().unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    for (options, words) in [
        (
            format!("--dashboard {port}"),
            &["--dashboard", "in use"][..],
        ),
        (
            format!("--foxglove 127.0.0.1:{port}"),
            &["--foxglove", "in use"],
        ),
        ("--dashboard robot:80".to_owned(), &["HOST:PORT"]),
        ("--dashboard 0 --token short".to_owned(), &["at least 12"]),
        (
            "--wait-for-viewer".to_owned(),
            &["--dashboard or --foxglove"],
        ),
    ] {
        let line = format!("--goal 0.5 --record never.mcap {options}");
        let run = Watched::start(folder.path(), &line);
        run.end().assert_code(2).assert_says(words);
        assert!(
            !folder.path().join("never.mcap").exists(),
            "{options}: something was recorded"
        );
    }
}
