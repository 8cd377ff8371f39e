//! One request, one reply.

use std::io::{self, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use pubs_melfa_protocol::r3::{BUSY, LONGEST_REQUEST, Reply, Request, TextError};

use crate::params::Terminator;

/// A reply without a terminator is over when nothing more comes for so long.
const QUIET: Duration = Duration::from_millis(4);

/// Longest reply that is read, bytes.
const LONGEST_REPLY: usize = 4096;

/// A busy controller is asked so many times, with a pause.
const BUSY_TRIES: u32 = 5;
const BUSY_PAUSE: Duration = Duration::from_millis(100);

/// What can go wrong with a request.
#[derive(Debug, thiserror::Error)]
pub enum R3Error {
    /// The connection cannot be made or is gone.
    #[error("R3: {0}")]
    Connection(#[from] io::Error),
    /// No reply.
    #[error("R3: no reply to {request} within {seconds} s")]
    Silent {
        /// The request.
        request: String,
        /// How long was waited.
        seconds: f64,
    },
    /// Something came that is no reply.
    #[error("R3: {0}")]
    Text(#[from] TextError),
    /// The controller refused.
    #[error("R3: the controller refuses {request}{}", number_text(*.number))]
    Refused {
        /// The request.
        request: String,
        /// Its error number.
        number: Option<u32>,
    },
    /// Less than what was asked for.
    #[error("R3: six numbers were expected of P_FsCurD, found {text:?}")]
    Few {
        /// As received.
        text: String,
    },
    /// Longer than a controller takes.
    #[error("R3: a request of {length} bytes, but {LONGEST_REQUEST} are the most")]
    Long {
        /// Bytes.
        length: usize,
    },
}

fn number_text(number: Option<u32>) -> String {
    match number {
        None => String::new(),
        Some(number) => format!(" (error {number})"),
    }
}

impl R3Error {
    /// Whether the connection cannot be used any more.
    pub fn is_fatal(&self) -> bool {
        matches!(self, Self::Connection(_) | Self::Silent { .. })
    }
}

/// A connection.
#[derive(Debug)]
pub struct R3Client {
    stream: TcpStream,
    terminator: Terminator,
    timeout: Duration,
}

impl R3Client {
    /// Connects.
    ///
    /// # Errors
    /// Where nobody answers within `timeout`.
    pub fn connect(
        controller: SocketAddr,
        terminator: Terminator,
        timeout: Duration,
    ) -> Result<Self, R3Error> {
        let stream = TcpStream::connect_timeout(&controller, timeout)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(timeout))?;
        Ok(Self {
            stream,
            terminator,
            timeout,
        })
    }

    /// This computer's address as the route to the controller has it.
    ///
    /// # Errors
    /// Where the system does not know.
    pub fn local_address(&self) -> Result<IpAddr, R3Error> {
        Ok(self.stream.local_addr()?.ip())
    }

    /// The text of a granted request's reply.
    ///
    /// # Errors
    /// Where there is no reply, or the controller refuses.
    pub fn ask(&mut self, slot: u8, command: &str) -> Result<String, R3Error> {
        Ok(self.ask_whole(slot, command)?.text)
    }

    /// A granted request's reply, which also tells of an alarm.
    ///
    /// # Errors
    /// As [`ask`](Self::ask).
    pub fn ask_whole(&mut self, slot: u8, command: &str) -> Result<Reply, R3Error> {
        let request = Request::new(slot, command).to_string();
        let mut tries = 1;
        loop {
            let reply = self.exchange(&request)?;
            if reply.status.is_done() {
                return Ok(reply);
            }
            let number = reply.error_number();
            if number != Some(BUSY) || tries == BUSY_TRIES {
                return Err(R3Error::Refused { request, number });
            }
            tries += 1;
            std::thread::sleep(BUSY_PAUSE);
        }
    }

    fn exchange(&mut self, request: &str) -> Result<Reply, R3Error> {
        let length = request.len();
        if length > LONGEST_REQUEST {
            return Err(R3Error::Long { length });
        }
        self.discard_leftovers()?;
        let bytes = [request.as_bytes(), self.terminator.bytes()].concat();
        self.stream.write_all(&bytes)?;
        let text = self.read_reply(request)?;
        Ok(text.parse()?)
    }

    /// What nobody waited for must not be taken for the next reply.
    fn discard_leftovers(&mut self) -> io::Result<()> {
        self.stream.set_nonblocking(true)?;
        let mut bytes = [0; 256];
        let result = loop {
            match self.stream.read(&mut bytes) {
                Ok(0) => break Err(closed()),
                Ok(_) => {}
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => break Ok(()),
                Err(error) => break Err(error),
            }
        };
        self.stream.set_nonblocking(false)?;
        result
    }

    fn read_reply(&mut self, request: &str) -> Result<String, R3Error> {
        let deadline = Instant::now() + self.timeout;
        let mut text = Vec::new();
        let mut bytes = [0; 512];
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let wait = if text.is_empty() { left } else { QUIET };
            self.stream
                .set_read_timeout(Some(wait.max(Duration::from_millis(1))))?;
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(closed().into()),
                Ok(length) => text.extend_from_slice(&bytes[..length]),
                Err(error) if !is_timeout(&error) => return Err(error.into()),
                Err(_) if text.is_empty() => {
                    return Err(R3Error::Silent {
                        request: request.to_owned(),
                        seconds: self.timeout.as_secs_f64(),
                    });
                }
                Err(_) => break,
            }
            let ended = text
                .last()
                .is_some_and(|last| matches!(last, b'\r' | b'\n' | 0));
            if ended || text.len() > LONGEST_REPLY {
                break;
            }
        }
        Ok(String::from_utf8_lossy(&text).into_owned())
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    )
}

fn closed() -> io::Error {
    io::Error::new(
        io::ErrorKind::ConnectionAborted,
        "the controller closed the connection",
    )
}
