//! R3 over TCP: a thread that takes connections, and one for each of them.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use crate::command;
use crate::framing::Framing;
use crate::shared::Shared;

/// How often a listener looks for connections.
const ACCEPT_PAUSE: Duration = Duration::from_millis(5);

/// How long a connection waits for bytes before it looks at the rest of the world.
const READ_PAUSE: Duration = Duration::from_millis(4);

/// Takes connections until the emulator ends. While it is to refuse them, the port is closed.
pub fn run(shared: &Arc<Shared>, listener: TcpListener, address: SocketAddr) {
    let mut listener = Some(listener);
    let mut connections = 0;
    let mut threads = vec![];
    while !shared.ended.load(Ordering::Acquire) {
        let (refused, closings) = {
            let machine = shared.machine();
            (machine.faults.r3_refused, machine.faults.r3_closings)
        };
        if refused {
            listener = None;
        } else if listener.is_none() {
            listener = listen(address).ok();
        }
        let accepted = listener.as_ref().map(TcpListener::accept);
        if let Some(Ok((stream, _))) = accepted {
            connections += 1;
            let (shared, number) = (Arc::clone(shared), connections);
            threads.push(thread::spawn(move || {
                serve(&shared, stream, number, closings);
            }));
        } else {
            sleep(ACCEPT_PAUSE);
        }
        threads.retain(|thread| !thread.is_finished());
    }
    for thread in threads {
        let _ = thread.join();
    }
}

/// A listener that does not block.
pub fn listen(address: SocketAddr) -> std::io::Result<TcpListener> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Answers a connection until it ends; it gives the operation right back then.
fn serve(shared: &Shared, stream: TcpStream, number: u64, closings: u64) {
    // A connection that fails is a connection that has ended.
    let _ = converse(shared, stream, number, closings);
    command::release_right(&mut shared.machine().controller, number);
}

fn converse(
    shared: &Shared,
    mut stream: TcpStream,
    number: u64,
    closings: u64,
) -> std::io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(READ_PAUSE))?;
    let mut framing = Framing::default();
    let mut buffer = [0; 1024];
    while !shared.ended.load(Ordering::Acquire) {
        match stream.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(length) => framing.push(&buffer[..length], Instant::now()),
            Err(error) if is_pause(&error) => {}
            Err(error) => return Err(error),
        }
        if shared.machine().faults.r3_closings != closings {
            return Ok(());
        }
        while let Some(request) = framing.next(Instant::now()) {
            let mut machine = shared.machine();
            let reply = command::answer(&mut machine.controller, &request.text, number);
            drop(machine);
            let mut bytes = reply.to_string().into_bytes();
            bytes.extend(request.end);
            stream.write_all(&bytes)?;
        }
    }
    Ok(())
}

/// Whether nothing has come yet.
pub fn is_pause(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}
