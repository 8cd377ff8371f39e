//! The tables as TOML.

use pubs_virtual_arm::world::Joint;

use crate::fit::{ForceSegment, MovedSegment};

/// How states are written.
pub struct Unit {
    suffix: &'static str,
    per_si: f64,
    decimals: usize,
}

impl Unit {
    pub fn of(joint: &Joint) -> Self {
        match joint.radius_m {
            Some(_) => Self {
                suffix: "deg",
                per_si: 1f64.to_degrees(),
                decimals: 2,
            },
            None => Self {
                suffix: "m",
                per_si: 1.0,
                decimals: 5,
            },
        }
    }

    fn write(&self, state: f64) -> String {
        number(state * self.per_si, self.decimals)
    }
}

/// Rounded, without trailing zeros but always with a decimal.
fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = text.trim_end_matches('0');
    let text = if text.ends_with('.') {
        format!("{text}0")
    } else {
        text.to_owned()
    };
    if text == "-0.0" {
        "0.0".to_owned()
    } else {
        text
    }
}

fn list(values: &[f64], write: impl Fn(f64) -> String) -> String {
    let items: Vec<_> = values.iter().map(|&value| write(value)).collect();
    format!("[{}]", items.join(", "))
}

fn head(action: &str, channel: &str, from: f64, to: f64, unit: &Unit) {
    println!("\n[[observation.segment]]\naction = \"{action}\"\nchannel = \"{channel}\"");
    println!(
        "from_{} = {}\nto_{} = {}",
        unit.suffix,
        unit.write(from),
        unit.suffix,
        unit.write(to)
    );
}

pub fn force(action: &str, channel: &str, segments: &[ForceSegment], unit: &Unit) {
    for segment in segments {
        let (from, to) = (
            segment.position[0],
            segment.position[segment.position.len() - 1],
        );
        head(action, channel, from, to, unit);
        println!("sigma_n = {}", number(segment.sigma_n, 2));
        println!(
            "position_{} = {}",
            unit.suffix,
            list(&segment.position, |state| unit.write(state))
        );
        println!(
            "mean_n = {}",
            list(&segment.mean_n, |force| number(force, 2))
        );
    }
}

pub fn moved(action: &str, segments: &[MovedSegment], unit: &Unit) {
    for segment in segments {
        head(action, "m_p", segment.from, segment.to, unit);
        println!("probability = {}", number(segment.probability, 2));
    }
}
