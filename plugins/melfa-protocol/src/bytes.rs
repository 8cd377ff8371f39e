//! Fields of a packet: little-endian, at the offsets of the protocol's table.

use crate::pose::Pose;

/// Length of every packet of MXT and of the monitor.
pub const PACKET_LEN: usize = 196;

/// Where the four slots of 40 bytes begin. The type of each stands four bytes before it.
pub(crate) const SLOTS: [usize; 4] = [8, 68, 112, 156];

/// Length of a slot.
pub(crate) const SLOT_LEN: usize = 40;

/// What is wrong with a packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PacketError {
    /// Neither shorter nor longer ones exist.
    #[error("a packet of {found} bytes, but every one has {PACKET_LEN}")]
    Length {
        /// Bytes received.
        found: usize,
    },
    /// Not 0, 1 or 255.
    #[error("command {found} is not known")]
    Command {
        /// As received.
        found: u16,
    },
    /// Not a data type of this service.
    #[error("data type {found} (at byte {at}) is not known")]
    DataType {
        /// As received.
        found: u16,
        /// Offset in the packet.
        at: usize,
    },
}

/// Refuses what is not 196 bytes long.
pub(crate) fn whole(bytes: &[u8]) -> Result<&[u8; PACKET_LEN], PacketError> {
    bytes
        .try_into()
        .map_err(|_| PacketError::Length { found: bytes.len() })
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    std::array::from_fn(|index| bytes[at + index])
}

pub(crate) fn get_u16(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(array(bytes, at))
}

pub(crate) fn get_u32(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(array(bytes, at))
}

fn get_f32(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(array(bytes, at))
}

/// `N` floats in a row.
pub(crate) fn get_floats<const N: usize>(bytes: &[u8], at: usize) -> [f32; N] {
    std::array::from_fn(|index| get_f32(bytes, at + 4 * index))
}

/// Eight integers in a row.
pub(crate) fn get_integers(bytes: &[u8], at: usize) -> [i32; 8] {
    std::array::from_fn(|index| i32::from_le_bytes(array(bytes, at + 4 * index)))
}

/// The 40 bytes of position data.
pub(crate) fn get_pose(bytes: &[u8], at: usize) -> Pose {
    Pose {
        position_mm: get_floats(bytes, at),
        angles_rad: get_floats(bytes, at + 12),
        extra: get_floats(bytes, at + 24),
        posture: get_u32(bytes, at + 32),
        turns: get_u32(bytes, at + 36),
    }
}

fn put<const N: usize>(bytes: &mut [u8], at: usize, value: [u8; N]) {
    bytes[at..at + N].copy_from_slice(&value);
}

pub(crate) fn put_u16(bytes: &mut [u8], at: usize, value: u16) {
    put(bytes, at, value.to_le_bytes());
}

pub(crate) fn put_u32(bytes: &mut [u8], at: usize, value: u32) {
    put(bytes, at, value.to_le_bytes());
}

pub(crate) fn put_floats(bytes: &mut [u8], at: usize, values: &[f32]) {
    for (index, value) in values.iter().enumerate() {
        put(bytes, at + 4 * index, value.to_le_bytes());
    }
}

pub(crate) fn put_integers(bytes: &mut [u8], at: usize, values: &[i32]) {
    for (index, value) in values.iter().enumerate() {
        put(bytes, at + 4 * index, value.to_le_bytes());
    }
}

pub(crate) fn put_pose(bytes: &mut [u8], at: usize, pose: &Pose) {
    put_floats(bytes, at, &pose.position_mm);
    put_floats(bytes, at + 12, &pose.angles_rad);
    put_floats(bytes, at + 24, &pose.extra);
    put_u32(bytes, at + 32, pose.posture);
    put_u32(bytes, at + 36, pose.turns);
}
