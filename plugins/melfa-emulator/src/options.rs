//! Options of the program.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::{Parser, ValueEnum};

use crate::axes::AxisMap;
use crate::mount::{Mount, numbers};

/// A MELFA controller (CR800-05VD with an RV-5AS-D) on loopback, with a simulated arm and object.
///
/// Serves R3 (TCP), MXT and the real-time monitor (UDP), and takes faults on demand. Prints one
/// line of JSON with the ports once it is ready, and ends on SIGTERM or SIGINT.
#[derive(Debug, Clone, Parser)]
#[command(
    name = "melfa-emulator",
    version,
    after_help = "Examples:
  melfa-emulator --world door2 --start 0.3
  melfa-emulator --world drawer1 --r3-port 0 --mxt-port 0 --monitor-port 0 --control-port 0
  melfa-emulator --program mxt.prg --run --mxtout 50 --scenario faults.toml

Then, for instance: printf '1;1;DSTATE\\r' | nc 127.0.0.1 10001"
)]
pub struct Options {
    /// Address of all services. Keep to loopback: nothing here asks who is calling.
    #[arg(long, default_value = "127.0.0.1")]
    pub host: IpAddr,
    /// TCP port of R3; 0: any free one.
    #[arg(long, default_value_t = 10001)]
    pub r3_port: u16,
    /// UDP port of MXT; 0: any free one.
    #[arg(long, default_value_t = 10000)]
    pub mxt_port: u16,
    /// UDP port of the real-time monitor; 0: any free one.
    #[arg(long, default_value_t = 12000)]
    pub monitor_port: u16,
    /// TCP port for faults and the true state, one JSON object a line; 0: any free one.
    #[arg(long, default_value_t = 0)]
    pub control_port: u16,

    /// The object: drawer1, drawer2, door1, door2 or the path of a world file.
    #[arg(long, default_value = "door2")]
    pub world: String,
    /// Joint state of the object at first, as a fraction of its range; drawn from the seed if left out.
    #[arg(long, value_parser = fraction)]
    pub start: Option<f64>,
    /// Seed of the start, the sensor's noise and the random faults.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Dry and viscous friction of the object times this.
    #[arg(long, default_value_t = 1.0, value_parser = scale)]
    pub friction_scale: f64,
    /// Force of catch and seal times this.
    #[arg(long, default_value_t = 1.0, value_parser = scale)]
    pub catch_scale: f64,
    /// Where the world's frame stands in the robot's base.
    #[arg(long, value_name = "X_M,Y_M,Z_M,YAW_DEG", allow_hyphen_values = true)]
    pub mount: Option<Mount>,
    /// The tool in the flange, as P_Tool has it; poses are those of the tool.
    #[arg(long, value_name = "X_MM,Y_MM,Z_MM,A_DEG,B_DEG,C_DEG", allow_hyphen_values = true,
          default_value = "0,0,0,0,0,0", value_parser = numbers::<6>)]
    pub tool: [f64; 6],
    /// Whether the fingers hold the handle at first, close when the arm first moves (so that a
    /// client can tare before), or are open until output 900 or the control socket closes them.
    #[arg(long, value_enum, default_value_t = Grasp::Held)]
    pub grasp: Grasp,

    /// Control cycle, ms: 3.5 (CR800-R/D) or 7.11 (CR800-Q, CR750).
    #[arg(long, default_value_t = 3.5, value_parser = cycle)]
    pub cycle_ms: f64,
    /// Parameter MXTTOUT: cycles without a packet before an alarm; -1: never, and they are not counted.
    #[arg(long, value_name = "CYCLES", default_value_t = -1, allow_hyphen_values = true,
          value_parser = clap::value_parser!(i32).range(-1..=32767))]
    pub mxtout: i32,
    /// Position of the mode switch at first.
    #[arg(long, value_enum, default_value_t = Mode::Auto)]
    pub mode: Mode,
    /// The servo is on at first.
    #[arg(long)]
    pub servo: bool,
    /// Time from the order to the servo being on, ms.
    #[arg(long, default_value_t = 300)]
    pub servo_delay_ms: u32,
    /// A MELFA-BASIC program to have in the controller, named after its file.
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// The servo is on and that program runs from the beginning.
    #[arg(long, requires = "program")]
    pub run: bool,
    /// What the posture flags of a target are worth: a target in another posture is an alarm, or
    /// they are ignored.
    #[arg(long, value_enum, default_value_t = Posture::Strict)]
    pub posture: Posture,
    /// Speed of the controller's own stops: joint decelerations times this.
    #[arg(long, default_value_t = 1.0, value_parser = positive)]
    pub stop_scale: f64,

    /// Data type id of the force sensor in the monitor.
    #[arg(long, alias = "force-id", default_value_t = pubs_melfa_protocol::monitor::FORCE)]
    pub sensor_id: u16,
    /// The sensor's axes in those of the flange, such as -y,x,z.
    #[arg(long, default_value = "x,y,z", allow_hyphen_values = true)]
    pub sensor_axes: AxisMap,
    /// What the sensor shows of nothing, sensor axes, N.
    #[arg(long, value_name = "X_N,Y_N,Z_N", allow_hyphen_values = true,
          default_value = "1.2,-0.8,3.5", value_parser = numbers::<3>)]
    pub sensor_bias: [f64; 3],

    /// Faults at times, a TOML file.
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
}

/// The mode switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// The network commands.
    Auto,
    /// It does not.
    Manual,
}

/// The fingers at first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Grasp {
    /// They hold the handle.
    Held,
    /// They close as the arm begins to move.
    OnMotion,
    /// They are open.
    Open,
}

/// What posture flags are worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Posture {
    /// They must be those of the arm.
    Strict,
    /// Nothing.
    Ignore,
}

/// A number within a range; NaN is within none.
fn within(text: &str, least: f64, most: f64) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!(
            "{text:?} should be a number from {least} to {most}"
        )),
    }
}

fn fraction(text: &str) -> Result<f64, String> {
    within(text, 0.0, 1.0)
}

fn scale(text: &str) -> Result<f64, String> {
    within(text, 0.0, 10.0)
}

fn positive(text: &str) -> Result<f64, String> {
    within(text, 0.01, 100.0)
}

fn cycle(text: &str) -> Result<f64, String> {
    within(text, 1.0, 100.0)
}

impl Default for Options {
    /// As without any option.
    fn default() -> Self {
        Self::parse_from(["melfa-emulator"])
    }
}

impl Options {
    /// Options as on a command line, without the program's name.
    ///
    /// # Errors
    ///
    /// What is wrong with them, as it would be printed.
    pub fn from_words(words: &[&str]) -> Result<Self, clap::Error> {
        Self::try_parse_from(std::iter::once("melfa-emulator").chain(words.iter().copied()))
    }
}
