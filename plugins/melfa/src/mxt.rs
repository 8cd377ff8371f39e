//! The socket to MXT: sends requests, keeps the newest reply.

use std::io;
use std::net::{IpAddr, SocketAddr, UdpSocket};

use nalgebra::Isometry3;
use pubs_melfa_protocol::mxt::{Command, Data, DataType, Reply, Request};
use pubs_melfa_protocol::{PACKET_LEN, Pose};

use crate::freshness::Freshness;
use crate::system::{monotonic_ns, wait_readable};

/// What every reply shall tell.
const WANTED: [DataType; 4] = [
    DataType::FeedbackPose,
    DataType::FeedbackJoint,
    DataType::FilteredPose,
    DataType::FeedbackCurrent,
];

/// Between two requests of a handshake, ns.
const KNOCK_NS: u64 = 50_000_000;

/// Where the arm is, as one reply tells it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snapshot {
    /// When the reply came, ns.
    pub time_ns: u64,
    /// Feedback.
    pub pose: Pose,
    /// Feedback, rad, where the controller tells it.
    pub joints: Option<[f64; 6]>,
    /// The command after the filter, where the controller tells it.
    pub filtered: Option<Pose>,
}

impl Snapshot {
    /// From a reply that has a usable feedback pose.
    pub fn of(reply: &Reply, time_ns: u64) -> Option<Self> {
        let pose_in = |data_type| match reply.get(data_type) {
            Some(Data::Pose(pose)) if pose.is_finite() => Some(*pose),
            _ => None,
        };
        Some(Self {
            time_ns,
            pose: pose_in(DataType::FeedbackPose)?,
            joints: match reply.get(DataType::FeedbackJoint) {
                Some(Data::Joint(values)) => usable(values),
                _ => None,
            },
            filtered: pose_in(DataType::FilteredPose),
        })
    }

    /// The feedback pose as a transform, controller's base, m.
    pub fn isometry(&self) -> Isometry3<f64> {
        self.pose.isometry()
    }
}

/// Joints that are numbers and not all zero, as those of a controller that does not tell them are.
fn usable(values: &[f32; 8]) -> Option<[f64; 6]> {
    let joints: [f64; 6] = std::array::from_fn(|index| f64::from(values[index]));
    let finite = joints.iter().all(|joint| joint.is_finite());
    let told = joints.iter().any(|joint| *joint != 0.0);
    (finite && told).then_some(joints)
}

/// What a look into the socket found.
#[derive(Debug, Default)]
pub struct Drained {
    /// The newest new reply.
    pub newest: Option<Snapshot>,
    /// New replies.
    pub fresh: u64,
    /// Packets that were no new reply.
    pub ignored: u64,
    /// Nobody listens at the other end, says the network.
    pub refused: bool,
}

/// A socket that takes packets from the controller's MXT port alone.
#[derive(Debug)]
pub struct MxtLink {
    socket: UdpSocket,
    count: u32,
    freshness: Freshness,
}

