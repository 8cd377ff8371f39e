//! Prints the calibration segments of a world, as `[[observation.segment]]` tables of an object
//! file: the virtual arm carries out each movement action over the whole range, several times, as
//! the engine would, and what its sensor saw is fitted (§III-C.1).
//!
//! `cargo run --release -p pubs-virtual-arm --example segments -- door2 > segments.toml`

mod arguments;
mod controller;
mod demonstration;
mod fit;
mod print;

use std::process::ExitCode;

use arguments::Arguments;
use controller::ACTIONS;
use fit::Knots;
use pubs_virtual_arm::world::World;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("segments: {message}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), String> {
    let arguments = Arguments::parse(std::env::args().skip(1))?;
    let world = World::load(&arguments.world).map_err(|error| error.to_string())?;
    let knots = Knots::over(&world.joint);
    let unit = print::Unit::of(&world.joint);
    println!(
        "# Made by the example `segments` of pubs-virtual-arm from world \"{}\":",
        arguments.world
    );
    println!(
        "# {} demonstrations of each action, seed {}.",
        arguments.demonstrations, arguments.seed
    );
    for action in &ACTIONS {
        let samples =
            demonstration::all(&world, &arguments, action).map_err(|error| error.to_string())?;
        for (channel, name) in ["f_d", "f_z", "f_n"].into_iter().enumerate() {
            let points: Vec<_> = samples
                .iter()
                .map(|sample| (sample.after, sample.force[channel]))
                .collect();
            let points = fit::blurred(&world.joint, arguments.position_sd, &points);
            print::force(action.name, name, &fit::force(&knots, &points), &unit);
        }
        let moves: Vec<_> = samples
            .iter()
            .map(|sample| (sample.before, sample.moved))
            .collect();
        let moves = fit::blurred(&world.joint, arguments.position_sd, &moves);
        print::moved(action.name, &fit::moved(&knots, &moves), &unit);
    }
    Ok(())
}
