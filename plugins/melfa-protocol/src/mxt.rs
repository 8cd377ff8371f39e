//! MXT, real-time external control: UDP, one request and one reply per control cycle, 196 bytes.
//!
//! Targets are absolute. The first request of a session has command [`Command::Null`]; its reply
//! says where the arm is, and only then may [`Command::Move`] follow. [`Command::End`] ends.

use crate::bytes::{
    self, PACKET_LEN, PacketError, SLOTS, get_integers, get_pose, get_u16, get_u32, put_floats,
    put_integers, put_pose, put_u16, put_u32,
};
use crate::pose::Pose;

const COMMAND: usize = 0;
const SEND_TYPE: usize = 2;
const SEND_IO: usize = 48;
const RECEIVE_IO: usize = 50;
const IO_FIRST_BIT: usize = 52;
const IO_MASK: usize = 54;
const IO_DATA: usize = 56;
const TIMEOUT_COUNT: usize = 58;
const COUNT: usize = 60;

/// What a request asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Command {
    /// Nothing: handshake, or monitoring alone.
    #[default]
    Null = 0,
    /// To move to the target in the packet.
    Move = 1,
    /// To end external control.
    End = 255,
}

impl Command {
    fn from_number(found: u16) -> Result<Self, PacketError> {
        match found {
            0 => Ok(Self::Null),
            1 => Ok(Self::Move),
            255 => Ok(Self::End),
            _ => Err(PacketError::Command { found }),
        }
    }
}

/// What is in a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DataType {
    /// Nothing.
    #[default]
    None = 0,
    /// Command value, position data.
    CommandPose = 1,
    /// Command value, joints.
    CommandJoint = 2,
    /// Command value, encoder pulses.
    CommandPulse = 3,
    /// Command value after the filter, position data.
    FilteredPose = 4,
    /// Command value after the filter, joints.
    FilteredJoint = 5,
    /// Command value after the filter, encoder pulses.
    FilteredPulse = 6,
    /// Encoder feedback, position data.
    FeedbackPose = 7,
    /// Encoder feedback, joints.
    FeedbackJoint = 8,
    /// Encoder feedback, pulses.
    FeedbackPulse = 9,
    /// Commanded motor current, %.
    CommandCurrent = 10,
    /// Measured motor current, %.
    FeedbackCurrent = 11,
}

impl DataType {
    /// All of them; the index is the number in the packet.
    pub const ALL: [Self; 12] = [
        Self::None,
        Self::CommandPose,
        Self::CommandJoint,
        Self::CommandPulse,
        Self::FilteredPose,
        Self::FilteredJoint,
        Self::FilteredPulse,
        Self::FeedbackPose,
        Self::FeedbackJoint,
        Self::FeedbackPulse,
        Self::CommandCurrent,
        Self::FeedbackCurrent,
    ];

    fn at(bytes: &[u8], at: usize) -> Result<Self, PacketError> {
        let found = get_u16(bytes, at);
        let known = Self::ALL.get(usize::from(found)).copied();
        known.ok_or(PacketError::DataType { found, at })
    }
}

/// The content of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Data {
    /// Nothing.
    #[default]
    None,
    /// Position data, types 1, 4, 7.
    Pose(Pose),
    /// Joints J1..J8 in rad (mm for linear ones), types 2, 5, 8.
    Joint([f32; 8]),
    /// Encoder pulses of J1..J8, types 3, 6, 9.
    Pulse([i32; 8]),
    /// Motor current of J1..J8 in %, types 10, 11.
    Current([i32; 8]),
}

impl Data {
    fn get(bytes: &[u8], slot: usize, data_type: DataType) -> Self {
        use DataType as T;
        match data_type {
            T::None => Self::None,
            T::CommandPose | T::FilteredPose | T::FeedbackPose => Self::Pose(get_pose(bytes, slot)),
            T::CommandJoint | T::FilteredJoint | T::FeedbackJoint => {
                Self::Joint(bytes::get_floats(bytes, slot))
            }
            T::CommandPulse | T::FilteredPulse | T::FeedbackPulse => {
                Self::Pulse(get_integers(bytes, slot))
            }
            T::CommandCurrent | T::FeedbackCurrent => Self::Current(get_integers(bytes, slot)),
        }
    }

    fn put(&self, bytes: &mut [u8], slot: usize) {
        match self {
            Self::None => {}
            Self::Pose(pose) => put_pose(bytes, slot, pose),
            Self::Joint(values) => put_floats(bytes, slot, values),
            Self::Pulse(values) | Self::Current(values) => put_integers(bytes, slot, values),
        }
    }
}

/// The signals of a packet: one of the controller's words of 16 bits, read or written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Io {
    /// What the data is: 0 none, 1 output, 2 input.
    pub send: u16,
    /// What is wanted back: 0 none, 1 output, 2 input. Not used in replies.
    pub receive: u16,
    /// Number of the first signal.
    pub first_bit: u16,
    /// Which outputs are written. Means nothing in replies.
    pub mask: u16,
    /// The signals.
    pub data: u16,
}

