//! The services over sockets on loopback, with a client of raw bytes.

#![allow(clippy::unwrap_used)]

mod client;

use std::net::{TcpListener, TcpStream};
use std::thread::sleep;
use std::time::{Duration, Instant};

use client::{
    PATIENCE, Ports, R3, Udp, control, f32_at, local, monitor_end, monitor_start, mxt, target,
    u16_at, u32_at,
};
use pubs_melfa_emulator::{Emulator, Options};

fn emulator(words: &[&str]) -> (Emulator, Ports) {
    let defaults = [
        "--world",
        "drawer1",
        "--start",
        "0.4",
        "--r3-port",
        "0",
        "--mxt-port",
        "0",
        "--monitor-port",
        "0",
        "--servo-delay-ms",
        "50",
    ];
    let options = Options::from_words(&[&defaults, words].concat()).unwrap();
    let emulator = Emulator::start(&options).unwrap();
    let ports = emulator.ports();
    let ports = Ports {
        r3: ports.r3,
        mxt: ports.mxt,
        monitor: ports.monitor,
        control: ports.control,
    };
    (emulator, ports)
}

#[test]
fn whole_session_of_a_client_that_sends_no_open() {
    let (_emulator, ports) = emulator(&[]);
    let mut r3 = R3::connect(ports.r3);
    r3.start_program("MXT 1,0,10");
    let udp = Udp::to(ports.mxt);
    let first = udp.exchange(&mxt(0, 0));
    assert_eq!(
        (u16_at(&first, 2), u16_at(&first, 4)),
        (7, 7),
        "type of the first slot"
    );
    assert_eq!(u16_at(&first, 64), 8, "type of the second slot");
    assert_eq!(u32_at(&first, 40), 7, "posture");
    assert_eq!(u32_at(&first, 60), 1, "one packet so far");
    let start = Instant::now();
    let mut last = first.clone();
    // 8 mm upwards, slowly: the grasp gives way.
    for step in 1..=200 {
        last = udp.exchange(&target(&first, [0.0, 0.0, 0.04 * step as f32]));
    }
    let cycle_s = start.elapsed().as_secs_f64() / 200.0;
    assert!(
        cycle_s > 0.0034,
        "{cycle_s} s a cycle: replies must not come faster"
    );
    assert_eq!(u32_at(&last, 60), 201);
    let risen = f32_at(&last, 16) - f32_at(&first, 16);
    assert!(
        (7.0..8.0).contains(&risen),
        "{risen} mm of 8, less the filter's lag"
    );
    udp.send(&mxt(255, 0));
    let begun = Instant::now();
    while r3.run_status() & 0x40 != 0 {
        assert!(
            begun.elapsed() < PATIENCE,
            "the program did not go on to Hlt"
        );
    }
    assert!(
        udp.receive(Duration::from_millis(50)).is_none(),
        "no reply to the end"
    );
    assert_eq!(r3.ask("1;1;STOP"), "QoK");
    assert_eq!(r3.ask("1;1;SRVOFF"), "QoK");
    sleep(Duration::from_millis(50));
    assert_eq!(r3.run_status() & 0x20, 0, "servo off");
}

#[test]
fn requests_may_end_in_anything_and_come_in_pieces() {
    let (_emulator, ports) = emulator(&[]);
    let mut r3 = R3::connect(ports.r3);
    let answer = "QoK81120;1;0";
    for (end, wanted) in [
        ("", ""),
        ("\r", "\r"),
        ("\n", "\n"),
        ("\0", "\0"),
        ("\r\n", "\r"),
    ] {
        let found = r3.ask(&format!("1;1;DSTATE{end}"));
        assert_eq!(found, format!("{answer}{wanted}"), "ended by {end:?}");
    }
    r3.send("1;1;DS");
    sleep(Duration::from_millis(40));
    r3.send("TATE");
    assert_eq!(r3.receive(3), answer, "in two pieces");
    r3.send("1;1;DSTATE\r1;1;DSTATE\r");
    let twice = format!("{answer}\r{answer}\r");
    assert_eq!(r3.receive(twice.len()), twice, "two in one piece");
    assert!(r3.ask("nonsense\r").starts_with("QeR"));
    let mut other = R3::connect(ports.r3);
    assert_eq!(other.ask("1;1;CNTLON"), "QoK");
    assert_eq!(r3.ask("1;1;CNTLON"), "QeR5640", "busy");
    drop(other);
    let begun = Instant::now();
    while r3.ask("1;1;CNTLON") != "QoK" {
        assert!(
            begun.elapsed() < PATIENCE,
            "the right outlives its connection"
        );
    }
}

