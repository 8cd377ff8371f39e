//! The machine and its services, running.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use pubs_melfa_protocol::arm::ReachError;
use pubs_virtual_arm::world::WorldError;
use serde::Serialize;
use serde_json::Value;

use crate::build::build;
use crate::options::Options;
use crate::pace::{self, Wires};
use crate::scenario::ScenarioError;
use crate::shared::Shared;
use crate::{control_service, r3_service};

/// Why the emulator did not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// No such world, or a faulty one.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The arm cannot hold the handle where it is.
    #[error("the arm does not reach the handle at the start ({0}); give another --mount")]
    Reach(#[from] ReachError),
    /// A faulty scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The program's file cannot be read.
    #[error("program {path} cannot be read: {reason}")]
    Program {
        /// As asked for.
        path: String,
        /// The system's account.
        reason: String,
    },
    /// A port is taken, or the address is not one of this machine's.
    #[error(
        "{service} cannot listen at {address}: {reason}; give another port, or 0 for any free one"
    )]
    Port {
        /// Which service.
        service: &'static str,
        /// Where.
        address: SocketAddr,
        /// The system's account.
        reason: String,
    },
}

/// Where the services are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Ports {
    /// TCP.
    pub r3: u16,
    /// UDP.
    pub mxt: u16,
    /// UDP.
    pub monitor: u16,
    /// TCP.
    pub control: u16,
}

/// A running emulator; it ends when this is dropped.
#[derive(Debug)]
pub struct Emulator {
    shared: Arc<Shared>,
    ports: Ports,
    warning: Option<String>,
    threads: Vec<JoinHandle<()>>,
}

impl Emulator {
    /// Builds the machine and starts its services.
    ///
    /// # Errors
    ///
    /// Where an option asks for what there is not, or a port is taken.
    pub fn start(options: &Options) -> Result<Self, StartError> {
        let (machine, warning) = build(options)?;
        let cycle = Duration::from_secs_f64(machine.controller.cycle_s());
        let r3 = tcp("R3", options.host, options.r3_port)?;
        let control = tcp("the control socket", options.host, options.control_port)?;
        let mxt = udp("MXT", options.host, options.mxt_port)?;
        let monitor = udp("the monitor", options.host, options.monitor_port)?;
        let stranger = stranger(options.host)?;
        let ports = Ports {
            r3: port(r3.local_addr()),
            mxt: port(mxt.local_addr()),
            monitor: port(monitor.local_addr()),
            control: port(control.local_addr()),
        };
        let shared = Arc::new(Shared::new(machine));
        let wires = Wires::new(mxt, monitor, stranger, options.seed);
        let address = SocketAddr::new(options.host, ports.r3);
        let threads = vec![
            spawn(&shared, move |shared| pace::run(shared, wires, cycle)),
            spawn(&shared, move |shared| r3_service::run(shared, r3, address)),
            spawn(&shared, move |shared| {
                control_service::run(shared, &control);
            }),
        ];
        Ok(Self {
            shared,
            ports,
            warning,
            threads,
        })
    }

    /// Where the services are.
    pub fn ports(&self) -> Ports {
        self.ports
    }

    /// What the user should know of the set-up.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// A command as over the control socket.
    pub fn command(&self, line: &str) -> Value {
        self.shared.machine().command(line)
    }

    /// Whether its threads still run; one that has ended by itself has panicked.
    pub fn is_running(&self) -> bool {
        self.threads.iter().all(|thread| !thread.is_finished())
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.shared.ended.store(true, Ordering::Release);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn spawn(shared: &Arc<Shared>, run: impl FnOnce(&Arc<Shared>) + Send + 'static) -> JoinHandle<()> {
    let shared = Arc::clone(shared);
    thread::spawn(move || run(&shared))
}

fn port(address: std::io::Result<SocketAddr>) -> u16 {
    address.map_or(0, |address| address.port())
}

fn fault(service: &'static str, address: SocketAddr) -> impl Fn(std::io::Error) -> StartError {
    move |error| StartError::Port {
        service,
        address,
        reason: error.to_string(),
    }
}

fn tcp(service: &'static str, host: IpAddr, port: u16) -> Result<TcpListener, StartError> {
    let address = SocketAddr::new(host, port);
    r3_service::listen(address).map_err(fault(service, address))
}

fn udp(service: &'static str, host: IpAddr, port: u16) -> Result<UdpSocket, StartError> {
    let address = SocketAddr::new(host, port);
    let socket = UdpSocket::bind(address).map_err(fault(service, address))?;
    socket
        .set_nonblocking(true)
        .map_err(fault(service, address))?;
    Ok(socket)
}

/// A socket at another loopback address where there is one, else at another port.
fn stranger(host: IpAddr) -> Result<UdpSocket, StartError> {
    let other = IpAddr::V4(Ipv4Addr::new(127, 0, 0, 77));
    match host.is_loopback() && host.is_ipv4() {
        true => udp("a stranger", other, 0).or_else(|_| udp("a stranger", host, 0)),
        false => udp("a stranger", host, 0),
    }
}
