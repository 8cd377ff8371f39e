//! What a MELFA controller and its clients say to each other, and the RV-5AS-D's kinematics.
//!
//! Three services, each with a module: [`mxt`] moves the arm (UDP, one packet per control cycle
//! each way), [`monitor`] streams force and feedback (UDP), [`r3`] supervises (TCP, text).
//! [`pose`] turns their position data to metres and quaternions and back; [`arm`] knows the
//! RV-5AS-D. Nothing here opens a socket or starts a thread.
//!
//! Units differ between the services: lengths are millimetres in all of them, angles are radians
//! in the packets and degrees in the text of R3.

pub mod arm;
mod bytes;
pub mod monitor;
pub mod mxt;
pub mod pose;
pub mod r3;

pub use bytes::{PACKET_LEN, PacketError};
pub use pose::Pose;
