//! A velocity with its linear and angular part.

use nalgebra::Vector3;

/// Linear and angular velocity (m/s, rad/s), or acceleration (m/s², rad/s²), base axes at the tool
/// origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Linear part.
    pub linear: Vector3<f64>,
    /// Angular part.
    pub angular: Vector3<f64>,
}

impl Motion {
    /// Both parts times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            linear: self.linear * factor,
            angular: self.angular * factor,
        }
    }

    /// This and `factor` times `other`.
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        Self {
            linear: self.linear + other.linear * factor,
            angular: self.angular + other.angular * factor,
        }
    }

    /// Whether both parts are exactly zero.
    pub fn is_zero(&self) -> bool {
        self.linear == Vector3::zeros() && self.angular == Vector3::zeros()
    }

    /// The factor, at most 1, that brings both parts within their bounds.
    pub fn factor_within(&self, linear: f64, angular: f64) -> f64 {
        let share = |size: f64, bound: f64| if size > bound { bound / size } else { 1.0 };
        share(self.linear.norm(), linear).min(share(self.angular.norm(), angular))
    }
}

impl From<&pubs_plugin::Twist> for Motion {
    fn from(twist: &pubs_plugin::Twist) -> Self {
        Self {
            linear: twist.linear_m_s.into(),
            angular: twist.angular_rad_s.into(),
        }
    }
}