#[test]
fn monitor_streams_each_cycle_until_its_end() {
    let (_emulator, ports) = emulator(&["--sensor-bias", "5,6,70"]);
    let udp = Udp::to(ports.monitor);
    udp.send(&monitor_start([101, 1007, 1008, 0]));
    let (first, _) = udp.receive(PATIENCE).unwrap();
    let packets = udp.collect(Duration::from_secs(1));
    // 286 a second; a loaded machine may lose some time.
    let count = packets.len();
    assert!((150..=300).contains(&count), "{count} packets in a second");
    for (index, (bytes, _)) in packets.iter().enumerate() {
        assert_eq!(u32_at(bytes, 60), u32_at(&first, 60) + 1 + index as u32);
        assert_eq!((u16_at(bytes, 4), u16_at(bytes, 64)), (101, 1007));
        let force = f32_at(bytes, 16);
        assert!(
            (60.0..80.0).contains(&force),
            "Fz = {force} N with a bias of 70 N"
        );
        assert_eq!(bytes[32..48], [0; 16], "16 bytes after the six values");
    }
    udp.send(&monitor_end());
    sleep(Duration::from_millis(50));
    udp.collect(Duration::from_millis(20));
    assert!(
        udp.collect(Duration::from_millis(100)).is_empty(),
        "after its end"
    );
}

#[test]
fn jump_ends_in_an_alarm_and_recovery_goes_through_everything() {
    let (_emulator, ports) = emulator(&[]);
    let mut r3 = R3::connect(ports.r3);
    r3.start_program("MXT 1,0,10");
    let udp = Udp::to(ports.mxt);
    let first = udp.exchange(&mxt(0, 0));
    udp.send(&target(&first, [0.0, 0.0, 100.0]));
    assert!(
        udp.receive(Duration::from_millis(100)).is_none(),
        "a reply to a jump"
    );
    let answer = r3.ask("1;1;ERROR");
    assert!(answer.starts_with("Qok8805;"), "{answer}");
    assert_eq!(r3.ask("1;1;CNTLON"), "Qok");
    assert!(r3.ask("1;1;RUNRAW;1").starts_with("Qer"));
    assert_eq!(r3.ask("1;1;RSTALRM"), "QoK");
    r3.start_program("MXT 1,0,10");
    let again = udp.exchange(&mxt(0, 0));
    let moved = f32_at(&again, 16) - f32_at(&first, 16);
    assert!(moved.abs() < 0.5, "the jump moved the arm by {moved} mm");
    udp.exchange(&target(&again, [0.0; 3]));
}

