//! The program.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::Duration;

use clap::Parser;
use pubs_melfa_emulator::{Emulator, Options};

/// How often it looks whether to end.
const PAUSE: Duration = Duration::from_millis(20);

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("melfa-emulator: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn std::error::Error>> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&interrupted);
    ctrlc::set_handler(move || handler.store(true, Ordering::Release))?;
    let emulator = Emulator::start(options)?;
    if let Some(warning) = emulator.warning() {
        eprintln!("melfa-emulator: {warning}");
    }
    println!("{}", serde_json::to_string(&emulator.ports())?);
    while !interrupted.load(Ordering::Acquire) {
        if !emulator.is_running() {
            return Err("a thread has ended by itself".into());
        }
        sleep(PAUSE);
    }
    Ok(())
}
