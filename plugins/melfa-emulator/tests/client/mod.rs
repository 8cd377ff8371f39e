//! A client that knows the protocol's tables and nothing of this project's code.

#![allow(dead_code, clippy::unwrap_used)]

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use serde_json::Value;

pub const LEN: usize = 196;

/// How long to wait for what must come: long, as the machine may be busy.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// Where the services are.
#[derive(Clone, Copy)]
pub struct Ports {
    pub r3: u16,
    pub mxt: u16,
    pub monitor: u16,
    pub control: u16,
}

pub fn local(port: u16) -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], port))
}

pub struct R3(pub TcpStream);

impl R3 {
    pub fn connect(port: u16) -> Self {
        let stream = TcpStream::connect(local(port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        Self(stream)
    }

    pub fn send(&mut self, text: &str) {
        self.0.write_all(text.as_bytes()).unwrap();
    }

    /// What has come after at least this many bytes.
    pub fn receive(&mut self, least: usize) -> String {
        let mut found = vec![];
        let mut buffer = [0; 512];
        while found.len() < least {
            let length = self.0.read(&mut buffer).unwrap();
            assert!(length > 0, "closed after {found:?}");
            found.extend_from_slice(&buffer[..length]);
        }
        String::from_utf8(found).unwrap()
    }

    /// A request without any end, and its answer.
    pub fn ask(&mut self, text: &str) -> String {
        self.send(text);
        self.receive(3)
    }

    /// Whether the other side closes within a while.
    pub fn is_closed(&mut self) -> bool {
        let mut buffer = [0; 16];
        match self.0.read(&mut buffer) {
            Ok(length) => length == 0,
            Err(error) => error.kind() == ErrorKind::ConnectionReset,
        }
    }

    pub fn run_status(&mut self) -> u8 {
        let answer = self.ask("1;1;DSTATE");
        u8::from_str_radix(&answer[3..5], 16).unwrap()
    }

    pub fn wait_for_bit(&mut self, bit: u8) {
        let start = Instant::now();
        while self.run_status() & 1 << bit == 0 {
            assert!(start.elapsed() < PATIENCE, "bit {bit} did not come");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Upload, servo, start: a program that waits for packets of 127.0.0.1.
    pub fn start_program(&mut self, mxt: &str) {
        for (request, wanted) in [
            ("1;1;NEW", "QoK"),
            ("1;1;LOAD=RAW", "QoK"),
            ("1;9;ECLR", "QoK"),
        ] {
            assert_eq!(self.ask(request), wanted, "{request}");
        }
        let lines = format!("1 OPEN \"ENET:127.0.0.1\" AS #1\u{b}2 {mxt}\u{b}3 HLT\u{b}4 END");
        assert_eq!(self.ask(&format!("1;9;EMDAT{lines}")), "QoK");
        for request in ["1;1;SAVE", "1;1;CNTLON", "1;1;SRVON"] {
            assert_eq!(self.ask(request), "QoK", "{request}");
        }
        self.wait_for_bit(5);
        for request in ["1;1;SLOTINIT", "1;1;RUNRAW;1", "1;1;CNTLOFF"] {
            assert_eq!(self.ask(request), "QoK", "{request}");
        }
        self.wait_for_bit(6);
    }
}

pub struct Udp {
    pub socket: UdpSocket,
    to: SocketAddr,
}

impl Udp {
    pub fn to(port: u16) -> Self {
        let socket = UdpSocket::bind(local(0)).unwrap();
        Self {
            socket,
            to: local(port),
        }
    }

    pub fn send(&self, bytes: &[u8]) {
        self.socket.send_to(bytes, self.to).unwrap();
    }

    /// The next packet within this time, and where it came from.
    pub fn receive(&self, within: Duration) -> Option<(Vec<u8>, SocketAddr)> {
        self.socket.set_read_timeout(Some(within)).unwrap();
        let mut buffer = [0; 1024];
        let (length, from) = self.socket.recv_from(&mut buffer).ok()?;
        Some((buffer[..length].to_vec(), from))
    }

    /// A request and the packet that follows it.
    pub fn exchange(&self, bytes: &[u8]) -> Vec<u8> {
        self.send(bytes);
        let (reply, from) = self.receive(PATIENCE).expect("a reply");
        assert_eq!(from, self.to);
        assert_eq!(reply.len(), LEN);
        reply
    }

    /// Packets that come within this time.
    pub fn collect(&self, time: Duration) -> Vec<(Vec<u8>, SocketAddr)> {
        let start = Instant::now();
        let mut found = vec![];
        while let Some(left) = time
            .checked_sub(start.elapsed())
            .filter(|left| !left.is_zero())
        {
            found.extend(self.receive(left));
        }
        found
    }
}

pub fn put_u16(bytes: &mut [u8], at: usize, value: u16) {
    bytes[at..at + 2].copy_from_slice(&value.to_le_bytes());
}

pub fn put_f32(bytes: &mut [u8], at: usize, value: f32) {
    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
}

pub fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

pub fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

pub fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_bits(u32_at(bytes, at))
}

/// MXT: command, type of the target, and feedback pose and joints wanted back.
pub fn mxt(command: u16, send_type: u16) -> [u8; LEN] {
    let mut bytes = [0; LEN];
    put_u16(&mut bytes, 0, command);
    put_u16(&mut bytes, 2, send_type);
    put_u16(&mut bytes, 4, 7);
    put_u16(&mut bytes, 64, 8);
    bytes
}

/// A target: the position data of a reply, displaced along base axes, mm.
pub fn target(reply: &[u8], by_mm: [f32; 3]) -> [u8; LEN] {
    let mut bytes = mxt(1, 1);
    bytes[8..48].copy_from_slice(&reply[8..48]);
    for (axis, by) in by_mm.iter().enumerate() {
        put_f32(&mut bytes, 8 + 4 * axis, f32_at(reply, 8 + 4 * axis) + by);
    }
    bytes
}

/// Monitor: start with these ids.
pub fn monitor_start(ids: [u16; 4]) -> [u8; LEN] {
    let mut bytes = [0; LEN];
    put_u16(&mut bytes, 0, 1);
    for (at, id) in [4, 64, 108, 152].into_iter().zip(ids) {
        put_u16(&mut bytes, at, id);
    }
    bytes
}

pub fn monitor_end() -> [u8; LEN] {
    let mut bytes = [0; LEN];
    put_u16(&mut bytes, 0, 255);
    bytes
}

/// A line to the control socket and its answer.
pub fn control(port: u16, line: &str) -> Value {
    let mut stream = TcpStream::connect(local(port)).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(format!("{line}\n").as_bytes()).unwrap();
    let mut text = String::new();
    let mut buffer = [0; 8192];
    while !text.ends_with('\n') {
        let length = stream.read(&mut buffer).unwrap();
        assert!(length > 0, "closed after {text:?}");
        text.push_str(std::str::from_utf8(&buffer[..length]).unwrap());
    }
    serde_json::from_str(&text).unwrap()
}
