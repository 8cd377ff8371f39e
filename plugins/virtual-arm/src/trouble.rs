//! What may befall object and grasp while the arm moves them.

use serde::Deserialize;

use crate::plant::Disturbance;

/// Times count from the first command, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trouble {
    /// The handle slips out of the fingers.
    pub slips_at_s: Option<f64>,
    /// The object gets stuck where it is.
    pub jams_at_s: Option<f64>,
    /// Somebody pulls the object by hand.
    pub push: Option<Push>,
}

/// Somebody else's force on the handle.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Push {
    /// From when on, s.
    pub at_s: f64,
    /// For how long, s.
    pub for_s: f64,
    /// Along the way of the handle, positive towards open, N.
    pub force_n: f64,
}

impl Trouble {
    /// What there is of it after `time_s`.
    pub fn at(&self, time_s: f64) -> Disturbance {
        let begun = |at_s: Option<f64>| at_s.is_some_and(|at_s| time_s >= at_s);
        let push_n = self
            .push
            .filter(|push| (push.at_s..push.at_s + push.for_s).contains(&time_s))
            .map_or(0.0, |push| push.force_n);
        Disturbance {
            push_n,
            jammed: begun(self.jams_at_s),
            released: begun(self.slips_at_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trouble_begins_and_ends_in_time() {
        let trouble = Trouble {
            slips_at_s: Some(2.0),
            jams_at_s: Some(1.0),
            push: Some(Push {
                at_s: 0.5,
                for_s: 0.25,
                force_n: -40.0,
            }),
        };
        let cases = [
            (0.0, 0.0, false, false),
            (0.5, -40.0, false, false),
            (0.75, 0.0, false, false),
            (1.0, 0.0, true, false),
            (2.0, 0.0, true, true),
        ];
        for (time_s, push_n, jammed, released) in cases {
            let expected = Disturbance {
                push_n,
                jammed,
                released,
            };
            assert_eq!(trouble.at(time_s), expected, "after {time_s} s");
        }
    }
}