#[test]
fn links_fail_as_they_are_told() {
    let (_emulator, ports) = emulator(&["--program", "tests/mxt.prg", "--run"]);
    let mxt_udp = Udp::to(ports.mxt);
    let start = Instant::now();
    // The program needs a cycle or two to its Mxt line.
    loop {
        mxt_udp.send(&mxt(0, 0));
        if mxt_udp.receive(Duration::from_millis(50)).is_some() {
            break;
        }
        assert!(start.elapsed() < PATIENCE, "no reply at all");
    }
    let ask = |line: &str| {
        let answer = control(ports.control, line);
        assert_eq!(answer["ok"], true, "{line}: {answer}");
        answer
    };
    let clear = || ask(r#"{"do":"clear"}"#);

    ask(r#"{"do":"drop","probability":1.0,"direction":"to_client"}"#);
    mxt_udp.send(&mxt(0, 0));
    assert!(
        mxt_udp.receive(Duration::from_millis(60)).is_none(),
        "dropped"
    );
    clear();
    assert_eq!(
        u32_at(&mxt_udp.exchange(&mxt(0, 0)), 60),
        3,
        "it was heard all the same"
    );

    ask(r#"{"do":"drop","probability":1.0,"direction":"to_controller","seconds":0.1}"#);
    mxt_udp.send(&mxt(0, 0));
    assert!(
        mxt_udp.receive(Duration::from_millis(60)).is_none(),
        "dropped"
    );
    sleep(Duration::from_millis(100));
    assert_eq!(
        u32_at(&mxt_udp.exchange(&mxt(0, 0)), 60),
        4,
        "it was not heard"
    );

    ask(r#"{"do":"duplicate","probability":1.0,"direction":"to_client"}"#);
    mxt_udp.send(&mxt(0, 0));
    let found = mxt_udp.collect(Duration::from_millis(100));
    assert_eq!(found.len(), 2, "twice");
    assert_eq!(found[0].0, found[1].0, "the same packet twice");
    clear();

    ask(r#"{"do":"short","probability":1.0,"bytes":77,"direction":"to_client"}"#);
    mxt_udp.send(&mxt(0, 0));
    assert_eq!(mxt_udp.receive(PATIENCE).unwrap().0.len(), 77);
    clear();

    ask(r#"{"do":"delay","ms":60,"direction":"to_client"}"#);
    let sent = Instant::now();
    mxt_udp.exchange(&mxt(0, 0));
    let late = sent.elapsed();
    assert!(late > Duration::from_millis(55), "came after {late:?}");
    clear();

    ask(r#"{"do":"stranger","count":2}"#);
    let found = mxt_udp.collect(Duration::from_millis(100));
    assert_eq!(found.len(), 2, "a stranger's packets");
    assert!(
        found
            .iter()
            .all(|(bytes, from)| bytes.len() == 196 && *from != local(ports.mxt))
    );

    let monitor_udp = Udp::to(ports.monitor);
    monitor_udp.send(&monitor_start([101, 0, 0, 0]));
    monitor_udp.receive(PATIENCE).unwrap();
    ask(r#"{"do":"silent","service":"monitor","seconds":0.3}"#);
    monitor_udp.collect(Duration::from_millis(30));
    assert!(
        monitor_udp.collect(Duration::from_millis(100)).is_empty(),
        "silent"
    );
    mxt_udp.exchange(&mxt(0, 0));
    monitor_udp.receive(PATIENCE).expect("it comes back");
    ask(r#"{"do":"silent","service":"mxt"}"#);
    mxt_udp.send(&mxt(0, 0));
    assert!(
        mxt_udp.receive(Duration::from_millis(60)).is_none(),
        "silent"
    );
    assert!(!monitor_udp.collect(Duration::from_millis(60)).is_empty());
    clear();
}

#[test]
fn r3_closes_refuses_and_comes_back() {
    let (_emulator, ports) = emulator(&[]);
    let mut r3 = R3::connect(ports.r3);
    assert_eq!(r3.ask("1;1;CNTLON"), "QoK");
    control(ports.control, r#"{"do":"r3","state":"close"}"#);
    assert!(r3.is_closed());
    let begun = Instant::now();
    let mut r3 = R3::connect(ports.r3);
    while r3.ask("1;1;CNTLON") != "QoK" {
        assert!(
            begun.elapsed() < PATIENCE,
            "the right outlives its connection"
        );
    }
    control(ports.control, r#"{"do":"r3","state":"refuse"}"#);
    assert!(r3.is_closed());
    let begun = Instant::now();
    while TcpStream::connect(local(ports.r3)).is_ok() {
        assert!(begun.elapsed() < PATIENCE, "connections are still taken");
        sleep(Duration::from_millis(5));
    }
    control(ports.control, r#"{"do":"r3","state":"accept"}"#);
    let begun = Instant::now();
    while TcpStream::connect(local(ports.r3)).is_err() {
        assert!(
            begun.elapsed() < PATIENCE,
            "connections are not taken again"
        );
        sleep(Duration::from_millis(5));
    }
    assert_eq!(R3::connect(ports.r3).ask("1;1;ERROR"), "QoK0;");
}

#[test]
fn control_socket_answers_line_by_line() {
    let (_emulator, ports) = emulator(&[]);
    let state = control(ports.control, r#"{"do":"state"}"#);
    assert_eq!(state["servo"], "off");
    assert_eq!(state["at_rest"], true);
    let found = state["object"]["joint_state"].as_f64().unwrap();
    assert!(
        (found - 0.4 * 0.25).abs() < 0.002,
        "the drawer is at {found} m"
    );
    for line in ["{}", "nonsense", r#"{"do":"fly"}"#, r#"{"do":"drop"}"#] {
        let answer = control(ports.control, line);
        assert_eq!(answer["ok"], false, "{line}");
        assert!(answer["error"].is_string(), "{line}");
    }
    assert_eq!(
        control(ports.control, r#"{"do":"reset_peaks"}"#)["ok"],
        true
    );
}

#[test]
fn scenario_happens_by_itself() {
    let file = std::env::temp_dir().join(format!("scenario-{}.toml", std::process::id()));
    std::fs::write(&file, "[[event]]\nat_s = 0.1\ndo = \"emergency_stop\"\n").unwrap();
    let (_emulator, ports) = emulator(&["--scenario", file.to_str().unwrap()]);
    std::fs::remove_file(&file).unwrap();
    let mut r3 = R3::connect(ports.r3);
    let begun = Instant::now();
    while !r3.ask("1;1;ERROR").starts_with("Qok8812") {
        assert!(begun.elapsed() < PATIENCE, "no emergency stop");
    }
}

#[test]
fn taken_port_is_named() {
    let taken = TcpListener::bind(local(0)).unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let options =
        Options::from_words(&["--r3-port", &port, "--mxt-port", "0", "--monitor-port", "0"]);
    let error = Emulator::start(&options.unwrap()).unwrap_err().to_string();
    assert!(error.contains("R3") && error.contains(&port), "{error}");
}
