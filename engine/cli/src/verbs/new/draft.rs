//! What is known so far of a new object. What is not known yet has a value that fits the rest, so
//! that a draft can be checked as a whole after every answer.

use std::collections::BTreeMap;

use serde_json::Value;

use super::measure::Measure;

/// A hinge or a slide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// A hinge.
    Revolute,
    /// A slide.
    Prismatic,
}

impl Joint {
    /// What its limits are measured in.
    pub fn measure(self) -> Measure {
        match self {
            Self::Revolute => Measure::Angle,
            Self::Prismatic => Measure::Length,
        }
    }
}

/// An object file in the making.
#[derive(Debug, Clone, Default)]
pub struct Draft {
    /// Name of the object.
    pub name: Option<String>,
    /// Kind of joint.
    pub joint: Option<Joint>,
    /// Closed and open limit, degrees or m.
    pub limits: Option<[f64; 2]>,
    /// Hinge axis to handle, m.
    pub radius_m: Option<f64>,
    /// Tool frame.
    pub opening: Option<[f64; 3]>,
    /// Tool frame.
    pub up: Option<[f64; 3]>,
    /// Tool frame.
    pub hinge: Option<[f64; 3]>,
    /// Half the width of the goal region, degrees or m.
    pub tolerance: Option<f64>,
    /// Name of the driver plugin.
    pub driver: Option<String>,
    /// Its parameters.
    pub parameters: BTreeMap<String, Value>,
}

impl Draft {
    /// The name, or one that stands in for it.
    pub fn name(&self) -> &str {
        self.name.as_deref().unwrap_or("object")
    }

    /// A hinge unless it is known to be a slide.
    pub fn joint(&self) -> Joint {
        self.joint.unwrap_or(Joint::Revolute)
    }

    /// Closed and open limit, degrees or m.
    pub fn limits(&self) -> [f64; 2] {
        let usual = match self.joint() {
            Joint::Revolute => [0.0, 110.0],
            Joint::Prismatic => [0.0, 0.4],
        };
        self.limits.unwrap_or(usual)
    }

    /// Hinge axis to handle, m.
    pub fn radius_m(&self) -> f64 {
        self.radius_m.unwrap_or(0.4)
    }

    /// The tool points at the object, which comes towards it.
    pub fn opening(&self) -> [f64; 3] {
        self.opening.unwrap_or([0.0, 0.0, -1.0])
    }

    /// The tool's y, or its z where the motion is along y.
    pub fn up(&self) -> [f64; 3] {
        let [x, y, z] = self.opening().map(f64::abs);
        let usual = if y > x.max(z) {
            [0.0, 0.0, 1.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        self.up.unwrap_or(usual)
    }

    /// At a right angle to opening and up: on the left of somebody who faces an upright door.
    pub fn hinge(&self) -> [f64; 3] {
        self.hinge
            .unwrap_or_else(|| cross(self.opening(), self.up()))
    }

    /// A twelfth of the range to one digit: 8 degrees of 100, 3 cm of 40.
    pub fn tolerance(&self) -> f64 {
        let [closed, open] = self.limits();
        let twelfth = (open - closed).abs() / 12.0;
        let digit = 10f64.powf(twelfth.log10().floor());
        let usual = (twelfth / digit).round() * digit;
        self.tolerance.unwrap_or((usual * 1e9).round() / 1e9)
    }

    /// The driver that needs no robot, unless another is known.
    pub fn driver(&self) -> &str {
        self.driver.as_deref().unwrap_or("virtual-arm")
    }
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    // Adding zero turns −0 into 0.
    [b * z - c * y, c * x - a * z, a * y - b * x].map(|part| part + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_fits_what_is() {
        let mut draft = Draft::default();
        assert_eq!(draft.hinge(), [1.0, 0.0, 0.0], "as on door2, on the left");
        for (opening, up) in [
            ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ] {
            draft.opening = Some(opening);
            assert_eq!(draft.up(), up, "{opening:?}");
        }
        for (limits, tolerance) in [([0.0, 100.0], 8.0), ([0.0, 0.4], 0.03), ([-5.0, 7.0], 1.0)] {
            draft.limits = Some(limits);
            assert_eq!(draft.tolerance(), tolerance, "{limits:?}");
        }
    }
}
