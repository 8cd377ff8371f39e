//! Driving the arm as the engine does, and looking at what was sent.

use std::time::{Duration, Instant};

use melfa::Melfa;
use melfa::system::monotonic_ns;
use pubs_plugin::{Driver, PluginError, Twist};
use serde_json::json;

use super::{Peer, Seen};

pub const CYCLE_S: f64 = 0.0035;
pub const SPEED: f64 = 0.05;

pub fn along_x(speed: f64) -> Twist {
    Twist {
        linear_m_s: [speed, 0.0, 0.0],
        angular_rad_s: [0.0; 3],
    }
}

/// Commands at 100 Hz as the engine does, each lasting 50 ms; ends with the first error.
pub fn drive(arm: &mut Melfa, twist: Twist, seconds: f64) -> Result<(), PluginError> {
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    while Instant::now() < end {
        arm.read()?;
        arm.command(twist, monotonic_ns() + 50_000_000)?;
        std::thread::sleep(Duration::from_millis(10));
    }
    Ok(())
}

pub fn opened(peer: &Peer) -> Melfa {
    Melfa::open(&peer.setup(json!({}))).unwrap_or_else(|error| panic!("{error}"))
}

pub fn wait(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}

/// Steps of x between targets, m.
pub fn steps(moves: &[Seen]) -> Vec<f64> {
    let x = |seen: &Seen| f64::from(seen.target.mm[0]) * 1e-3;
    moves
        .windows(2)
        .map(|pair| x(&pair[1]) - x(&pair[0]))
        .collect()
}

/// Quanta of 1e-3 mm make steps uncertain by one, and rates of change by two, per cycle.
pub const QUANTUM_M: f64 = 1e-6;

/// Greatest change of the step, as an acceleration. Where the machine kept the driver waiting for a
/// cycle the arm has slowed down meanwhile, and the driver goes on from there: not counted.
pub fn greatest_acceleration(moves: &[Seen]) -> f64 {
    let mut greatest: f64 = 0.0;
    for triple in moves.windows(3) {
        let waited = (triple[2].at - triple[1].at).max(triple[1].at - triple[0].at);
        if waited.as_secs_f64() < 1.9 * CYCLE_S {
            let steps = steps(triple);
            greatest = greatest.max((steps[1] - steps[0]).abs());
        }
    }
    (greatest - 2.0 * QUANTUM_M).max(0.0) / (CYCLE_S * CYCLE_S)
}
