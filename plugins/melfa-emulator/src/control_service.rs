//! The control socket: one JSON object a line, one JSON object a line in answer.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, sleep};
use std::time::Duration;

use crate::r3_service::is_pause;
use crate::shared::Shared;

/// How often the listener looks for connections.
const ACCEPT_PAUSE: Duration = Duration::from_millis(10);

/// How long a connection waits for bytes before it looks whether to end.
const READ_PAUSE: Duration = Duration::from_millis(50);

/// Longest line that is taken, bytes.
const LONGEST_LINE: usize = 65536;

/// Takes connections until the emulator ends.
pub fn run(shared: &Arc<Shared>, listener: &TcpListener) {
    let mut threads = vec![];
    while !shared.ended.load(Ordering::Acquire) {
        match listener.accept() {
            Ok((stream, _)) => {
                let shared = Arc::clone(shared);
                // A connection that fails is a connection that has ended.
                threads.push(thread::spawn(move || {
                    let _ = converse(&shared, stream);
                }));
            }
            Err(_) => sleep(ACCEPT_PAUSE),
        }
        threads.retain(|thread| !thread.is_finished());
    }
    for thread in threads {
        let _ = thread.join();
    }
}

fn converse(shared: &Shared, mut stream: TcpStream) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_PAUSE))?;
    let mut waiting = vec![];
    let mut buffer = [0; 4096];
    while !shared.ended.load(Ordering::Acquire) && waiting.len() < LONGEST_LINE {
        match stream.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(length) => waiting.extend_from_slice(&buffer[..length]),
            Err(error) if is_pause(&error) => {}
            Err(error) => return Err(error),
        }
        while let Some(end) = waiting.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = waiting.drain(..=end).collect();
            let line = String::from_utf8_lossy(&line);
            if line.trim().is_empty() {
                continue;
            }
            let answer = shared.machine().command(&line);
            stream.write_all(format!("{answer}\n").as_bytes())?;
        }
    }
    Ok(())
}
