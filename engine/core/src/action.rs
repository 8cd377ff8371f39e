//! The action space A, §III-A.2.

/// Interaction mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Stops where the sensed force passes the threshold F_t.
    Safe,
    /// Moves on through resistance; the only mode that can violate safety.
    HighForce,
}

/// What an action does during one policy step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// a0: the task is done.
    Stop,
    /// Any other action.
    Move {
        /// Interaction mode.
        mode: Mode,
        /// Δs of one unhindered policy step, signed, positive towards open (rad, m or plain).
        displacement: f64,
        /// Filter updates, each with an observation, in one policy step.
        observations: u32,
    },
}

/// One action, known by its index in [`Task::actions`](crate::Task::actions).
#[derive(Debug, Clone, PartialEq)]
pub struct Action {
    /// Name in object and policy files, such as `safe_open`.
    pub name: String,
    /// What it does.
    pub motion: Motion,
}

impl Action {
    /// Whether it ends the episode.
    pub fn is_stop(&self) -> bool {
        self.motion == Motion::Stop
    }

    /// Δs of one unhindered policy step, signed; 0 for stop.
    pub fn displacement(&self) -> f64 {
        match self.motion {
            Motion::Stop => 0.0,
            Motion::Move { displacement, .. } => displacement,
        }
    }

    /// Filter updates in one policy step; 0 for stop.
    pub fn observations(&self) -> u32 {
        match self.motion {
            Motion::Stop => 0,
            Motion::Move { observations, .. } => observations,
        }
    }

    /// Whether it moves in high-force mode.
    pub fn is_high_force(&self) -> bool {
        matches!(
            self.motion,
            Motion::Move {
                mode: Mode::HighForce,
                ..
            }
        )
    }

    /// +1 towards open, −1 towards closed, 0 for stop.
    pub fn sign(&self) -> f64 {
        match self.motion {
            Motion::Stop => 0.0,
            Motion::Move { displacement, .. } => displacement.signum(),
        }
    }
}