impl MxtLink {
    /// Binds to `local` and takes `controller` for the only peer.
    ///
    /// # Errors
    /// Where the system refuses.
    pub fn open(local: SocketAddr, controller: SocketAddr) -> io::Result<Self> {
        let socket = UdpSocket::bind(local)?;
        socket.connect(controller)?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            count: 0,
            freshness: Freshness::default(),
        })
    }

    /// This end.
    ///
    /// # Errors
    /// Where the system does not know.
    pub fn local_address(&self) -> io::Result<IpAddr> {
        Ok(self.socket.local_addr()?.ip())
    }

    /// Sends one request. A packet that the network does not take is a lost packet.
    pub fn send(&mut self, command: Command, target: Option<Pose>) {
        self.count = self.count.wrapping_add(1);
        let (send, data) = match target {
            Some(pose) => (DataType::CommandPose, Data::Pose(pose)),
            None => (DataType::None, Data::None),
        };
        let request = Request {
            command,
            send,
            data,
            receive: WANTED,
            count: self.count,
            ..Request::default()
        };
        if let Err(error) = self.socket.send(&request.encode())
            && error.kind() != io::ErrorKind::ConnectionRefused
        {
            crate::log::say("send", &format!("a packet to MXT was not sent: {error}"));
        }
    }

    /// Waits until a packet has come or the clock has reached `until_ns`.
    pub fn wait(&self, until_ns: u64) -> bool {
        wait_readable(&self.socket, until_ns)
    }

    /// Takes all that lies in the socket.
    pub fn drain(&mut self) -> Drained {
        let mut found = Drained::default();
        // One byte more than a packet, so that a longer one is not taken for one.
        let mut bytes = [0; PACKET_LEN + 1];
        loop {
            match self.socket.recv(&mut bytes) {
                Ok(length) => match self.snapshot(&bytes[..length]) {
                    Some(snapshot) => {
                        found.newest = Some(snapshot);
                        found.fresh += 1;
                    }
                    None => found.ignored += 1,
                },
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
                    found.refused = true;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(_) => return found,
            }
        }
    }

    fn snapshot(&mut self, bytes: &[u8]) -> Option<Snapshot> {
        let time_ns = monotonic_ns();
        let reply = Reply::decode(bytes).ok()?;
        let snapshot = Snapshot::of(&reply, time_ns)?;
        self.freshness.accepts(reply.count).then_some(snapshot)
    }

    /// A new session: what the controller counts begins anew.
    pub fn forget(&mut self) {
        self.freshness = Freshness::default();
    }

    /// Asks with Command 0 until a reply comes. Nothing moves.
    ///
    /// # Errors
    /// Where none came until `until_ns`; the text says what was found instead.
    pub fn handshake(&mut self, until_ns: u64) -> Result<Snapshot, String> {
        self.forget();
        let (mut refused, mut ignored) = (false, 0);
        loop {
            self.send(Command::Null, None);
            let knock_ns = (monotonic_ns() + KNOCK_NS).min(until_ns);
            while self.wait(knock_ns) {
                let found = self.drain();
                if let Some(snapshot) = found.newest {
                    return Ok(snapshot);
                }
                refused |= found.refused;
                ignored += found.ignored;
            }
            if monotonic_ns() >= until_ns {
                return Err(match (refused, ignored) {
                    (_, 1..) => format!("{ignored} packets came, none with a feedback pose"),
                    (true, _) => "the port is closed".to_owned(),
                    (false, _) => "no reply".to_owned(),
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn joints_that_are_not_told_are_none() {
        assert_eq!(usable(&[0.0; 8]), None, "all zero");
        assert_eq!(usable(&[f32::NAN; 8]), None, "no numbers");
        let told = usable(&[0.0, 0.0, 1.5, 0.0, 1.5, 0.0, 9.0, 9.0]).unwrap();
        assert_eq!(told, [0.0, 0.0, 1.5, 0.0, 1.5, 0.0]);
    }

    #[test]
    fn strangers_short_and_repeated_packets_are_no_replies() {
        let controller = UdpSocket::bind("127.0.0.1:0").unwrap();
        let stranger = UdpSocket::bind("127.0.0.1:0").unwrap();
        let local = "127.0.0.1:0".parse().unwrap();
        let mut link = MxtLink::open(local, controller.local_addr().unwrap()).unwrap();
        let to = link.socket.local_addr().unwrap();
        let reply = |count, x| {
            let mut reply = Reply {
                count,
                ..Reply::default()
            };
            let pose = Pose {
                position_mm: [x, 0.0, 0.0],
                ..Pose::default()
            };
            reply.data[0] = (DataType::FeedbackPose, Data::Pose(pose));
            reply.encode().to_vec()
        };
        let long = [reply(9, 9.0), vec![0]].concat();
        stranger.send_to(&reply(50, 50.0), to).unwrap();
        for packet in [
            &reply(1, 1.0),
            &reply(3, 3.0),
            &reply(2, 2.0),
            &reply(3, 3.0),
            &reply(4, 4.0)[..100].to_vec(),
            &long,
        ] {
            controller.send_to(packet, to).unwrap();
        }
        assert!(link.wait(monotonic_ns() + 1_000_000_000));
        std::thread::sleep(std::time::Duration::from_millis(20));
        let found = link.drain();
        assert_eq!((found.fresh, found.ignored), (2, 4), "{found:?}");
        assert_eq!(found.newest.unwrap().pose.position_mm[0], 3.0);
    }
}
