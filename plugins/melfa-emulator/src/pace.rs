//! The thread of the control cycle: UDP in, one cycle, UDP out, at absolute deadlines.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::Ordering;
use std::thread::sleep;
use std::time::{Duration, Instant};

use pubs_melfa_protocol::mxt::Data;
use pubs_melfa_protocol::{PACKET_LEN, monitor, mxt};

use crate::link::Link;
use crate::machine::{Machine, Packets};
use crate::shared::Shared;

/// Packets that a cycle takes from a socket at most.
const PACKETS_PER_CYCLE: usize = 64;

/// Further behind than this many cycles it leaves out what it missed: a controller is never late,
/// so that the time of the emulator stands still then.
const MOST_CYCLES_BEHIND: u32 = 3;

/// How far a stranger's packet claims the arm to be from where it is, mm.
const STRANGE_MM: f32 = 100.0;

/// The sockets of the cycle and the packets under way on them: MXT, monitor.
pub struct Wires {
    sockets: [UdpSocket; 2],
    stranger: UdpSocket,
    links: [[Link; 2]; 2],
}

impl Wires {
    /// On these sockets, which do not block. Strangers speak from their own.
    pub fn new(mxt: UdpSocket, monitor: UdpSocket, stranger: UdpSocket, seed: u64) -> Self {
        let link = |number: u64| Link::new(seed.wrapping_mul(4).wrapping_add(number));
        Self {
            sockets: [mxt, monitor],
            stranger,
            links: [[link(0), link(1)], [link(2), link(3)]],
        }
    }

    /// What has arrived for a service.
    fn receive(&mut self, service: usize, machine: &Machine) -> Packets {
        let now_s = machine.controller.time_s;
        let link = &mut self.links[service][0];
        // Longer packets are cut at this; they are of a wrong length all the same.
        let mut buffer = [0; PACKET_LEN + 1];
        for _ in 0..PACKETS_PER_CYCLE {
            let Ok((length, from)) = self.sockets[service].recv_from(&mut buffer) else {
                break;
            };
            let faults = &machine.faults.links[service][0];
            link.push(now_s, faults, from, buffer[..length].to_vec());
        }
        link.arrived(now_s)
    }

    /// Sends what is to go to clients. That one of them is gone is nobody's fault here.
    fn send(&mut self, service: usize, packets: Packets, machine: &Machine) {
        let now_s = machine.controller.time_s;
        let link = &mut self.links[service][1];
        for (address, bytes) in packets {
            link.push(now_s, &machine.faults.links[service][1], address, bytes);
        }
        for (address, bytes) in link.arrived(now_s) {
            let _ = self.sockets[service].send_to(&bytes, address);
        }
    }

    fn send_as_stranger(&self, machine: &mut Machine) {
        let addresses = [
            machine.client.into_iter().collect::<Vec<SocketAddr>>(),
            machine.monitor.addresses().copied().collect(),
        ];
        for (service, addresses) in addresses.iter().enumerate() {
            if machine.faults.strangers[service] == 0 {
                continue;
            }
            machine.faults.strangers[service] -= 1;
            let bytes = strange_packet(service, machine);
            for address in addresses {
                let _ = self.stranger.send_to(&bytes, address);
            }
        }
    }
}

/// A packet as the controller might send it, with the arm somewhere else and a great force.
fn strange_packet(service: usize, machine: &Machine) -> [u8; PACKET_LEN] {
    let mut pose = machine.controller.views().feedback_pose();
    pose.position_mm[0] += STRANGE_MM;
    if service == 0 {
        let slot = (mxt::DataType::FeedbackPose, Data::Pose(pose));
        let reply = mxt::Reply {
            data: [slot; 4],
            count: u32::MAX,
            ..mxt::Reply::default()
        };
        return reply.encode();
    }
    let force = monitor::Value::Force {
        force_n: [999.0; 3],
        torque_nm: [99.0; 3],
    };
    let id = machine.controller.sensor_id();
    let reply = monitor::Reply {
        slots: [
            (id, force),
            (monitor::FEEDBACK_POSE, monitor::Value::Pose(pose)),
            Default::default(),
            Default::default(),
        ],
        count: u32::MAX,
        ..monitor::Reply::default()
    };
    reply.encode()
}

/// Runs cycles until the emulator is told to end.
pub fn run(shared: &Shared, mut wires: Wires, cycle: Duration) {
    let mut deadline = Instant::now();
    while !shared.ended.load(Ordering::Acquire) {
        deadline += cycle;
        sleep(deadline.saturating_duration_since(Instant::now()));
        let late = deadline.elapsed();
        let mut machine = shared.machine();
        machine.pacing.worst_s = machine.pacing.worst_s.max(late.as_secs_f64());
        if late > cycle * MOST_CYCLES_BEHIND {
            machine.pacing.slips += 1;
            deadline = Instant::now();
        }
        one_cycle(&mut machine, &mut wires);
    }
}

fn one_cycle(machine: &mut Machine, wires: &mut Wires) {
    for (from, bytes) in wires.receive(1, machine) {
        machine.monitor.hear(&bytes, from);
    }
    let requests = wires.receive(0, machine);
    let replies = machine.cycle(&requests);
    wires.send(0, replies, machine);
    let stream = machine.monitor_packets();
    wires.send(1, stream, machine);
    wires.send_as_stranger(machine);
}
