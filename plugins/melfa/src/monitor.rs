//! The real-time monitor: force every control cycle.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::thread::{self, JoinHandle};

use pubs_melfa_protocol::monitor::{Reply, Request, Value};
use pubs_melfa_protocol::{PACKET_LEN, Pose};

use crate::board::{Shared, Timed};
use crate::freshness::Freshness;
use crate::params::{Params, ms_ns};
use crate::system::{make_timely, monotonic_ns, wait_readable};
use crate::wrench::{Mounting, Wrench};

/// A stream that has stopped is asked for again so often, ns.
const KNOCK_NS: u64 = 100_000_000;

/// The thread looks up so often, ns.
const LOOK_NS: u64 = 20_000_000;

/// A subscription to the monitor; the stream ends with it.
#[derive(Debug)]
pub struct MonitorLink {
    socket: UdpSocket,
    types: [u16; 4],
    force_id: u16,
    command_id: u16,
    freshness: Freshness,
}

/// What a look into the socket found.
#[derive(Debug, Default)]
pub struct Streamed {
    /// New force readings, the sensor's own axes, in their order.
    pub wrenches: Vec<Timed<Wrench>>,
    /// The newest command that the controller has, where it tells it.
    pub commanded: Option<Timed<Pose>>,
    /// New packets without a force reading.
    pub without_force: u32,
    /// Nobody listens at the other end, says the network.
    pub refused: bool,
}

impl MonitorLink {
    /// Binds to `local` and takes `controller` for the only peer.
    ///
    /// # Errors
    /// Where the system refuses.
    pub fn open(params: &Params, local: SocketAddr, controller: SocketAddr) -> io::Result<Self> {
        let socket = UdpSocket::bind(local)?;
        socket.connect(controller)?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            types: [params.force_id, params.pose_id, params.command_id, 0],
            force_id: params.force_id,
            command_id: params.command_id,
            freshness: Freshness::default(),
        })
    }

    /// Asks for the stream.
    pub fn subscribe(&mut self) {
        self.freshness = Freshness::default();
        self.send(&Request::start(self.types));
    }

    fn send(&self, request: &Request) {
        // A packet that the network does not take is a lost packet; the thread asks again.
        let _ = self.socket.send(&request.encode());
    }

    /// Takes all that lies in the socket, after waiting for something until `until_ns`.
    pub fn receive(&mut self, until_ns: u64) -> Streamed {
        let mut found = Streamed::default();
        if !wait_readable(&self.socket, until_ns) {
            return found;
        }
        let mut bytes = [0; PACKET_LEN + 1];
        loop {
            match self.socket.recv(&mut bytes) {
                Ok(length) => self.take(&bytes[..length], &mut found),
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
                    found.refused = true;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(_) => return found,
            }
        }
    }

    fn take(&mut self, bytes: &[u8], found: &mut Streamed) {
        let time_ns = monotonic_ns();
        let Ok(reply) = Reply::decode(bytes, self.force_id) else {
            return;
        };
        if !self.freshness.accepts(reply.count) {
            return;
        }
        if let Some(Value::Pose(value)) = reply.get(self.command_id).copied() {
            found.commanded = Some(Timed { time_ns, value });
        }
        match reply.get(self.force_id).and_then(wrench_of) {
            Some(value) => found.wrenches.push(Timed { time_ns, value }),
            None => found.without_force += 1,
        }
    }
}

fn wrench_of(value: &Value) -> Option<Wrench> {
    let Value::Force { force_n, torque_nm } = value else {
        return None;
    };
    let wrench = Wrench {
        force: force_n.map(f64::from).into(),
        torque: torque_nm.map(f64::from).into(),
    };
    wrench.is_finite().then_some(wrench)
}

impl Drop for MonitorLink {
    fn drop(&mut self) {
        self.send(&Request::End);
    }
}

/// Keeps the board's wrench fresh until the driver is closed.
///
/// # Errors
/// Where the system gives no thread.
pub fn spawn(
    mut link: MonitorLink,
    params: &Params,
    board: Shared,
    is_over: impl Fn() -> bool + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    let mounting = Mounting::new(params);
    let stale_ns = ms_ns(params.force_stale_ms).max(KNOCK_NS);
    let thread = thread::Builder::new().name("melfa force".to_owned());
    thread.spawn(move || {
        // A reading that waits for this thread is a stale reading, and stops the arm.
        make_timely();
        let (mut newest_ns, mut asked_ns) = (monotonic_ns(), 0);
        while !is_over() {
            let found = link.receive(monotonic_ns() + LOOK_NS);
            let now_ns = monotonic_ns();
            if let Some(commanded) = found.commanded {
                board.lock().hear_command(commanded);
            }
            if let Some(last) = found.wrenches.last() {
                newest_ns = last.time_ns;
                board.lock().wrench = Some(Timed {
                    time_ns: last.time_ns,
                    value: mounting.at_tool(&last.value),
                });
            }
            if now_ns - newest_ns > stale_ns && now_ns - asked_ns > KNOCK_NS {
                crate::log::say("monitor", "the monitor sends no force; it is asked again");
                link.subscribe();
                asked_ns = now_ns;
            }
        }
    })
}
