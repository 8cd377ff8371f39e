//! What the motion thread is at, and what makes it change.

use crate::fault::FaultKind;

/// Phases of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Phase {
    /// Command 0: the arm is watched, nothing is commanded.
    #[default]
    Watching,
    /// Carries out the engine's velocity.
    Following,
    /// Slows down to rest.
    Braking,
    /// At rest; the last target is sent on.
    Holding,
    /// The link is lost: Command 0 from time to time, until it is made again.
    Lost,
    /// The session is over; nothing is sent.
    Ended,
}

impl Phase {
    /// Whether targets are sent.
    pub fn commands(self) -> bool {
        matches!(self, Self::Following | Self::Braking | Self::Holding)
    }
}

/// What bears on the phase in one cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inputs {
    /// A velocity is wanted, has not run out, and nothing forbids it.
    pub ordered: bool,
    /// The target stands.
    pub at_rest: bool,
    /// And has stood so long that the arm does too.
    pub settled: bool,
    /// No reply has come for some cycles.
    pub silent: bool,
    /// None for so long, or the thread stood so long, that the link is lost.
    pub lost: bool,
    /// The controller answers again and says that it may move.
    pub relinked: bool,
    /// A fault.
    pub fault: Option<FaultKind>,
    /// The driver is being closed.
    pub closing: bool,
}

impl Phase {
    /// The next phase.
    pub fn next(self, inputs: &Inputs) -> Self {
        if self == Self::Ended || inputs.fault == Some(FaultKind::Safety) {
            // The controller has stopped the arm; a target sent on could move it when somebody
            // starts the program again.
            return Self::Ended;
        }
        if inputs.fault.is_some() || inputs.closing {
            return self.towards_the_end(inputs);
        }
        if inputs.lost {
            return Self::Lost;
        }
        match self {
            Self::Lost if inputs.relinked => Self::Watching,
            Self::Lost => Self::Lost,
            // A target that may never have come through is not sent again: the next reply says where
            // to begin.
            Self::Holding if inputs.silent => Self::Watching,
            _ if inputs.ordered && !inputs.silent => Self::Following,
            Self::Following => Self::Braking,
            Self::Braking if inputs.at_rest => Self::Holding,
            other => other,
        }
    }

    fn towards_the_end(self, inputs: &Inputs) -> Self {
        match self {
            Self::Following => Self::Braking,
            Self::Braking | Self::Holding if inputs.lost || inputs.settled => Self::Ended,
            Self::Braking if inputs.at_rest => Self::Holding,
            Self::Braking | Self::Holding => self,
            Self::Watching | Self::Lost | Self::Ended => Self::Ended,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Phase::{Braking, Ended, Following, Holding, Lost, Watching};
    use super::*;

    const ALL: [Phase; 6] = [Watching, Following, Braking, Holding, Lost, Ended];

    /// Name, what it sets, and what comes of each phase.
    type Case = (&'static str, fn(&mut Inputs), [Phase; 6]);

    #[test]
    fn phases_follow_each_other() {
        let ordered = |inputs: &mut Inputs| inputs.ordered = true;
        let nothing = |_: &mut Inputs| {};
        let at_rest = |inputs: &mut Inputs| inputs.at_rest = true;
        let settled = |inputs: &mut Inputs| (inputs.at_rest, inputs.settled) = (true, true);
        let silent = |inputs: &mut Inputs| (inputs.silent, inputs.ordered) = (true, true);
        let lost = |inputs: &mut Inputs| (inputs.lost, inputs.ordered) = (true, true);
        let relinked = |inputs: &mut Inputs| (inputs.relinked, inputs.ordered) = (true, true);
        let safety =
            |inputs: &mut Inputs| (inputs.fault, inputs.ordered) = (Some(FaultKind::Safety), true);
        let driver =
            |inputs: &mut Inputs| (inputs.fault, inputs.ordered) = (Some(FaultKind::Driver), true);
        let closed = |inputs: &mut Inputs| {
            (inputs.closing, inputs.at_rest, inputs.settled) = (true, true, true)
        };
        let cases: [Case; 10] = [
            // From Watching, Following, Braking, Holding, Lost, Ended.
            (
                "ordered",
                ordered,
                [Following, Following, Following, Following, Lost, Ended],
            ),
            (
                "nothing ordered",
                nothing,
                [Watching, Braking, Braking, Holding, Lost, Ended],
            ),
            (
                "at rest",
                at_rest,
                [Watching, Braking, Holding, Holding, Lost, Ended],
            ),
            (
                "settled",
                settled,
                [Watching, Braking, Holding, Holding, Lost, Ended],
            ),
            (
                "silent",
                silent,
                [Watching, Braking, Braking, Watching, Lost, Ended],
            ),
            ("lost", lost, [Lost, Lost, Lost, Lost, Lost, Ended]),
            (
                "relinked",
                relinked,
                [Following, Following, Following, Following, Watching, Ended],
            ),
            ("safety stop", safety, [Ended; 6]),
            (
                "driver fault",
                driver,
                [Ended, Braking, Braking, Holding, Ended, Ended],
            ),
            (
                "closing at rest",
                closed,
                [Ended, Braking, Ended, Ended, Ended, Ended],
            ),
        ];
        for (name, set, expected) in cases {
            let mut inputs = Inputs::default();
            set(&mut inputs);
            let found = ALL.map(|phase| phase.next(&inputs));
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn nothing_follows_an_end_or_commands_in_a_lost_link() {
        for bits in 0..256_u32 {
            let bit = |index: u32| bits & (1 << index) != 0;
            let inputs = Inputs {
                ordered: bit(0),
                at_rest: bit(1),
                settled: bit(2),
                lost: bit(3),
                relinked: bit(4),
                fault: bit(5).then_some(FaultKind::Driver),
                closing: bit(6),
                silent: bit(7),
            };
            assert_eq!(Ended.next(&inputs), Ended, "{inputs:?}");
            assert!(!Lost.next(&inputs).commands(), "{inputs:?}");
        }
    }
}
