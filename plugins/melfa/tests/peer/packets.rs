//! MXT and the monitor, byte by byte.

use std::f32::consts::FRAC_PI_2;
use std::net::UdpSocket;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use melfa::system::make_timely;

use super::{Seen, State};

const LENGTH: usize = 196;
const CYCLE: Duration = Duration::from_micros(3500);
/// The filter of Mxt.
const FILTER_S: f32 = 0.010;
/// Joint feedback, rad: elbow and wrist bent by a right angle.
const JOINTS: [f32; 6] = [0.0, 0.0, FRAC_PI_2, 0.0, FRAC_PI_2, 0.0];

/// Position data without its flags.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    pub mm: [f32; 3],
    pub rad: [f32; 3],
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

fn put_target(bytes: &mut [u8], at: usize, target: &Target) {
    let values = target.mm.iter().chain(&target.rad);
    for (index, value) in values.enumerate() {
        put(bytes, at + 4 * index, &value.to_le_bytes());
    }
    // sflg1 = 7: right, above, non-flip.
    put(bytes, at + 32, &7u32.to_le_bytes());
}

fn reply(state: &State) -> [u8; LENGTH] {
    let mut bytes = [0; LENGTH];
    put(&mut bytes, 2, &7u16.to_le_bytes());
    put(&mut bytes, 4, &7u16.to_le_bytes());
    put_target(&mut bytes, 8, &state.feedback);
    put(&mut bytes, 60, &state.count.to_le_bytes());
    put(&mut bytes, 64, &8u16.to_le_bytes());
    for (index, joint) in JOINTS.iter().enumerate() {
        put(&mut bytes, 68 + 4 * index, &joint.to_le_bytes());
    }
    put(&mut bytes, 108, &4u16.to_le_bytes());
    put_target(&mut bytes, 112, &state.feedback);
    put(&mut bytes, 152, &11u16.to_le_bytes());
    bytes
}

/// A cheap draw, the same in every run: 0 to 255.
fn draw(seed: &mut u32) -> u32 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    *seed >> 24
}

/// The feedback goes to the held target, as a filter of the first order does.
fn follow(state: &mut State, seconds: f32) {
    if !state.follows {
        return;
    }
    let share = 1.0 - (-seconds / FILTER_S).exp();
    let Target { mm, rad } = state.target;
    for axis in 0..3 {
        state.feedback.mm[axis] += (mm[axis] - state.feedback.mm[axis]) * share;
        state.feedback.rad[axis] += (rad[axis] - state.feedback.rad[axis]) * share;
    }
}

pub fn serve_mxt(socket: &UdpSocket, state: &Mutex<State>, over: &AtomicBool) {
    make_timely();
    let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket
        .set_read_timeout(Some(Duration::from_millis(20)))
        .unwrap();
    let mut bytes = [0; 512];
    let (mut seed, mut last) = (7, Instant::now());
    let mut late: Vec<(Instant, [u8; LENGTH], std::net::SocketAddr)> = Vec::new();
    while !over.load(Ordering::Acquire) {
        let now = Instant::now();
        late.retain(|(due, packet, to)| {
            let wait = *due > now;
            if !wait {
                let _ = socket.send_to(packet, to);
            }
            wait
        });
        let wait = if late.is_empty() { 20 } else { 1 };
        socket
            .set_read_timeout(Some(Duration::from_millis(wait)))
            .unwrap();
        let Ok((length, from)) = socket.recv_from(&mut bytes) else {
            continue;
        };
        let mut state = state.lock().unwrap();
        let now = Instant::now();
        let seconds = (now - last).as_secs_f32();
        follow(&mut state, seconds);
        last = now;
        if length != LENGTH || !state.is_running() {
            continue;
        }
        let command = u16_at(&bytes, 0);
        let target = Target {
            mm: [8, 12, 16].map(|at| f32_at(&bytes, at)),
            rad: [20, 24, 28].map(|at| f32_at(&bytes, at)),
        };
        let posture = u32::from_le_bytes(bytes[40..44].try_into().unwrap());
        state.log.push(Seen {
            at: now,
            command,
            target,
            posture,
        });
        if draw(&mut seed) < state.lose_requests {
            continue;
        }
        match command {
            1 => {
                assert_eq!(
                    u16_at(&bytes, 2),
                    1,
                    "a target for a program of position data"
                );
                state.target = target;
            }
            255 => {
                state.run &= !0x40;
                continue;
            }
            _ => {}
        }
        state.count += 1;
        if !state.mxt_answers || draw(&mut seed) < state.lose_replies {
            continue;
        }
        let packet = reply(&state);
        if state.garbage {
            let _ = stranger.send_to(&packet, from);
            let _ = socket.send_to(&packet[..100], from);
        }
        for _ in 0..state.copies {
            if state.delay.is_zero() {
                let _ = socket.send_to(&packet, from);
            } else {
                late.push((now + state.delay, packet, from));
            }
        }
    }
}

pub fn serve_monitor(socket: &UdpSocket, state: &Mutex<State>, over: &AtomicBool) {
    make_timely();
    socket.set_nonblocking(true).unwrap();
    let mut bytes = [0; 512];
    let (mut to, mut count, mut drift) = (None, 0u32, 0.0f32);
    while !over.load(Ordering::Acquire) {
        let before = Instant::now();
        std::thread::sleep(CYCLE);
        super::steady::note_stall(before.elapsed().saturating_sub(CYCLE));
        while let Ok((length, from)) = socket.recv_from(&mut bytes) {
            if length == LENGTH {
                to = (u16_at(&bytes, 0) == 1).then_some(from);
            }
        }
        let state = state.lock().unwrap();
        let Some(to) = to.filter(|_| state.streams) else {
            continue;
        };
        count += 1;
        drift += state.drift_n_per_packet;
        let mut packet = [0; LENGTH];
        put(&mut packet, 0, &1u16.to_le_bytes());
        put(&mut packet, 4, &101u16.to_le_bytes());
        for (index, force) in state.force_n.iter().enumerate() {
            put(&mut packet, 8 + 4 * index, &(force + drift).to_le_bytes());
        }
        put(&mut packet, 60, &count.to_le_bytes());
        put(&mut packet, 64, &1007u16.to_le_bytes());
        put_target(&mut packet, 68, &state.feedback);
        let _ = socket.send_to(&packet, to);
    }
}
