//! The values of a frame, as a table and as an MCAP file name them.

use pubs_run::recording::Frame;

/// One value of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Column {
    Time,
    Action,
    Demonstration,
    Position(usize),
    Orientation(usize),
    Force(usize),
    Torque(usize),
    Speed,
    Settled,
    Status,
    Truth,
}

impl Column {
    /// All of them, in the order of a table.
    pub const ALL: [Self; 20] = [
        Self::Time,
        Self::Action,
        Self::Demonstration,
        Self::Position(0),
        Self::Position(1),
        Self::Position(2),
        Self::Orientation(0),
        Self::Orientation(1),
        Self::Orientation(2),
        Self::Orientation(3),
        Self::Force(0),
        Self::Force(1),
        Self::Force(2),
        Self::Torque(0),
        Self::Torque(1),
        Self::Torque(2),
        Self::Speed,
        Self::Settled,
        Self::Status,
        Self::Truth,
    ];

    /// Its name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time_s",
            Self::Action => "action",
            Self::Demonstration => "demonstration",
            Self::Position(axis) => ["x_m", "y_m", "z_m"][axis],
            Self::Orientation(axis) => ["qx", "qy", "qz", "qw"][axis],
            Self::Force(axis) => ["force_x_n", "force_y_n", "force_z_n"][axis],
            Self::Torque(axis) => ["torque_x_nm", "torque_y_nm", "torque_z_nm"][axis],
            Self::Speed => "speed_m_s",
            Self::Settled => "settled",
            Self::Status => "status",
            Self::Truth => "true_state",
        }
    }

    /// Topic and field in an MCAP file.
    pub fn message(self) -> (&'static str, String) {
        const AXES: [&str; 4] = ["x", "y", "z", "w"];
        match self {
            Self::Position(axis) => ("/pose", format!("pose.position.{}", AXES[axis])),
            Self::Orientation(axis) => ("/pose", format!("pose.orientation.{}", AXES[axis])),
            Self::Force(axis) => ("/wrench", format!("force.{}", AXES[axis])),
            Self::Torque(axis) => ("/wrench", format!("torque.{}", AXES[axis])),
            Self::Truth => ("/truth", "joint_state".to_owned()),
            Self::Time => ("/pose", "log time".to_owned()),
            Self::Action | Self::Demonstration | Self::Speed | Self::Settled | Self::Status => {
                ("/action", self.name().to_owned())
            }
        }
    }

    /// Its value in a frame, where it is a number that may have a fraction; time is none.
    pub fn number(self, frame: &Frame) -> Option<f64> {
        if self == Self::Truth {
            return frame.truth;
        }
        let mut frame = *frame;
        self.number_mut(&mut frame).copied()
    }

    /// The same, to be set; `None` for the truth, which need not be there.
    pub fn number_mut(self, frame: &mut Frame) -> Option<&mut f64> {
        let reading = &mut frame.reading;
        match self {
            Self::Position(axis) => Some(&mut reading.position_m[axis]),
            Self::Orientation(axis) => Some(&mut reading.orientation_xyzw[axis]),
            Self::Force(axis) => Some(&mut reading.force_n[axis]),
            Self::Torque(axis) => Some(&mut reading.torque_nm[axis]),
            Self::Speed => Some(&mut frame.speed_m_s),
            _ => None,
        }
    }
}
