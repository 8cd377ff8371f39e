//! The real-time monitor: a UDP service beside MXT that streams force and feedback.
//!
//! A start packet with up to four data type ids subscribes its sender: from then on a packet
//! comes every control cycle, until an end packet. Ids are known from captured traffic, not from
//! the manual, so the id of the force sensor is a parameter everywhere.

use crate::bytes::{
    self, PACKET_LEN, PacketError, SLOT_LEN, SLOTS, get_floats, get_integers, get_pose, get_u16,
    get_u32, put_floats, put_integers, put_pose, put_u16, put_u32,
};
use crate::pose::Pose;

const COMMAND: usize = 0;
const FIRST_INPUT: usize = 48;
const FIRST_OUTPUT: usize = 50;
const INPUTS: usize = 52;
const OUTPUTS: usize = 56;
const COUNT: usize = 60;

const START: u16 = 1;
const END: u16 = 255;

/// The force sensor's id, as captured.
pub const FORCE: u16 = 101;
/// Robot information: speeds and distances of the tool.
pub const ROBOT_INFORMATION: u16 = 12;
/// Command value, position data.
pub const COMMAND_POSE: u16 = 1001;
/// Command value, joints.
pub const COMMAND_JOINT: u16 = 1002;
/// Encoder feedback, position data.
pub const FEEDBACK_POSE: u16 = 1007;
/// Encoder feedback, joints.
pub const FEEDBACK_JOINT: u16 = 1008;
/// Measured motor current.
pub const FEEDBACK_CURRENT: u16 = 1011;

/// From the client to the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Request {
    /// Stream to the sender of this packet.
    Start {
        /// Ids of the four slots; 0 for none.
        types: [u16; 4],
        /// Number of the first of 32 input signals.
        first_input: u16,
        /// Number of the first of 32 output signals.
        first_output: u16,
    },
    /// Stream no more.
    End,
}

impl Request {
    /// Subscribes to `types`, signals from number 0 on.
    pub fn start(types: [u16; 4]) -> Self {
        Self::Start {
            types,
            first_input: 0,
            first_output: 0,
        }
    }

    /// As bytes.
    pub fn encode(&self) -> [u8; PACKET_LEN] {
        let mut bytes = [0; PACKET_LEN];
        match self {
            Self::End => put_u16(&mut bytes, COMMAND, END),
            Self::Start {
                types,
                first_input,
                first_output,
            } => {
                put_u16(&mut bytes, COMMAND, START);
                put_types(&mut bytes, types);
                put_u16(&mut bytes, FIRST_INPUT, *first_input);
                put_u16(&mut bytes, FIRST_OUTPUT, *first_output);
            }
        }
        bytes
    }

    /// From bytes.
    pub fn decode(bytes: &[u8]) -> Result<Self, PacketError> {
        let bytes = bytes::whole(bytes)?;
        match get_u16(bytes, COMMAND) {
            START => Ok(Self::Start {
                types: types_of(bytes),
                first_input: get_u16(bytes, FIRST_INPUT),
                first_output: get_u16(bytes, FIRST_OUTPUT),
            }),
            END => Ok(Self::End),
            found => Err(PacketError::Command { found }),
        }
    }
}

/// The content of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Value {
    /// Nothing: id 0.
    #[default]
    None,
    /// Force sensor data, plain units.
    Force {
        /// F1 to F3, N.
        force_n: [f32; 3],
        /// F4 to F6, N m.
        torque_nm: [f32; 3],
    },
    /// Position data.
    Pose(Pose),
    /// J1 to J8 in rad.
    Joint([f32; 8]),
    /// Pulses or %, J1 to J8.
    Integers([i32; 8]),
    /// The bytes of a type that is not decoded here.
    Other([u8; SLOT_LEN]),
}

impl Value {
    fn get(bytes: &[u8], slot: usize, id: u16, force_id: u16) -> Self {
        match id {
            0 => Self::None,
            _ if id == force_id => Self::Force {
                force_n: get_floats(bytes, slot),
                torque_nm: get_floats(bytes, slot + 12),
            },
            1001 | 1004 | 1007 => Self::Pose(get_pose(bytes, slot)),
            1002 | 1005 | 1008 => Self::Joint(get_floats(bytes, slot)),
            1003 | 1006 | 1009..=1014 => Self::Integers(get_integers(bytes, slot)),
            _ => Self::Other(std::array::from_fn(|index| bytes[slot + index])),
        }
    }

    fn put(&self, bytes: &mut [u8], slot: usize) {
        match self {
            Self::None => {}
            Self::Force { force_n, torque_nm } => {
                put_floats(bytes, slot, force_n);
                put_floats(bytes, slot + 12, torque_nm);
            }
            Self::Pose(pose) => put_pose(bytes, slot, pose),
            Self::Joint(values) => put_floats(bytes, slot, values),
            Self::Integers(values) => put_integers(bytes, slot, values),
            Self::Other(content) => bytes[slot..slot + SLOT_LEN].copy_from_slice(content),
        }
    }
}

/// From the controller to the client, once a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reply {
    /// Id and content of each slot.
    pub slots: [(u16, Value); 4],
    /// 32 input signals from the number asked for.
    pub inputs: u32,
    /// 32 output signals from the number asked for.
    pub outputs: u32,
    /// Counts the packets.
    pub count: u32,
}

impl Reply {
    /// As bytes. Its command, which is not documented, is that of the start packet.
    pub fn encode(&self) -> [u8; PACKET_LEN] {
        let mut bytes = [0; PACKET_LEN];
        put_u16(&mut bytes, COMMAND, START);
        put_types(&mut bytes, &self.slots.map(|(id, _)| id));
        for (slot, (_, value)) in SLOTS.iter().zip(&self.slots) {
            value.put(&mut bytes, *slot);
        }
        put_u32(&mut bytes, INPUTS, self.inputs);
        put_u32(&mut bytes, OUTPUTS, self.outputs);
        put_u32(&mut bytes, COUNT, self.count);
        bytes
    }

    /// From bytes; slots of `force_id` are force sensor data.
    pub fn decode(bytes: &[u8], force_id: u16) -> Result<Self, PacketError> {
        let bytes = bytes::whole(bytes)?;
        let mut slots = [(0, Value::None); 4];
        for ((entry, id), slot) in slots.iter_mut().zip(types_of(bytes)).zip(SLOTS) {
            *entry = (id, Value::get(bytes, slot, id, force_id));
        }
        Ok(Self {
            slots,
            inputs: get_u32(bytes, INPUTS),
            outputs: get_u32(bytes, OUTPUTS),
            count: get_u32(bytes, COUNT),
        })
    }

    /// The content of the first slot with this id.
    pub fn get(&self, id: u16) -> Option<&Value> {
        let slot = self.slots.iter().find(|(found, _)| *found == id);
        slot.map(|(_, value)| value)
    }
}

fn types_of(bytes: &[u8]) -> [u16; 4] {
    SLOTS.map(|slot| get_u16(bytes, slot - 4))
}

fn put_types(bytes: &mut [u8], types: &[u16; 4]) {
    for (slot, id) in SLOTS.iter().zip(types) {
        put_u16(bytes, slot - 4, *id);
    }
}
