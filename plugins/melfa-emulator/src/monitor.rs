//! The real-time monitor: who listens, and to what.

use std::collections::BTreeMap;
use std::net::SocketAddr;

use pubs_melfa_protocol::monitor::{Reply, Request, Value};

use crate::controller::Controller;

#[derive(Debug, Clone, Copy)]
struct Subscription {
    types: [u16; 4],
    first_input: u16,
    first_output: u16,
    count: u32,
}

/// Everyone who sent a start packet and no end packet since, each to their own address.
#[derive(Debug, Clone, Default)]
pub struct Monitor {
    subscriptions: BTreeMap<SocketAddr, Subscription>,
}

impl Monitor {
    /// Takes a packet; what is none of this service's is passed over.
    pub fn hear(&mut self, bytes: &[u8], from: SocketAddr) {
        match Request::decode(bytes) {
            Ok(Request::Start {
                types,
                first_input,
                first_output,
            }) => {
                let subscription = Subscription {
                    types,
                    first_input,
                    first_output,
                    count: 0,
                };
                self.subscriptions.insert(from, subscription);
            }
            Ok(Request::End) => self.end(from),
            Err(_) => {}
        }
    }

    /// Ends the stream to this address; sent from another port, all streams to the same host.
    fn end(&mut self, from: SocketAddr) {
        if self.subscriptions.remove(&from).is_none() {
            self.subscriptions
                .retain(|address, _| address.ip() != from.ip());
        }
    }

    /// How many listen.
    pub fn listeners(&self) -> usize {
        self.subscriptions.len()
    }

    /// Where they listen.
    pub fn addresses(&self) -> impl Iterator<Item = &SocketAddr> {
        self.subscriptions.keys()
    }

    /// The packets of a cycle.
    pub fn packets(&mut self, controller: &Controller) -> Vec<(SocketAddr, Vec<u8>)> {
        let subscriptions = self.subscriptions.iter_mut();
        let packets = subscriptions.map(|(address, subscription)| {
            subscription.count = subscription.count.wrapping_add(1);
            let slots = subscription.types.map(|id| (id, value(controller, id)));
            let reply = Reply {
                slots,
                inputs: controller.inputs.double_word(subscription.first_input),
                outputs: controller.outputs.double_word(subscription.first_output),
                count: subscription.count,
            };
            (*address, reply.encode().to_vec())
        });
        packets.collect()
    }
}

/// The content of a data type; zeros for those that are not emulated.
fn value(controller: &Controller, id: u16) -> Value {
    if id == controller.sensor_id() {
        let wrench = controller.scene.shown();
        let single = |values: nalgebra::Vector3<f64>| values.map(|value| value as f32).into();
        return Value::Force {
            force_n: single(wrench.force),
            torque_nm: single(wrench.torque),
        };
    }
    let views = controller.views();
    match id {
        1001 => Value::Pose(views.command_pose()),
        1002 => Value::Joint(views.command_joint()),
        1003 => Value::Integers(views.command_pulse()),
        1004 => Value::Pose(views.filtered_pose()),
        1005 => Value::Joint(views.filtered_joint()),
        1006 => Value::Integers(views.filtered_pulse()),
        1007 => Value::Pose(views.feedback_pose()),
        1008 => Value::Joint(views.feedback_joint()),
        1009 => Value::Integers(views.feedback_pulse()),
        1010 => Value::Integers(views.command_current()),
        1011 => Value::Integers(views.feedback_current()),
        pubs_melfa_protocol::monitor::ROBOT_INFORMATION => robot_information(controller),
        _ => Value::None,
    }
}

/// Speed of the tool by feedback and by command, mm/s; the other fields are zero.
fn robot_information(controller: &Controller) -> Value {
    let speed = (controller.measure.speed_m_s * 1000.0) as f32;
    let mut content = [0; 40];
    content[..4].copy_from_slice(&speed.to_le_bytes());
    content[8..12].copy_from_slice(&speed.to_le_bytes());
    Value::Other(content)
}
