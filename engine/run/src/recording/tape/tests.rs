#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::mpsc::channel;

use serde_json::{Value, json};

use super::*;
use crate::messages::BeliefMessage;
use crate::recording::{
    BINS, ChoiceVerdict, Header, RUN_FORMAT_VERSION, RunHeader, RunPreface, read, read_run, testing,
};

fn guard(number: u64) -> Entry {
    Entry::Guard(number, String::new())
}

#[test]
fn a_full_queue_drops_and_counts_and_never_waits() {
    let (open, gate) = channel();
    let (log, arrived) = channel();
    // A disk that takes nothing until the gate is opened.
    let dropped = Arc::default();
    let (entries, thread) =
        queue::start(Path::new("slow"), 3, Arc::clone(&dropped), move |entries| {
            let () = gate.recv().unwrap();
            for entry in entries {
                match entry {
                    Entry::Guard(number, _) => log.send(number).unwrap(),
                    _ => return Ok(()),
                }
            }
            Ok(())
        })
        .unwrap();
    let tape = Tape {
        way: Way::Queued(entries),
        dropped,
        guarded: Arc::default(),
    };
    let found_room: Vec<bool> = (0..5).map(|number| tape.send(guard(number))).collect();
    assert_eq!(found_room, [true, true, true, false, false]);
    assert_eq!(tape.clone().dropped.load(Ordering::Acquire), 2);
    open.send(()).unwrap();
    tape.send_and_wait(guard(5));
    tape.send_and_wait(Entry::End);
    assert_eq!(thread.join(), Ok(()));
    assert!(tape.send(guard(6)), "after the end nothing is missed");
    let arrived: Vec<u64> = arrived.iter().collect();
    assert_eq!(arrived, [0, 1, 2, 5]);
}

fn run_header() -> RunHeader {
    RunHeader {
        goals: vec![(0.1 + 0.2, 0), (1.0 / 3.0, 0)],
        goal_tolerance: 0.05,
        shield: Some((0.001, 0.3)),
        max_steps: 250,
        lockstep: true,
        belief_frequency: None,
        vector_unit: "portable".to_owned(),
        driver: "virtual-arm 0.1.0".to_owned(),
        driver_parameters: json!({ "params": { "world": "door2" } }),
        model: "segments 0.1.0".to_owned(),
        runtime: "tract".to_owned(),
        overrides: vec!["--set belief.particles=5".to_owned()],
        policies: Vec::new(),
        started: None,
    }
}

fn tick(number: u64, felt: bool) -> Tick {
    let observation = Observation {
        displacement: 0.1 * number as f64,
        forces_n: [1.0 / 3.0, -2.5, 1e-300],
    };
    Tick {
        tick: number,
        time_ns: 1_000_000_000 + number * 10_000_000,
        order_ns: 999,
        stopping: number == 2,
        felt: felt.then(|| (testing::frame(number), observation)),
    }
}

fn belief(error: Option<String>) -> BeliefStep {
    let mut message = BeliefMessage {
        step: 1,
        allowed: 0b10,
        displacement: 0.1,
        speed_m_s: -0.05,
        valid: true,
        ..BeliefMessage::default()
    };
    message.summary.mean = 1.0 / 7.0;
    message.readings = message.readings.map(|_| 1.0 / 3.0);
    BeliefStep {
        time_ns: 1_030_000_000,
        tick: 3,
        message,
        histogram: [1.0 / BINS as f32; BINS],
        recoveries: 2,
        error,
    }
}

fn choice(truth: Option<f64>) -> Choice {
    Choice {
        step: 1,
        time_ns: 1_040_000_000,
        belief: 1,
        truth,
        goal: 1,
        action: 1,
        verdict: ChoiceVerdict::Violation,
        error: truth.map(|_| "no action".to_owned()),
    }
}

#[test]
fn a_run_is_read_back_to_the_bit_and_keeps_its_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    let header = Header {
        format: RUN_FORMAT_VERSION,
        ..testing::header()
    };
    let run = run_header();
    let preface = RunPreface {
        header: &header,
        run: &run,
        object_toml: "a = 1",
        resolved_toml: "b = 2",
        policies: Vec::new(),
    };
    let limits = Limits {
        unit: "rad",
        lower: 0.0,
        upper: 2.0,
        goals: vec![0.3],
        tolerance: 0.05,
    };
    let recording = RecordingWriter::create_run(&file, &preface).unwrap();
    let recorder = RunRecorder::direct(recording, &limits).unwrap();
    let tape = recorder.tape();
    let ticks = [tick(1, true), tick(2, false), tick(3, true)];
    for tick in ticks {
        tape.send(Entry::Tick(tick));
    }
    let beliefs = [belief(None), belief(Some("what is felt".to_owned()))];
    let choices = [choice(None), choice(Some(0.5))];
    for (belief, choice) in beliefs.iter().zip(&choices) {
        tape.belief(belief.clone());
        tape.choice(choice.clone());
    }
    tape.dropped.store(4, Ordering::Release);
    tape.send(Entry::Guard(1_050_000_000, "interrupted".to_owned()));
    tape.send(Entry::Timing(1_050_000_000, LatenessReport::default()));
    tape.send(Entry::End);
    assert_eq!(locked_result(&tape), Ok(()));

    let back = read_run(&file).unwrap();
    assert_eq!((&back.header, &back.run), (&header, &run));
    assert_eq!(back.resolved_toml, "b = 2");
    assert_eq!(back.ticks, ticks);
    assert_eq!(back.beliefs, beliefs);
    assert_eq!(back.choices, choices);
    assert_eq!((back.dropped, back.loss), (4, None));
    assert_eq!(
        read(&file).unwrap().frames.len(),
        2,
        "calibrate reads it too"
    );
    assert_schemas(&std::fs::read(&file).unwrap());
}

fn locked_result(tape: &Tape) -> Result<(), RecordingError> {
    match &tape.way {
        Way::Direct(direct) => locked(direct).result.clone(),
        Way::Queued(_) => panic!("it writes directly"),
    }
}

/// Every message is as its schema says, which names all of its fields; every topic but /truth,
/// which the hand-made frames lack, has one.
fn assert_schemas(bytes: &[u8]) {
    let mut seen = BTreeMap::new();
    for message in mcap::MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        let topic = message.channel.topic.clone();
        let schema = message.channel.schema.as_ref().unwrap();
        let rules: Value = serde_json::from_slice(&schema.data).unwrap();
        let value: Value = serde_json::from_slice(&message.data).unwrap();
        if let Err(error) = jsonschema::validate(&rules, &value) {
            panic!("{topic}: {error}: {value}");
        }
        assert_eq!(
            value.as_object().unwrap().len(),
            rules["properties"].as_object().unwrap().len(),
            "{topic}: every field is described"
        );
        *seen.entry(topic).or_insert(0) += 1;
    }
    let expected = [
        ("/action", 2),
        ("/belief", 2),
        ("/controller", 3),
        ("/dropped", 1),
        ("/guard", 1),
        ("/limits", 1),
        ("/observation", 2),
        ("/policy", 2),
        ("/pose", 2),
        ("/timing", 1),
        ("/wrench", 2),
    ];
    let expected = expected.map(|(topic, count)| (topic.to_owned(), count));
    assert_eq!(seen, expected.into());
}
