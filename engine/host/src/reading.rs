//! A driver's reading, before anybody believes it.

use pubs_plugin::table::RawReading;
use pubs_plugin::{DriverStatus, Reading};

/// How far the norm of an orientation may be from 1.
const UNIT_TOLERANCE: f64 = 1e-3;

/// The reading, or the field at fault and the rule.
pub(crate) fn checked(raw: &RawReading) -> Result<Reading, String> {
    let fields: [(&str, &[f64]); 4] = [
        ("position_m", &raw.position_m),
        ("orientation_xyzw", &raw.orientation_xyzw),
        ("force_n", &raw.force_n),
        ("torque_nm", &raw.torque_nm),
    ];
    for (name, values) in fields {
        if !values.iter().all(|value| value.is_finite()) {
            return Err(format!(
                "`{name}` of the reading is {values:?}; expected finite numbers"
            ));
        }
    }
    let norm = raw
        .orientation_xyzw
        .iter()
        .map(|value| value * value)
        .sum::<f64>()
        .sqrt();
    if (norm - 1.0).abs() > UNIT_TOLERANCE {
        let found = raw.orientation_xyzw;
        return Err(format!(
            "`orientation_xyzw` of the reading is {found:?}, of norm {norm:.4}; expected a unit quaternion"
        ));
    }
    let status = match raw.status {
        0 => DriverStatus::Ready,
        1 => DriverStatus::Stopped,
        2 => DriverStatus::Fault,
        other => {
            return Err(format!(
                "`status` of the reading is {other}; expected 0 (ready), 1 (stopped) or 2 (fault)"
            ));
        }
    };
    Ok(Reading {
        time_ns: raw.time_ns,
        position_m: raw.position_m,
        orientation_xyzw: raw.orientation_xyzw,
        force_n: raw.force_n,
        torque_nm: raw.torque_nm,
        status,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_field_of_a_reading_is_checked() {
        let good = RawReading {
            time_ns: 5,
            orientation_xyzw: [0.0, 0.6, 0.0, 0.8],
            status: 1,
            ..RawReading::default()
        };
        let reading = checked(&good);
        assert_eq!(
            reading.as_ref().map(|reading| reading.status),
            Ok(DriverStatus::Stopped)
        );
        assert_eq!(reading.map(|reading| reading.time_ns), Ok(5));
        let cases = [
            (
                RawReading {
                    position_m: [0.0, f64::NAN, 0.0],
                    ..good
                },
                "position_m",
            ),
            (
                RawReading {
                    force_n: [f64::INFINITY, 0.0, 0.0],
                    ..good
                },
                "force_n",
            ),
            (
                RawReading {
                    torque_nm: [0.0, 0.0, f64::NAN],
                    ..good
                },
                "torque_nm",
            ),
            (
                RawReading {
                    orientation_xyzw: [0.0; 4],
                    ..good
                },
                "unit quaternion",
            ),
            (
                RawReading {
                    orientation_xyzw: [0.0, 0.6, 0.0, 0.802],
                    ..good
                },
                "unit quaternion",
            ),
            (
                RawReading { status: 3, ..good },
                "`status` of the reading is 3",
            ),
        ];
        for (raw, expected) in cases {
            let text = checked(&raw).err().unwrap_or_default();
            assert!(text.contains(expected), "`{text}` should name {expected}");
        }
    }
}
