//! Packets of MXT: taking them, and answering.

use std::net::SocketAddr;

use pubs_melfa_protocol::mxt::{Io, Reply, Request};

use super::Controller;
use crate::external::Heard;

/// A packet that gets a reply at the end of the cycle.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Who asked.
    pub by: SocketAddr,
    request: Request,
    count: u32,
}

impl Controller {
    /// Takes a packet of MXT. `None`: it gets no reply. What has not 196 bytes, is none of the
    /// protocol's, comes from elsewhere or while no program is at an `Mxt` line, is passed over.
    pub fn hear(&mut self, bytes: &[u8], from: SocketAddr) -> Option<Asked> {
        let servo_on = self.servo_is_on();
        let external = self.external.as_mut()?;
        if external.peer != from.ip() {
            return None;
        }
        let request = Request::decode(bytes).ok()?;
        match external.hear(&request, servo_on, self.motion.joints()) {
            Heard::Reply => {
                let count = external.count;
                self.write_outputs(&request.io);
                Some(Asked {
                    by: from,
                    request,
                    count,
                })
            }
            Heard::End => {
                self.end_external();
                None
            }
            Heard::Alarm(alarm) => {
                self.raise(alarm);
                None
            }
        }
    }

    fn write_outputs(&mut self, io: &Io) {
        if io.send == 1 {
            self.set_outputs(io.first_bit, io.mask, io.data);
        }
    }

    /// What a packet asked for, as it is after the cycle; `None` where external control has ended.
    pub fn reply(&self, asked: &Asked) -> Option<Reply> {
        let external = self.external.as_ref()?;
        let views = self.views();
        let io = &asked.request.io;
        Some(Reply {
            command: asked.request.command as u16,
            data: asked
                .request
                .receive
                .map(|data_type| (data_type, views.data(data_type))),
            io: Io {
                send: io.receive,
                first_bit: io.first_bit,
                data: match io.receive {
                    1 => self.outputs.word(io.first_bit),
                    2 => self.inputs.word(io.first_bit),
                    _ => 0,
                },
                ..Io::default()
            },
            timeout_count: external.timeout_count,
            count: asked.count,
        })
    }
}
