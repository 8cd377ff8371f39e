//! The supervision link: R3 over TCP.

mod client;
mod session;

pub use client::{R3Client, R3Error};
pub use session::{explained, upload_lines};
