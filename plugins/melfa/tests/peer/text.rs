//! R3: one connection at a time.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::State;

pub fn serve(listener: &TcpListener, state: &Mutex<State>, over: &AtomicBool) {
    listener.set_nonblocking(true).unwrap();
    while !over.load(Ordering::Acquire) {
        match listener.accept() {
            Ok((stream, _)) if !state.lock().unwrap().r3_cut => session(stream, state, over),
            _ => std::thread::sleep(Duration::from_millis(5)),
        }
    }
}

fn session(mut stream: TcpStream, state: &Mutex<State>, over: &AtomicBool) {
    stream.set_nonblocking(false).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_millis(10)))
        .unwrap();
    let mut bytes = [0; 512];
    while !over.load(Ordering::Acquire) && !state.lock().unwrap().r3_cut {
        let length = match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(length) => length,
            Err(_) => continue,
        };
        let text = String::from_utf8_lossy(&bytes[..length]).into_owned();
        for request in text
            .split(['\r', '\n', '\0'])
            .filter(|text| !text.is_empty())
        {
            let answer = answer(request, &mut state.lock().unwrap());
            if stream.write_all(answer.as_bytes()).is_err() {
                return;
            }
        }
    }
}

fn answer(request: &str, state: &mut State) -> String {
    state.requests.push(request.to_owned());
    let command = request.splitn(3, ';').nth(2).unwrap_or("");
    let prefix = if state.error == 0 { "QoK" } else { "Qok" };
    if state
        .refused
        .iter()
        .any(|refused| command.starts_with(refused))
    {
        return "QeR0099".to_owned();
    }
    let data = match command {
        "DSTATE" => format!("{:02X}{:02X}{};1;0", state.run, state.stop, state.error),
        "STATE" => format!(
            "PUBS;1;100;00;{:02X}{:02X}{};1;00",
            state.run, state.stop, state.error
        ),
        "SRVON" => {
            state.run |= 0x20;
            String::new()
        }
        "SRVOFF" => {
            state.run &= !0x20;
            String::new()
        }
        "STOP" => {
            state.run &= !0x40;
            String::new()
        }
        "RSTALRM" => {
            state.error = 0;
            String::new()
        }
        "VALP_FsCurD;P" => "P_FsCurD=(1.00,-2.00,3.00,0.10,0.20,0.30)(0,0)".to_owned(),
        _ if command.starts_with("ERRORMES") => "servo amplifier overheated".to_owned(),
        _ if command.starts_with("EMDAT") => {
            state.has_program = true;
            String::new()
        }
        _ if command.starts_with("RUN") => {
            if !state.has_program {
                return "QeR0101".to_owned();
            }
            state.run |= 0x40;
            state.count = 0;
            String::new()
        }
        _ => String::new(),
    };
    format!("{prefix}{data}")
}
