//! Parameters that are words.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Where force is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceSource {
    /// The real-time monitor, every control cycle.
    Monitor,
    /// A variable read over R3: slow and uneven, for looking, not for moving.
    R3,
    /// Nowhere; the wrench is zero.
    None,
}

/// What counts as no force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Zero {
    /// What the sensor shows at rest, at the opening and at each tare.
    Resting,
    /// The offsets among the parameters, measured before contact; a tare only looks whether the
    /// sensor is quiet.
    Given,
}

/// What the controller's poses are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControllerPose {
    /// The tool: the controller knows the tool, and so do its poses.
    Tool,
    /// The flange: the driver puts the tool on.
    Flange,
}

/// What ends a request over R3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Terminator {
    /// Nothing.
    None,
    /// Carriage return.
    Cr,
    /// Line feed.
    Lf,
    /// A zero byte.
    Nul,
}

impl Terminator {
    /// The bytes.
    pub fn bytes(self) -> &'static [u8] {
        match self {
            Self::None => b"",
            Self::Cr => b"\r",
            Self::Lf => b"\n",
            Self::Nul => b"\0",
        }
    }
}

/// When the driver writes the program into the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Upload {
    /// Never.
    Never,
    /// Where the controller refuses to start it.
    Missing,
    /// Before every start.
    Always,
}

/// One axis of a tool that an axis of the sensor lies along: "x", "-y" and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SignedAxis {
    index: usize,
    negative: bool,
}

impl SignedAxis {
    /// From its name.
    pub fn named(name: &str) -> Option<Self> {
        let (negative, letter) = match name.strip_prefix('-') {
            Some(letter) => (true, letter),
            None => (false, name.strip_prefix('+').unwrap_or(name)),
        };
        let index = ["x", "y", "z"].iter().position(|axis| *axis == letter)?;
        Some(Self { index, negative })
    }

    /// 0 for x, 1 for y, 2 for z.
    pub fn index(self) -> usize {
        self.index
    }

    /// The axis' component of `vector`, with its sign.
    pub fn of(self, vector: &Vector3<f64>) -> f64 {
        let component = vector[self.index];
        if self.negative { -component } else { component }
    }
}

impl TryFrom<String> for SignedAxis {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::named(&name).ok_or_else(|| format!("`{name}` is no axis: x, y, z, -x, -y and -z are"))
    }
}

impl From<SignedAxis> for String {
    fn from(axis: SignedAxis) -> Self {
        let sign = if axis.negative { "-" } else { "" };
        format!("{sign}{}", ["x", "y", "z"][axis.index])
    }
}
