//! Commands that ask something.

use pubs_melfa_protocol::r3::{format_joints, format_list};

use super::Verb;
use crate::alarm::{Refusal, text_of};
use crate::controller::Controller;

/// Flags of a position without posture.
const NO_FLAGS: (u32, u32) = (0, 0);

/// Greatest speed that `M_Spd` tells, mm/s: it is a setting and moves nothing here.
const SET_SPEED_MM_S: f64 = 10000.0;

/// `None` where the command changes something.
pub(super) fn answer(
    controller: &mut Controller,
    verb: Verb,
    argument: &str,
) -> Option<Result<String, Refusal>> {
    let text = match verb {
        // What the controller says of itself here is not known; invented.
        Verb::Open => Ok("CR800-05VD;RV-5AS-D;melfa-emulator".to_owned()),
        Verb::State => Ok(controller.state().to_string()),
        Verb::ProgramState => Ok(controller.program_state().to_string()),
        Verb::StopSignals => Ok(stop_signals(controller)),
        Verb::Position => Ok(controller.position().to_string()),
        Verb::Joints => Ok(format_joints(&joints_deg(controller))),
        Verb::Override => Ok(controller.override_percent.to_string()),
        Verb::Value => value(controller, argument),
        Verb::ListValue => value(controller, argument),
        Verb::Errors => Ok(errors(controller)),
        Verb::ErrorText => error_text(controller, argument),
        Verb::ErrorRecords => Ok(error_records(controller)),
        Verb::Outputs | Verb::Inputs => signals(controller, verb, argument),
        _ => return None,
    };
    Some(text)
}

fn joints_deg(controller: &Controller) -> [f64; 6] {
    controller.motion.joints().map(f64::to_degrees)
}

/// Stop signals, emergency stops: bits of teaching box, computer, input, operation panel. The
/// layout is inferred.
fn stop_signals(controller: &Controller) -> String {
    let emergency = u8::from(controller.emergency_stop) << 3;
    format!("00;{emergency:02X}")
}

fn errors(controller: &Controller) -> String {
    let number = controller.alarm.as_ref().map_or(0, |alarm| alarm.number);
    format!("{number};")
}

fn error_text(controller: &Controller, argument: &str) -> Result<String, Refusal> {
    let digits = argument.trim().trim_start_matches(['H', 'L', 'C']);
    let number: u32 = digits.parse().map_err(|_| Refusal::BadArgument)?;
    let present = controller.alarm.iter().find(|alarm| alarm.number == number);
    match (present, text_of(number)) {
        (Some(alarm), _) => Ok(alarm.text.clone()),
        (None, Some(text)) => Ok(text.to_owned()),
        (None, None) => Err(Refusal::BadArgument),
    }
}

/// Numbers and texts, newest first; the format is invented.
fn error_records(controller: &Controller) -> String {
    let records = controller.past_alarms.iter().rev();
    let records = records.map(|alarm| format!("{};{};", alarm.number, alarm.text));
    records.collect()
}

/// `<name>;<M|P>`, the second part left out or not.
fn value(controller: &Controller, argument: &str) -> Result<String, Refusal> {
    let name = argument.split(';').next().unwrap_or("").trim();
    let known = match name.to_ascii_uppercase().as_str() {
        "P_CURR" => {
            let position = controller.position();
            let [x, y, z] = position.position_mm;
            let [a, b, c] = position.angles_deg;
            format_list(&[x, y, z, a, b, c], (position.posture, position.turns))
        }
        "J_CURR" => {
            let joints = joints_deg(controller).map(|value| format!("{value:.2}"));
            format!("({})", joints.join(","))
        }
        "P_TOOL" => tool(controller),
        "P_BASE" => format_list(&[0.0; 6], NO_FLAGS),
        "P_FSCURD" => {
            let wrench = controller.scene.shown();
            let (force, torque) = (wrench.force, wrench.torque);
            let values = [force.x, force.y, force.z, torque.x, torque.y, torque.z];
            format_list(&values, NO_FLAGS)
        }
        "M_SPD" => format!("{SET_SPEED_MM_S:.2}"),
        "M_OVRD" => controller.override_percent.to_string(),
        "M_SVO" => u8::from(controller.servo_is_on()).to_string(),
        "M_RUN" => u8::from(controller.task.is_running()).to_string(),
        "M_ERR" => u8::from(controller.alarm.is_some()).to_string(),
        other => {
            let set = controller.variables.get(other);
            set.cloned().ok_or(Refusal::NoVariable)?
        }
    };
    Ok(format!("{name}={known}"))
}

fn tool(controller: &Controller) -> String {
    let tool = controller.scene.tool_offset();
    let pose = pubs_melfa_protocol::Pose::from_isometry(tool, 0, 0);
    let [x, y, z] = pose.position_mm.map(f64::from);
    let [a, b, c] = pose.angles_rad.map(|value| f64::from(value).to_degrees());
    format_list(&[x, y, z, a, b, c], NO_FLAGS)
}

/// `<number>` asks for a word in hex, `=<number>;<hex>` sets one.
fn signals(controller: &mut Controller, verb: Verb, argument: &str) -> Result<String, Refusal> {
    let number = |text: &str| text.trim().parse().map_err(|_| Refusal::BadArgument);
    let Some(assignment) = argument.strip_prefix('=') else {
        let first = number(argument)?;
        let word = match verb {
            Verb::Outputs => controller.outputs.word(first),
            _ => controller.inputs.word(first),
        };
        return Ok(format!("{word:04X}"));
    };
    let (first, value) = assignment.split_once(';').ok_or(Refusal::BadArgument)?;
    let first = number(first)?;
    let value = u16::from_str_radix(value.trim(), 16).map_err(|_| Refusal::BadArgument)?;
    match verb {
        Verb::Outputs => controller.set_outputs(first, u16::MAX, value),
        _ => controller.inputs.set_word(first, u16::MAX, value),
    }
    Ok(String::new())
}
