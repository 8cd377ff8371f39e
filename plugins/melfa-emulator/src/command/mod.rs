//! The commands of R3.

mod action;
mod query;

use pubs_melfa_protocol::r3::{LONGEST_REQUEST, Reply, Request};

use crate::alarm::Refusal;
use crate::controller::Controller;
use crate::options::Mode;

pub(crate) use action::release_right;

/// The commands, and whether anything follows their names.
const COMMANDS: [(&str, Verb); 35] = [
    ("OPEN=", Verb::Open),
    ("CLOSE", Verb::Close),
    ("CNTLON", Verb::TakeRight),
    ("CNTLOFF", Verb::ReleaseRight),
    ("SRVON", Verb::ServoOn),
    ("SRVOFF", Verb::ServoOff),
    ("RSTALRM", Verb::ResetAlarm),
    ("STOP", Verb::Stop),
    ("CSTOP", Verb::CycleStop),
    ("RSTPRG", Verb::ResetProgram),
    ("SLOTINIT", Verb::InitialiseSlots),
    ("PRGLOAD=", Verb::SelectProgram),
    ("RUN", Verb::Run),
    ("OVRD=", Verb::SetOverride),
    ("OVRD", Verb::Override),
    ("EXEC", Verb::Execute),
    ("NEW", Verb::NewProgram),
    ("LOAD=", Verb::OpenProgram),
    ("ECLR", Verb::ClearProgram),
    ("EMDAT", Verb::AddLines),
    ("SAVE", Verb::SaveProgram),
    ("OUT", Verb::Outputs),
    ("IN", Verb::Inputs),
    ("DSTATE", Verb::State),
    ("STATE", Verb::ProgramState),
    ("STPSIG", Verb::StopSignals),
    ("PPOSF", Verb::Position),
    ("JPOSF", Verb::Joints),
    ("VAL", Verb::Value),
    ("HOT", Verb::SetValue),
    ("LISTP", Verb::ListValue),
    ("ERRORMES", Verb::ErrorText),
    ("ERRORRD", Verb::ErrorRecords),
    ("ERROR", Verb::Errors),
    ("CHGPRT=", Verb::ChangeProtocol),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verb {
    Open,
    Close,
    TakeRight,
    ReleaseRight,
    ServoOn,
    ServoOff,
    ResetAlarm,
    Stop,
    CycleStop,
    ResetProgram,
    InitialiseSlots,
    SelectProgram,
    Run,
    SetOverride,
    Override,
    Execute,
    NewProgram,
    OpenProgram,
    ClearProgram,
    AddLines,
    SaveProgram,
    Outputs,
    Inputs,
    State,
    ProgramState,
    StopSignals,
    Position,
    Joints,
    Value,
    SetValue,
    ListValue,
    ErrorText,
    ErrorRecords,
    Errors,
    ChangeProtocol,
}

impl Verb {
    /// Whether something may follow the name.
    fn takes_argument(self) -> bool {
        use Verb as V;
        matches!(
            self,
            V::Open
                | V::SelectProgram
                | V::Run
                | V::SetOverride
                | V::Execute
                | V::OpenProgram
                | V::AddLines
                | V::Outputs
                | V::Inputs
                | V::Value
                | V::SetValue
                | V::ListValue
                | V::ErrorText
                | V::ErrorRecords
                | V::ChangeProtocol
        )
    }

    /// Whether it changes the controller or moves the arm, which the network may not in MANUAL.
    /// Stopping, and letting go, it always may.
    fn commands(self) -> bool {
        use Verb as V;
        matches!(
            self,
            V::TakeRight
                | V::ServoOn
                | V::ResetAlarm
                | V::ResetProgram
                | V::InitialiseSlots
                | V::SelectProgram
                | V::Run
                | V::SetOverride
                | V::Execute
                | V::NewProgram
                | V::OpenProgram
                | V::ClearProgram
                | V::AddLines
                | V::SaveProgram
                | V::SetValue
        )
    }

    /// Whether the operation right is needed.
    fn needs_right(self) -> bool {
        use Verb as V;
        matches!(self, V::ServoOn | V::Run | V::SetOverride | V::Execute)
    }
}

/// The command and what follows its name: of all names the longest that fits.
fn read(command: &str) -> Option<(Verb, &str)> {
    let fitting = COMMANDS.iter().filter_map(|(name, verb)| {
        let argument = command.strip_prefix(name)?;
        let whole = argument.is_empty() || verb.takes_argument();
        whole.then_some((name.len(), *verb, argument))
    });
    let longest = fitting.max_by_key(|(length, ..)| *length);
    longest.map(|(_, verb, argument)| (verb, argument))
}

/// Whether a text is a request that could be carried out as it stands.
pub fn is_known(text: &str) -> bool {
    let request = text.parse::<Request>();
    request.is_ok_and(|request| read(&request.command).is_some())
}

/// Whether a text begins as a request does.
pub fn begins(text: &str) -> bool {
    let bytes = text.as_bytes();
    let header = bytes.len() > 4
        && bytes[0].is_ascii_digit()
        && bytes[1] == b';'
        && bytes[2].is_ascii_digit()
        && bytes[3] == b';';
    header && COMMANDS.iter().any(|(name, _)| text[4..].starts_with(name))
}

/// Carries out what a connection asks, and answers.
pub fn answer(controller: &mut Controller, text: &str, connection: u64) -> Reply {
    let result = carry_out(controller, text, connection);
    let in_alarm = controller.alarm.is_some();
    match result {
        Ok(answer) => Reply::done(answer, in_alarm),
        Err(refusal) => Reply::refused(refusal.number(), in_alarm),
    }
}

fn carry_out(controller: &mut Controller, text: &str, connection: u64) -> Result<String, Refusal> {
    if text.len() > LONGEST_REQUEST {
        return Err(Refusal::TooLong);
    }
    let request: Request = text.parse().map_err(|_| Refusal::UnknownCommand)?;
    if request.robot != 1 {
        return Err(Refusal::BadArgument);
    }
    let (verb, argument) = read(&request.command).ok_or(Refusal::UnknownCommand)?;
    if verb.commands() && controller.mode == Mode::Manual {
        return Err(Refusal::Manual);
    }
    if verb.needs_right() && controller.operation_right != Some(connection) {
        return Err(Refusal::NoOperationRight);
    }
    match query::answer(controller, verb, argument) {
        Some(answer) => answer,
        None => action::carry_out(controller, verb, argument, connection),
    }
}
