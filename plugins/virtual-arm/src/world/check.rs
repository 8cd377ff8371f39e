//! Checking single values of a world file, each fault with its key and its rule.

use nalgebra::Vector3;

use super::WorldError;

/// Directions may be off unit length, or from a right angle, by rounding only.
pub(super) const DIRECTION_TOLERANCE: f64 = 1e-3;

/// Checks values and brings them to SI; knows the name for messages.
pub(super) struct Reader<'a> {
    pub(super) name: &'a str,
}

impl Reader<'_> {
    /// A length along the handle's way, given in degrees (hinges only) or metres.
    pub(super) fn length(
        &self,
        key: &str,
        deg: Option<f64>,
        m: Option<f64>,
        radius: Option<f64>,
    ) -> Result<f64, WorldError> {
        match (deg, m, radius) {
            (Some(deg), None, Some(radius)) => {
                self.finite(&format!("{key}_deg"), deg.to_radians() * radius)
            }
            (None, Some(m), _) => self.finite(&format!("{key}_m"), m),
            (Some(deg), None, None) => self.fault(
                &format!("{key}_deg"),
                deg,
                "given in _m on a prismatic joint",
            ),
            (Some(_), Some(m), _) => self.fault(
                &format!("{key}_m"),
                m,
                "left out, since it is given in _deg",
            ),
            (None, None, _) => self.fault(key, "nothing", "given, in _deg or _m"),
        }
    }

    pub(super) fn direction(
        &self,
        key: &str,
        direction: [f64; 3],
    ) -> Result<Vector3<f64>, WorldError> {
        let vector = Vector3::from(direction);
        let unit = (vector.norm() - 1.0).abs() < DIRECTION_TOLERANCE;
        self.require(key, format!("{direction:?}"), unit, "a unit vector")?;
        Ok(vector.normalize())
    }

    pub(super) fn positive(&self, key: &str, value: f64) -> Result<f64, WorldError> {
        self.require(
            key,
            value,
            value > 0.0 && value.is_finite(),
            "positive and finite",
        )?;
        Ok(value)
    }

    pub(super) fn not_negative(&self, key: &str, value: f64) -> Result<f64, WorldError> {
        self.require(
            key,
            value,
            value >= 0.0 && value.is_finite(),
            "zero or more, and finite",
        )?;
        Ok(value)
    }

    pub(super) fn finite(&self, key: &str, value: f64) -> Result<f64, WorldError> {
        self.require(key, value, value.is_finite(), "finite")?;
        Ok(value)
    }

    pub(super) fn given<T>(&self, key: &str, value: Option<T>) -> Result<T, WorldError> {
        match value {
            Some(value) => Ok(value),
            None => self.fault(key, "nothing", "given"),
        }
    }

    pub(super) fn absent(&self, key: &str, is_absent: bool, rule: &str) -> Result<(), WorldError> {
        self.require(key, "a value", is_absent, rule)
    }

    pub(super) fn require(
        &self,
        key: &str,
        found: impl std::fmt::Display,
        holds: bool,
        rule: &str,
    ) -> Result<(), WorldError> {
        if holds {
            Ok(())
        } else {
            self.fault(key, found, rule)
        }
    }

    pub(super) fn fault<T>(
        &self,
        key: &str,
        found: impl std::fmt::Display,
        rule: &str,
    ) -> Result<T, WorldError> {
        Err(WorldError::Value {
            name: self.name.to_owned(),
            key: key.to_owned(),
            found: found.to_string(),
            rule: rule.to_owned(),
        })
    }
}
