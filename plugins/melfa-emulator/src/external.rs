//! External control: what an `Mxt` line does with packets until it ends.

use std::net::IpAddr;

use nalgebra::Isometry3;
use pubs_melfa_protocol::arm::{self, ReachError, Singularity};
use pubs_melfa_protocol::mxt::{Command, Data, Request};

use crate::alarm::{self, Alarm};
use crate::filter::LowPass;
use crate::options::Posture;
use crate::program::TargetKind;
use crate::pulses;
use crate::scene::Scene;

/// Where the client wants the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// The tool in the base, and the posture that its flags name.
    Pose {
        /// m.
        tool: Isometry3<f64>,
        /// First word of flags.
        posture: u32,
    },
    /// Joints, rad.
    Joints([f64; 6]),
}

/// What a packet leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Heard {
    /// A reply.
    Reply,
    /// The end of external control.
    End,
    /// An alarm.
    Alarm(Alarm),
}

/// A session of external control.
#[derive(Debug, Clone)]
pub struct External {
    kind: TargetKind,
    /// Packets from other addresses are none.
    pub peer: IpAddr,
    filter: LowPass,
    posture: Posture,
    /// A packet with command 0 has come.
    pub handshaken: bool,
    /// The newest target; held until the next.
    pub target: Option<Target>,
    filtered_tool: Isometry3<f64>,
    /// Packets since the `Mxt` line began.
    pub count: u32,
    /// Cycles without one, counted from the first packet on where MXTTOUT is not -1.
    pub timeout_count: u16,
    silent_cycles: u32,
    heard_this_cycle: bool,
}

impl External {
    /// A session that begins with the tool here.
    pub fn new(
        kind: TargetKind,
        peer: IpAddr,
        filter: LowPass,
        posture: Posture,
        tool: Isometry3<f64>,
    ) -> Self {
        Self {
            kind,
            peer,
            filter,
            posture,
            handshaken: false,
            target: None,
            filtered_tool: tool,
            count: 0,
            timeout_count: 0,
            silent_cycles: 0,
            heard_this_cycle: false,
        }
    }

    /// Takes a packet of the peer's.
    pub fn hear(&mut self, request: &Request, servo_on: bool, joints: &[f64; 6]) -> Heard {
        self.count = self.count.wrapping_add(1);
        self.heard_this_cycle = true;
        match request.command {
            Command::End => Heard::End,
            Command::Null => {
                self.handshaken = true;
                Heard::Reply
            }
            Command::Move => match self.accept(request, servo_on, joints) {
                Ok(target) => {
                    self.target = Some(target);
                    Heard::Reply
                }
                Err(alarm) => Heard::Alarm(alarm),
            },
        }
    }

    fn accept(
        &self,
        request: &Request,
        servo_on: bool,
        joints: &[f64; 6],
    ) -> Result<Target, Alarm> {
        if !self.handshaken {
            return Err(Alarm::new(alarm::NO_HANDSHAKE));
        }
        if request.send != self.kind.data_type() {
            let particulars = format!(
                "{:?} in the packet, {:?} in the Mxt line",
                request.send,
                self.kind.data_type()
            );
            return Err(Alarm::new(alarm::WRONG_TYPE).with(&particulars));
        }
        if !servo_on {
            return Err(Alarm::new(alarm::SERVO_OFF));
        }
        let target = match &request.data {
            Data::Pose(pose) if pose.is_finite() => Target::Pose {
                tool: pose.isometry(),
                posture: pose.posture,
            },
            Data::Joint(values) if values[..6].iter().all(|value| value.is_finite()) => {
                Target::Joints(std::array::from_fn(|joint| f64::from(values[joint])))
            }
            Data::Pulse(values) => Target::Joints(pulses::to_joints(values)),
            _ => return Err(Alarm::new(alarm::NOT_FINITE)),
        };
        self.check_posture(&target, joints)?;
        Ok(target)
    }

    fn check_posture(&self, target: &Target, joints: &[f64; 6]) -> Result<(), Alarm> {
        let Target::Pose { posture, .. } = target else {
            return Ok(());
        };
        let present = arm::posture(joints);
        if self.posture == Posture::Ignore || *posture == present {
            return Ok(());
        }
        let particulars = format!("flags {posture}, the arm has {present}");
        Err(Alarm::new(alarm::OTHER_POSTURE).with(&particulars))
    }

    /// Counts a cycle.
    ///
    /// # Errors
    ///
    /// Where `mxtout` (cycles, -1 for none) is exceeded.
    pub fn count_cycle(&mut self, mxtout: i32) -> Result<(), Alarm> {
        if std::mem::take(&mut self.heard_this_cycle) {
            self.silent_cycles = 0;
            return Ok(());
        }
        let Ok(most) = u32::try_from(mxtout) else {
            return Ok(());
        };
        if self.count == 0 {
            return Ok(());
        }
        self.timeout_count = self.timeout_count.wrapping_add(1);
        self.silent_cycles += 1;
        match self.silent_cycles > most {
            true => Err(Alarm::new(alarm::TIMEOUT)),
            false => Ok(()),
        }
    }

    /// Where the joints go this cycle; `None` without a target.
    ///
    /// # Errors
    ///
    /// Where the target cannot be reached.
    pub fn next(&mut self, joints: &[f64; 6], scene: &Scene) -> Result<Option<[f64; 6]>, Alarm> {
        let next = match self.target {
            None => return Ok(None),
            Some(Target::Joints(wanted)) => self.filter.joints(joints, &wanted),
            Some(Target::Pose { tool, .. }) => {
                self.filtered_tool = self.filter.pose(&self.filtered_tool, &tool);
                arm::inverse(&scene.flange(&self.filtered_tool), joints).map_err(unreachable)?
            }
        };
        match arm::out_of_range(&next) {
            None => Ok(Some(next)),
            Some(joint) => {
                let particulars = format!("J{}", joint + 1);
                Err(Alarm::new(alarm::JOINT_RANGE).with(&particulars))
            }
        }
    }

    /// The target as the tool's pose.
    pub fn command_tool(&self, scene: &Scene) -> Option<Isometry3<f64>> {
        self.target.map(|target| match target {
            Target::Pose { tool, .. } => tool,
            Target::Joints(joints) => scene.tool(&joints),
        })
    }

    /// The target as joints; the nearest solution where it is a pose, if there is one.
    pub fn command_joints(&self, joints: &[f64; 6], scene: &Scene) -> Option<[f64; 6]> {
        match self.target? {
            Target::Joints(joints) => Some(joints),
            Target::Pose { tool, .. } => arm::inverse(&scene.flange(&tool), joints).ok(),
        }
    }
}

fn unreachable(error: ReachError) -> Alarm {
    let number = match error {
        // Stretched to its limit is as far as it reaches.
        ReachError::OutOfReach { .. } | ReachError::Singular(Singularity::Elbow) => {
            alarm::OUT_OF_REACH
        }
        ReachError::OutOfRange { .. } => alarm::JOINT_RANGE,
        ReachError::Singular(_) => alarm::SINGULAR,
        ReachError::Posture(_) => alarm::OTHER_POSTURE,
    };
    Alarm::new(number).with(&error.to_string())
}
