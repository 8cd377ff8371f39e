//! What the driver finds when it is asked what stands in the way of moving.
#![allow(clippy::unwrap_used, missing_docs)]

mod peer;

use melfa::Melfa;
use peer::{Peer, State};
use pubs_plugin::{CheckState, Driver};
use serde_json::json;

#[test]
fn a_diagnosis_goes_on_after_a_fault_and_changes_nothing() {
    let troubled = State {
        run: 0x8a,
        error: 2140,
        ..State::default()
    };
    let peer = Peer::start(troubled);
    let checks = Melfa::diagnose(&peer.setup(json!({}))).unwrap().unwrap();
    let found: Vec<_> = checks
        .iter()
        .map(|check| (check.name.as_str(), check.state))
        .collect();
    let expected = [
        ("stop", CheckState::Ok),
        ("reaction", CheckState::Warn),
        ("controller", CheckState::Ok),
        ("mode", CheckState::Fault),
        ("emergency stop", CheckState::Ok),
        ("alarm", CheckState::Fault),
        ("servo", CheckState::Warn),
        ("cycle", CheckState::Ok),
        ("force", CheckState::Ok),
        ("program", CheckState::Warn),
        ("mxt", CheckState::Skipped),
    ];
    assert_eq!(found, expected, "{checks:#?}");
    let state = peer.state();
    let harmless = ["OPEN", "DSTATE", "STATE", "ERRORMES", "CLOSE"];
    let other = state.requests.iter().find(|request| {
        let command = request.splitn(3, ';').nth(2).unwrap();
        !harmless.iter().any(|name| command.starts_with(name))
    });
    assert_eq!(other, None, "the diagnosis changed something");
    assert!(state.log.is_empty());
}

#[test]
fn a_diagnosis_of_a_running_program_measures_and_ends_its_session() {
    let running = State {
        run: 0xe2,
        ..State::default()
    };
    for (start_program, last) in [(true, 255), (false, 0)] {
        let peer = Peer::start(running.clone());
        let params = json!({ "start_program": start_program });
        let checks = Melfa::diagnose(&peer.setup(params)).unwrap().unwrap();
        let wrong: Vec<_> = checks
            .iter()
            .filter(|check| check.state != CheckState::Ok && check.name != "reaction")
            .collect();
        assert!(wrong.is_empty(), "{wrong:#?}");
        std::thread::sleep(std::time::Duration::from_millis(20));
        assert_eq!(peer.state().log.last().unwrap().command, last);
    }
}
