//! How the force sensor's axes lie in the flange's.

use std::str::FromStr;

use nalgebra::Vector3;

/// For each axis of the sensor: which axis of the flange it is, and with which sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisMap([(usize, f64); 3]);

impl AxisMap {
    /// A vector in sensor axes, given in flange axes.
    pub fn apply(&self, flange: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from(self.0.map(|(index, sign)| sign * flange[index]))
    }
}

impl FromStr for AxisMap {
    type Err = String;

    /// Three axes such as `x,y,z` or `-y,x,z`.
    fn from_str(text: &str) -> Result<Self, String> {
        let fault = || format!("{text:?} should name three axes once each, such as -y,x,z");
        let mut axes = [(0, 0.0); 3];
        let mut parts = text.split(',');
        for axis in &mut axes {
            let part = parts.next().ok_or_else(fault)?.trim();
            let (sign, letter) = match part.strip_prefix('-') {
                Some(letter) => (-1.0, letter),
                None => (1.0, part),
            };
            let index = ["x", "y", "z"].iter().position(|name| *name == letter);
            *axis = (index.ok_or_else(fault)?, sign);
        }
        let named = axes.iter().fold(0, |named, (index, _)| named | 1 << index);
        if named != 0b111 || parts.next().is_some() {
            return Err(fault());
        }
        Ok(Self(axes))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn axes_are_taken_by_name_and_sign() {
        let flange = Vector3::new(1.0, 2.0, 3.0);
        for (text, wanted) in [
            ("x,y,z", [1.0, 2.0, 3.0]),
            ("-y,x,z", [-2.0, 1.0, 3.0]),
            ("z, -x, -y", [3.0, -1.0, -2.0]),
        ] {
            let map: AxisMap = text.parse().unwrap();
            assert_eq!(map.apply(&flange), Vector3::from(wanted), "{text}");
        }
        for text in ["", "x,y", "x,x,z", "x,y,z,x", "x,y,w"] {
            assert!(text.parse::<AxisMap>().is_err(), "{text:?} was taken");
        }
    }
}
