//! What can be asked for over the control socket and in a scenario.

use serde::Deserialize;

use crate::options::Mode;

/// Which UDP service.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Service {
    /// External control.
    #[default]
    Mxt,
    /// The real-time monitor.
    Monitor,
    /// Both.
    Both,
}

impl Service {
    /// Indices of [`crate::faults::Faults::links`].
    pub fn indices(self) -> &'static [usize] {
        match self {
            Self::Mxt => &[0],
            Self::Monitor => &[1],
            Self::Both => &[0, 1],
        }
    }
}

/// Which way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// From the client.
    ToController,
    /// To the client.
    ToClient,
    /// Both.
    #[default]
    Both,
}

impl Direction {
    /// Indices of a service's pair of links.
    pub fn indices(self) -> &'static [usize] {
        match self {
            Self::ToController => &[0],
            Self::ToClient => &[1],
            Self::Both => &[0, 1],
        }
    }
}

/// How R3 behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum R3State {
    /// Connections are closed; new ones are taken.
    Close,
    /// Connections are closed, new ones refused.
    Refuse,
    /// New ones are taken again.
    Accept,
}

/// A fault of packets under way; each of them on its own.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Losses {
    /// Of a loss to begin at a packet.
    pub probability: f64,
    /// Packets lost in a row.
    #[serde(default = "one")]
    pub burst: u32,
    /// Which service.
    #[serde(default)]
    pub service: Service,
    /// Which way.
    #[serde(default)]
    pub direction: Direction,
    /// For how long; for good where left out.
    pub seconds: Option<f64>,
}

/// Packets that come late.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Delays {
    /// Least delay, ms.
    pub ms: f64,
    /// A random part on top, up to this, ms.
    #[serde(default)]
    pub jitter_ms: f64,
    /// Which service.
    #[serde(default)]
    pub service: Service,
    /// Which way.
    #[serde(default)]
    pub direction: Direction,
    /// For how long; for good where left out.
    pub seconds: Option<f64>,
}

/// Packets that come twice, or after their successors.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disorder {
    /// Of a packet to be hit.
    pub probability: f64,
    /// Which service.
    #[serde(default)]
    pub service: Service,
    /// Which way.
    #[serde(default)]
    pub direction: Direction,
    /// For how long; for good where left out.
    pub seconds: Option<f64>,
}

/// Packets that are cut.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cuts {
    /// Of a packet to be hit.
    pub probability: f64,
    /// What is left of it.
    #[serde(default = "hundred")]
    pub bytes: usize,
    /// Which service.
    #[serde(default)]
    pub service: Service,
    /// Which way.
    #[serde(default)]
    pub direction: Direction,
    /// For how long; for good where left out.
    pub seconds: Option<f64>,
}

/// A fault, or its end: the object's key `do` names it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Fault {
    /// Ends all faults of links, R3, sensor and object.
    Clear,
    /// Packets get lost.
    Drop(Losses),
    /// Packets come late.
    Delay(Delays),
    /// Packets come twice.
    Duplicate(Disorder),
    /// Packets are overtaken by their successors.
    Reorder(Disorder),
    /// Packets are cut.
    Short(Cuts),
    /// A service sends nothing, though it hears.
    Silent {
        /// Which.
        #[serde(default)]
        service: Service,
        /// For how long; for good where left out.
        seconds: Option<f64>,
    },
    /// Somebody else sends the client packets.
    Stranger {
        /// How many, one a cycle.
        #[serde(default = "one")]
        count: u32,
        /// Packets like those of this service.
        #[serde(default)]
        service: Service,
    },
    /// The controller raises an alarm.
    Alarm {
        /// Its number.
        number: u32,
        /// Its text, where the number has none.
        text: Option<String>,
    },
    /// The button.
    EmergencyStop {
        /// Pressed or released.
        #[serde(default = "yes")]
        pressed: bool,
    },
    /// The collaborative arm feels a contact.
    ContactStop,
    /// The mode switch.
    Mode {
        /// Its new position.
        mode: Mode,
    },
    /// R3 goes or comes back.
    R3 {
        /// What it does.
        state: R3State,
    },
    /// The sensor shows no more than this.
    Saturate {
        /// N; left out: it does again.
        limit_n: Option<f64>,
    },
    /// The sensor's bias jumps.
    BiasStep {
        /// By this, sensor axes, N.
        force_n: [f64; 3],
    },
    /// The sensor's bias drifts.
    BiasRate {
        /// At this rate, sensor axes, N/s.
        force_n_per_s: [f64; 3],
    },
    /// The handle slips out of the fingers.
    Slip,
    /// The fingers close on it again.
    Grasp,
    /// The object jams.
    Jam {
        /// Or is free again.
        #[serde(default = "yes")]
        jammed: bool,
        /// For how long; for good where left out.
        seconds: Option<f64>,
    },
    /// Somebody pulls the object.
    Pull {
        /// Along its way, towards open, N.
        force_n: f64,
        /// For how long.
        seconds: f64,
    },
}

fn one() -> u32 {
    1
}

fn hundred() -> usize {
    100
}

fn yes() -> bool {
    true
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn faults_have_defaults_and_refuse_what_they_do_not_know() {
        let read = |text: &str| serde_json::from_str::<Fault>(text);
        let drop = read(r#"{"do":"drop","probability":0.2}"#).unwrap();
        let losses = Losses {
            probability: 0.2,
            burst: 1,
            service: Service::Mxt,
            direction: Direction::Both,
            seconds: None,
        };
        assert_eq!(drop, Fault::Drop(losses));
        let stop = read(r#"{"do":"emergency_stop"}"#).unwrap();
        assert_eq!(stop, Fault::EmergencyStop { pressed: true });
        for text in [
            r#"{"do":"drop","probability":0.2,"bursts":3}"#,
            r#"{"do":"jam","second":3}"#,
            r#"{"do":"drop"}"#,
            r#"{"do":"fly"}"#,
            r#"{}"#,
        ] {
            assert!(read(text).is_err(), "{text} was taken");
        }
    }
}
