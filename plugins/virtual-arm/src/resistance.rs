//! What the object sets against motion: catch, springs, stops, friction, by the handle's way.

use crate::world::Resistance;

/// A catch or seal is nothing this many widths away.
const BUMP_REACH: f64 = 12.0;

/// [`Resistance`] between its limits.
#[derive(Debug, Clone)]
pub struct Resisting {
    forces: Resistance,
    lower_m: f64,
    lower_contact_m: f64,
    upper_contact_m: f64,
}

impl Resisting {
    /// Puts the stops where the joint, left alone, rests at its limits: springs and catch press
    /// it a little into the stop there.
    pub fn new(forces: Resistance, lower_m: f64, upper_m: f64) -> Self {
        let mut resisting = Self {
            forces,
            lower_m,
            lower_contact_m: lower_m,
            upper_contact_m: upper_m,
        };
        let stiffness = resisting.forces.stop.stiffness_n_per_m;
        resisting.lower_contact_m += resisting.closing_force_n(lower_m).max(0.0) / stiffness;
        resisting.upper_contact_m += resisting.closing_force_n(upper_m).min(0.0) / stiffness;
        resisting
    }

    /// Force of catch, seal and springs towards closed at handle position `x_m`, N.
    pub fn closing_force_n(&self, x_m: f64) -> f64 {
        let forces = &self.forces;
        let way = (x_m - self.lower_m).max(0.0);
        let [preload, stiffness] = forces.closing_spring;
        let mut force = preload + stiffness * way;
        if forces.catch.force_n > 0.0 && way < forces.catch.width_m * BUMP_REACH {
            let widths = way / forces.catch.width_m;
            force += forces.catch.force_n * (-0.5 * widths * widths).exp();
        }
        if forces.seal.force_n > 0.0 && way < forces.seal.width_m * BUMP_REACH {
            force += forces.seal.force_n * (-way / forces.seal.width_m).exp();
        }
        if forces.spring_hinge.force_n > 0.0 {
            let hinge = &forces.spring_hinge;
            force += hinge.force_n / (1.0 + ((x_m - hinge.middle_m) / hinge.slope_m).exp());
        }
        force
    }

    /// Force of the stops in the opening direction, N; they push, they never hold.
    pub fn stop_force_n(&self, x_m: f64, speed_m_s: f64) -> f64 {
        let stop = &self.forces.stop;
        let push = |depth: f64, inward: f64| {
            (stop.stiffness_n_per_m * depth + stop.damping_n_s_per_m * inward).max(0.0)
        };
        if x_m < self.lower_contact_m {
            push(self.lower_contact_m - x_m, -speed_m_s)
        } else if x_m > self.upper_contact_m {
            -push(x_m - self.upper_contact_m, speed_m_s)
        } else {
            0.0
        }
    }

    /// Size of dry friction, N.
    pub fn coulomb_n(&self, x_m: f64) -> f64 {
        self.forces.coulomb_n + self.forces.ripple.at(x_m).0
    }

    /// N per m/s.
    pub fn viscous_n_s_per_m(&self) -> f64 {
        self.forces.viscous_n_s_per_m
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::world::World;

    #[test]
    fn door2_has_the_forces_its_file_claims() {
        let world = World::load("door2").unwrap();
        let door = Resisting::new(world.resistance, 0.0, 125f64.to_radians() * 0.32);
        let at = |deg: f64| deg.to_radians() * 0.32;
        // Catch 15.5 exp(-(θ/1.2)²/2) + hinge 5/(1 + e^((θ-17)/4)), worked out by hand.
        for (deg, force) in [
            (0.0, 15.5 + 4.9297),
            (1.2, 9.4012 + 4.9056),
            (17.0, 2.5),
            (125.0, 0.0),
        ] {
            let found = door.closing_force_n(at(deg));
            assert!(
                (found - force).abs() < 2e-3,
                "at {deg} degrees {force} N, found {found}"
            );
        }
    }

    #[test]
    fn closed_door_rests_at_its_limit() {
        let world = World::load("door2").unwrap();
        let door = Resisting::new(world.resistance, 0.0, 0.7);
        let (pull, push) = (door.closing_force_n(0.0), door.stop_force_n(0.0, 0.0));
        assert!(
            (pull - push).abs() < 1e-9,
            "catch pulls {pull} N, stop pushes {push} N"
        );
    }

    #[test]
    fn stop_never_holds_back() {
        let world = World::load("door2").unwrap();
        let door = Resisting::new(world.resistance, 0.0, 0.7);
        assert_eq!(
            door.stop_force_n(-1e-4, 10.0),
            0.0,
            "leaving the closed stop fast"
        );
        assert_eq!(
            door.stop_force_n(0.7001, -10.0),
            0.0,
            "leaving the open stop fast"
        );
    }
}
