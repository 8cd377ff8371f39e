//! The unit in which an object file gives positions of a joint.

use pubs_plugin::JointType;

/// Key suffix and conversion for one type of joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unit {
    suffix: &'static str,
    si_per_unit: f64,
}

impl Unit {
    /// Every unit, to recognise a key that is right for another type of joint.
    pub(crate) const ALL: [Unit; 3] = [
        Unit {
            suffix: "_deg",
            si_per_unit: std::f64::consts::PI / 180.0,
        },
        Unit {
            suffix: "_m",
            si_per_unit: 1.0,
        },
        Unit {
            suffix: "",
            si_per_unit: 1.0,
        },
    ];

    /// Degrees for a hinge, metres for a slide, plain numbers for a benchmark.
    pub(crate) fn of(joint: JointType) -> Self {
        match joint {
            JointType::Revolute => Self::ALL[0],
            JointType::Prismatic => Self::ALL[1],
            JointType::Abstract => Self::ALL[2],
        }
    }

    /// `from` becomes `from_deg`, `from_m` or `from`.
    pub(crate) fn key(self, stem: &str) -> String {
        format!("{stem}{}", self.suffix)
    }

    /// From the file's unit to rad, m or plain.
    pub(crate) fn to_si(self, value: f64) -> f64 {
        value * self.si_per_unit
    }

    /// A position in SI as the file would write it, to six decimals.
    pub(crate) fn show(self, position: f64) -> String {
        let text = format!("{:.6}", position / self.si_per_unit);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" {
            "0".to_owned()
        } else {
            text.to_owned()
        }
    }
}