impl Io {
    fn get(bytes: &[u8]) -> Self {
        Self {
            send: get_u16(bytes, SEND_IO),
            receive: get_u16(bytes, RECEIVE_IO),
            first_bit: get_u16(bytes, IO_FIRST_BIT),
            mask: get_u16(bytes, IO_MASK),
            data: get_u16(bytes, IO_DATA),
        }
    }

    fn put(&self, bytes: &mut [u8]) {
        put_u16(bytes, SEND_IO, self.send);
        put_u16(bytes, RECEIVE_IO, self.receive);
        put_u16(bytes, IO_FIRST_BIT, self.first_bit);
        put_u16(bytes, IO_MASK, self.mask);
        put_u16(bytes, IO_DATA, self.data);
    }
}

/// From the client to the controller.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Request {
    /// What to do.
    pub command: Command,
    /// Type of the target: a command value (1 to 3), or none in the first packet.
    pub send: DataType,
    /// The target.
    pub data: Data,
    /// What the four slots of the reply shall tell.
    pub receive: [DataType; 4],
    /// Signals.
    pub io: Io,
    /// A running number; the controller does not use it.
    pub count: u32,
}

impl Request {
    /// As bytes.
    pub fn encode(&self) -> [u8; PACKET_LEN] {
        let mut bytes = [0; PACKET_LEN];
        put_u16(&mut bytes, COMMAND, self.command as u16);
        put_u16(&mut bytes, SEND_TYPE, self.send as u16);
        for (slot, wanted) in SLOTS.iter().zip(&self.receive) {
            put_u16(&mut bytes, slot - 4, *wanted as u16);
        }
        self.data.put(&mut bytes, SLOTS[0]);
        self.io.put(&mut bytes);
        put_u32(&mut bytes, COUNT, self.count);
        bytes
    }

    /// From bytes.
    pub fn decode(bytes: &[u8]) -> Result<Self, PacketError> {
        let bytes = bytes::whole(bytes)?;
        let send = DataType::at(bytes, SEND_TYPE)?;
        let mut receive = [DataType::None; 4];
        for (wanted, slot) in receive.iter_mut().zip(SLOTS) {
            *wanted = DataType::at(bytes, slot - 4)?;
        }
        Ok(Self {
            command: Command::from_number(get_u16(bytes, COMMAND))?,
            send,
            data: Data::get(bytes, SLOTS[0], send),
            receive,
            io: Io::get(bytes),
            count: get_u32(bytes, COUNT),
        })
    }
}

/// From the controller to the client.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reply {
    /// What the controller puts here is not documented; an echo of the request's command, as far
    /// as is known. Nothing should depend on it.
    pub command: u16,
    /// What was asked for.
    pub data: [(DataType, Data); 4],
    /// Signals.
    pub io: Io,
    /// Cycles without a request since MXT started, where the controller watches for them.
    pub timeout_count: u16,
    /// Requests since MXT started.
    pub count: u32,
}

impl Reply {
    /// As bytes.
    pub fn encode(&self) -> [u8; PACKET_LEN] {
        let mut bytes = [0; PACKET_LEN];
        put_u16(&mut bytes, COMMAND, self.command);
        put_u16(&mut bytes, SEND_TYPE, self.data[0].0 as u16);
        for (slot, (data_type, data)) in SLOTS.iter().zip(&self.data) {
            put_u16(&mut bytes, slot - 4, *data_type as u16);
            data.put(&mut bytes, *slot);
        }
        self.io.put(&mut bytes);
        put_u16(&mut bytes, TIMEOUT_COUNT, self.timeout_count);
        put_u32(&mut bytes, COUNT, self.count);
        bytes
    }

    /// From bytes. The type of the first slot stands twice in a reply; where only one of the two
    /// fields is filled, it counts.
    pub fn decode(bytes: &[u8]) -> Result<Self, PacketError> {
        let bytes = bytes::whole(bytes)?;
        let mut data = [(DataType::None, Data::None); 4];
        for (entry, slot) in data.iter_mut().zip(SLOTS) {
            let mut data_type = DataType::at(bytes, slot - 4)?;
            if slot == SLOTS[0] && data_type == DataType::None {
                data_type = DataType::at(bytes, SEND_TYPE)?;
            }
            *entry = (data_type, Data::get(bytes, slot, data_type));
        }
        Ok(Self {
            command: get_u16(bytes, COMMAND),
            data,
            io: Io::get(bytes),
            timeout_count: get_u16(bytes, TIMEOUT_COUNT),
            count: get_u32(bytes, COUNT),
        })
    }

    /// The content of the first slot of this type.
    pub fn get(&self, data_type: DataType) -> Option<&Data> {
        let slot = self.data.iter().find(|(found, _)| *found == data_type);
        slot.map(|(_, data)| data)
    }
}
