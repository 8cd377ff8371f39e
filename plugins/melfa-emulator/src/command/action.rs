//! Commands that change something.

use super::Verb;
use crate::alarm::Refusal;
use crate::controller::Controller;
use crate::program::{Statement, statement};
use crate::task::Progress;

type Outcome = Result<(), Refusal>;

pub(super) fn carry_out(
    controller: &mut Controller,
    verb: Verb,
    argument: &str,
    connection: u64,
) -> Result<String, Refusal> {
    match verb {
        Verb::TakeRight => take_right(controller, connection),
        Verb::ReleaseRight | Verb::Close => {
            release_right(controller, connection);
            Ok(())
        }
        Verb::ServoOn => servo_on(controller),
        Verb::ServoOff => {
            controller.order_servo_off();
            Ok(())
        }
        Verb::ResetAlarm => reset_alarm(controller),
        Verb::Stop => {
            controller.stop_program();
            Ok(())
        }
        Verb::CycleStop => {
            controller.task.cycle_stop = true;
            Ok(())
        }
        Verb::ResetProgram | Verb::InitialiseSlots => reset_program(controller),
        Verb::SelectProgram => select(controller, argument),
        Verb::Run => run(controller, argument),
        Verb::SetOverride => set_override(controller, argument),
        Verb::Execute => execute(controller, argument),
        Verb::NewProgram => {
            controller.store.close_edit();
            Ok(())
        }
        Verb::OpenProgram => open_program(controller, argument),
        Verb::ClearProgram => controller.store.clear_edit(),
        Verb::AddLines => controller.store.add_lines(argument),
        Verb::SaveProgram => controller.store.save_edit(),
        Verb::SetValue => set_value(controller, argument),
        // Framed messages are not spoken here.
        _ => Err(Refusal::UnknownCommand),
    }
    .map(|()| String::new())
}

fn take_right(controller: &mut Controller, connection: u64) -> Outcome {
    match controller.operation_right {
        Some(holder) if holder != connection => Err(Refusal::Busy),
        _ => {
            controller.operation_right = Some(connection);
            Ok(())
        }
    }
}

/// Gives the operation right back where this connection has it.
pub(crate) fn release_right(controller: &mut Controller, connection: u64) {
    if controller.operation_right == Some(connection) {
        controller.operation_right = None;
    }
}

fn not_in_alarm(controller: &Controller) -> Outcome {
    match (controller.emergency_stop, controller.alarm.is_some()) {
        (true, _) => Err(Refusal::EmergencyStop),
        (false, true) => Err(Refusal::InAlarm),
        (false, false) => Ok(()),
    }
}

fn not_running(controller: &Controller) -> Outcome {
    match controller.task.is_running() {
        true => Err(Refusal::Running),
        false => Ok(()),
    }
}

fn servo_on(controller: &mut Controller) -> Outcome {
    not_in_alarm(controller)?;
    controller.order_servo_on();
    Ok(())
}

fn reset_alarm(controller: &mut Controller) -> Outcome {
    if controller.emergency_stop {
        return Err(Refusal::EmergencyStop);
    }
    controller.alarm = None;
    Ok(())
}

fn reset_program(controller: &mut Controller) -> Outcome {
    not_running(controller)?;
    controller.task.reset();
    Ok(())
}

fn select(controller: &mut Controller, name: &str) -> Outcome {
    not_running(controller)?;
    if controller.task.progress == Progress::Interrupted {
        return Err(Refusal::Interrupted);
    }
    let program = controller.store.get(name).cloned();
    controller
        .task
        .select(name, program.ok_or(Refusal::NoProgram)?);
    Ok(())
}

/// `<name>;<mode>`: mode 0 repeats, 1 runs once; without a name, or with mode -1, what is
/// selected.
fn run(controller: &mut Controller, argument: &str) -> Outcome {
    not_in_alarm(controller)?;
    not_running(controller)?;
    let (name, mode) = argument.split_once(';').unwrap_or((argument, ""));
    let repeat = match mode.trim() {
        "0" => true,
        "1" => false,
        "" | "-1" => controller.task.repeat,
        _ => return Err(Refusal::BadArgument),
    };
    let name = name.trim();
    let resumes = name.is_empty() || name.eq_ignore_ascii_case(&controller.task.name);
    // A program that is at its beginning is taken as it was last saved.
    let selected = match name.is_empty() {
        true => controller.task.name.clone(),
        false => name.to_owned(),
    };
    if controller.task.progress == Progress::Ready || !resumes {
        select(controller, &selected)?;
    }
    controller.task.start(repeat);
    Ok(())
}

fn set_override(controller: &mut Controller, argument: &str) -> Outcome {
    let percent = argument.trim().parse().map_err(|_| Refusal::BadArgument)?;
    if !(1..=100).contains(&percent) {
        return Err(Refusal::BadArgument);
    }
    controller.override_percent = percent;
    Ok(())
}

fn execute(controller: &mut Controller, instruction: &str) -> Outcome {
    match statement(instruction) {
        Statement::Servo(true) => servo_on(controller),
        Statement::Servo(false) => {
            controller.order_servo_off();
            Ok(())
        }
        Statement::Override(percent) => set_override(controller, &percent.to_string()),
        _ => not_in_alarm(controller),
    }
}

fn open_program(controller: &mut Controller, name: &str) -> Outcome {
    let running = controller.task.is_running();
    if running && name.trim().eq_ignore_ascii_case(&controller.task.name) {
        return Err(Refusal::Running);
    }
    controller.store.open_edit(name.trim())
}

/// `<program>;<variable>=<value>`.
fn set_value(controller: &mut Controller, argument: &str) -> Outcome {
    let (_, assignment) = argument.split_once(';').ok_or(Refusal::BadArgument)?;
    let (name, value) = assignment.split_once('=').ok_or(Refusal::BadArgument)?;
    let name = name.trim().to_ascii_uppercase();
    controller.variables.insert(name, value.trim().to_owned());
    Ok(())
}
