//! What the controller shows of itself: the quantities of MXT and of the monitor.
//!
//! Servo lag is not emulated: feedback is what the filter gives out.

use nalgebra::{Isometry3, Vector6};
use pubs_melfa_protocol::Pose;
use pubs_melfa_protocol::arm;
use pubs_melfa_protocol::mxt::{Data, DataType};

use crate::external::External;
use crate::motion::Motion;
use crate::pulses;
use crate::scene::Scene;

/// The parts that quantities are made of.
#[derive(Debug, Clone, Copy)]
pub struct Views<'a> {
    /// Present session of external control.
    pub external: Option<&'a External>,
    /// The joints.
    pub motion: &'a Motion,
    /// What they carry.
    pub scene: &'a Scene,
}

impl Views<'_> {
    /// One of the twelve types of MXT.
    pub fn data(&self, data_type: DataType) -> Data {
        use DataType as T;
        match data_type {
            T::None => Data::None,
            T::CommandPose => Data::Pose(self.command_pose()),
            T::CommandJoint => Data::Joint(self.command_joint()),
            T::CommandPulse => Data::Pulse(self.command_pulse()),
            T::FilteredPose => Data::Pose(self.filtered_pose()),
            T::FilteredJoint => Data::Joint(self.filtered_joint()),
            T::FilteredPulse => Data::Pulse(self.filtered_pulse()),
            T::FeedbackPose => Data::Pose(self.feedback_pose()),
            T::FeedbackJoint => Data::Joint(self.feedback_joint()),
            T::FeedbackPulse => Data::Pulse(self.feedback_pulse()),
            T::CommandCurrent => Data::Current(self.command_current()),
            T::FeedbackCurrent => Data::Current(self.feedback_current()),
        }
    }

    fn pose(&self, tool: &Isometry3<f64>) -> Pose {
        let joints = self.motion.joints();
        Pose::from_isometry(tool, arm::posture(joints), arm::turns(joints))
    }

    fn command_joints(&self) -> [f64; 6] {
        let joints = self.motion.joints();
        self.external
            .and_then(|external| external.command_joints(joints, self.scene))
            .unwrap_or(*joints)
    }

    /// The newest target, where the arm is without one.
    pub fn command_pose(&self) -> Pose {
        let tool = self
            .external
            .and_then(|external| external.command_tool(self.scene));
        match tool {
            Some(tool) => self.pose(&tool),
            None => self.feedback_pose(),
        }
    }

    /// The same as joints, rad.
    pub fn command_joint(&self) -> [f32; 8] {
        eight(&self.command_joints())
    }

    /// The same as pulses.
    pub fn command_pulse(&self) -> [i32; 8] {
        pulses::of_joints(&self.command_joints())
    }

    /// The target after the filter.
    pub fn filtered_pose(&self) -> Pose {
        self.feedback_pose()
    }

    /// The same as joints, rad.
    pub fn filtered_joint(&self) -> [f32; 8] {
        self.feedback_joint()
    }

    /// The same as pulses.
    pub fn filtered_pulse(&self) -> [i32; 8] {
        self.feedback_pulse()
    }

    /// Where the tool is.
    pub fn feedback_pose(&self) -> Pose {
        self.pose(&self.scene.tool(self.motion.joints()))
    }

    /// Where the joints are, rad.
    pub fn feedback_joint(&self) -> [f32; 8] {
        eight(self.motion.joints())
    }

    /// The same as pulses.
    pub fn feedback_pulse(&self) -> [i32; 8] {
        pulses::of_joints(self.motion.joints())
    }

    /// As the feedback.
    pub fn command_current(&self) -> [i32; 8] {
        self.feedback_current()
    }

    /// What the joints hold against the object, %. Weight and inertia of the arm are left out.
    pub fn feedback_current(&self) -> [i32; 8] {
        let joints = self.motion.joints();
        let wrench = self.scene.true_wrench();
        let to_base = arm::forward(joints).rotation;
        let (force, torque) = (to_base * wrench.force, to_base * wrench.torque);
        let exerted = Vector6::from_iterator(force.iter().chain(&torque).copied());
        pulses::currents(&(arm::jacobian(joints).transpose() * exerted).into())
    }
}

fn eight(joints: &[f64; 6]) -> [f32; 8] {
    std::array::from_fn(|joint| joints.get(joint).map_or(0.0, |value| *value as f32))
}
