//! A small controller for these tests: three sockets on loopback, packets written byte by byte from
//! the protocol's tables. It shares no code with the driver's protocol crate.
#![allow(dead_code, clippy::unwrap_used, missing_docs)]

pub mod drive;
mod packets;
pub mod steady;
mod text;

use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use pubs_plugin::{ActionSetup, ControlSetup, DriverSetup, JointSetup, JointType, Mode};
use serde_json::{Value, json};

pub use packets::Target;

/// Where the arm is at first: elbow and wrist bent by a right angle, the flange looking down.
pub const START: Target = Target {
    mm: [500.0, 0.0, 539.0],
    rad: [std::f32::consts::PI, 0.0, std::f32::consts::PI],
};

/// What the controller is like; tests change it while it runs.
#[derive(Debug, Clone)]
pub struct State {
    /// Bits of DSTATE.
    pub run: u8,
    pub stop: u8,
    pub error: u32,
    /// Which commands are refused.
    pub refused: Vec<&'static str>,
    /// Whether the program is there.
    pub has_program: bool,
    /// All requests of R3.
    pub requests: Vec<String>,
    /// Close the next connection, and refuse new ones.
    pub r3_cut: bool,

    /// MXT answers.
    pub mxt_answers: bool,
    /// Its feedback follows the targets.
    pub follows: bool,
    /// How many replies in 256 are kept back, and how many requests are logged but not heard.
    pub lose_replies: u32,
    pub lose_requests: u32,
    /// Each reply is sent so many times; short and foreign packets go before it.
    pub copies: u32,
    pub garbage: bool,
    /// Replies are sent so much later.
    pub delay: Duration,
    /// All requests that came.
    pub log: Vec<Seen>,
    /// Held target and feedback.
    pub target: Target,
    pub feedback: Target,
    pub count: u32,

    /// The monitor streams.
    pub streams: bool,
    pub force_n: [f32; 3],
    pub drift_n_per_packet: f32,
}

/// One request of MXT.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    pub at: Instant,
    pub command: u16,
    pub target: Target,
    pub posture: u32,
}

impl Default for State {
    fn default() -> Self {
        Self {
            // Cycle-stop off 0x02; operation enabled 0x80. Servo and program off.
            run: 0x82,
            stop: 0x00,
            error: 0,
            refused: Vec::new(),
            has_program: true,
            requests: Vec::new(),
            r3_cut: false,
            mxt_answers: true,
            follows: true,
            lose_replies: 0,
            lose_requests: 0,
            copies: 1,
            garbage: false,
            delay: Duration::ZERO,
            log: Vec::new(),
            target: START,
            feedback: START,
            count: 0,
            streams: true,
            force_n: [1.0, -2.0, 3.0],
            drift_n_per_packet: 0.0,
        }
    }
}

impl State {
    pub fn is_running(&self) -> bool {
        self.run & 0x60 == 0x60 && self.error == 0 && self.stop & 1 == 0
    }
}

/// One controller at a time: the driver's cycle needs its share of the machine.
static ALONE: Mutex<()> = Mutex::new(());

/// Waits for the machine.
pub fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One of its three services.
type Service = Box<dyn FnOnce(Arc<Mutex<State>>, Arc<AtomicBool>) + Send>;

/// The controller. It ends when dropped.
pub struct Peer {
    _alone: MutexGuard<'static, ()>,
    state: Arc<Mutex<State>>,
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
    pub r3: SocketAddr,
    pub mxt: SocketAddr,
    pub monitor: SocketAddr,
}

impl Peer {
    pub fn start(state: State) -> Self {
        let alone = alone();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mxt = UdpSocket::bind("127.0.0.1:0").unwrap();
        let monitor = UdpSocket::bind("127.0.0.1:0").unwrap();
        let addresses = [
            listener.local_addr().unwrap(),
            mxt.local_addr().unwrap(),
            monitor.local_addr().unwrap(),
        ];
        let state = Arc::new(Mutex::new(state));
        let over = Arc::new(AtomicBool::new(false));
        let spawn = |run: Service| {
            let (state, over) = (Arc::clone(&state), Arc::clone(&over));
            thread::spawn(move || run(state, over))
        };
        let threads = vec![
            spawn(Box::new(move |state, over| {
                text::serve(&listener, &state, &over)
            })),
            spawn(Box::new(move |state, over| {
                packets::serve_mxt(&mxt, &state, &over)
            })),
            spawn(Box::new(move |state, over| {
                packets::serve_monitor(&monitor, &state, &over)
            })),
        ];
        let [r3, mxt, monitor] = addresses;
        Self {
            _alone: alone,
            state,
            over,
            threads,
            r3,
            mxt,
            monitor,
        }
    }

    pub fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap()
    }

    pub fn params(&self, more: Value) -> Value {
        let mut params = json!({
            "host": "127.0.0.1",
            "r3_port": self.r3.port(),
            "mxt_port": self.mxt.port(),
            "monitor_port": self.monitor.port(),
            "r3_timeout_s": 0.5,
            "handshake_s": 0.5,
            "baseline_s": 0.3,
        });
        let map = params.as_object_mut().unwrap();
        map.extend(more.as_object().unwrap().clone());
        params
    }

    pub fn setup(&self, more: Value) -> DriverSetup {
        setup(self.params(more))
    }

    /// The commands that moved, as they were seen.
    pub fn moves(&self) -> Vec<Seen> {
        let state = self.state();
        state
            .log
            .iter()
            .filter(|seen| seen.command == 1)
            .copied()
            .collect()
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// A drawer that opens towards the robot.
pub fn setup(params: Value) -> DriverSetup {
    DriverSetup {
        joint: JointSetup {
            r#type: JointType::Prismatic,
            lower: 0.0,
            upper: 0.3,
            integer: false,
            radius_m: None,
            opening_direction: Some([0.0, 0.0, -1.0]),
            hinge_direction: None,
            up_direction: Some([0.0, 1.0, 0.0]),
            motion_threshold_m: Some(0.0005),
        },
        actions: vec![ActionSetup {
            name: "stop".to_owned(),
            stop: true,
            mode: Mode::Safe,
            displacement: 0.0,
            observations: 3,
        }],
        control: ControlSetup {
            rate_hz: 100.0,
            safe_speed_m_s: 0.05,
            high_speed_m_s: 0.15,
            force_threshold_n: 15.0,
            force_limit_n: 60.0,
            acceleration_m_s2: 1.0,
            stop_deceleration_m_s2: 5.0,
            contact_stiffness_n_per_m: 5000.0,
        },
        driver: json!({ "plugin": "melfa", "params": params }),
        seed: 1,
    }
}
