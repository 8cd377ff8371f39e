//! The three loops on a virtual clock, one after the other: the same run byte for byte.

use std::sync::atomic::Ordering;

use crate::clock::{SECOND_NS, tick_ns};
use crate::control_loop::Tick;
use crate::guard::Trip;
use crate::messages::{BeliefMessage, Order, Sample, Status};
use crate::policy_loop::Verdict;
use crate::report::LatenessReport;
use crate::run::{Finished, Loops};

/// Virtual time begins here, so that no time is zero.
const START_NS: u64 = SECOND_NS;

/// Runs until the arm rests. At each moment the controller comes first, then the filter, then the
/// policy; an order takes effect at the controller's next tick, as it does between threads.
pub fn run(mut loops: Loops, watch: &mut dyn FnMut(&Status)) -> Finished {
    let [control_hz, filter_hz, policy_hz] = loops.rates_hz;
    let mut ticks = [0_u64; 3];
    let mut sample = Sample::default();
    let mut belief = BeliefMessage::default();
    let mut order = Order::default();
    let end_ns = loop {
        let now_ns = tick_ns(START_NS, ticks[0], control_hz);
        ticks[0] += 1;
        loops.controller.guard().advance_to(now_ns);
        let (newest, tick) =
            loops
                .controller
                .step(now_ns, &order, loops.interrupt.load(Ordering::Acquire));
        sample = newest.unwrap_or(sample);
        if tick == Tick::AtRest {
            break now_ns;
        }
        let due = |tick: u64, rate_hz: f64| tick_ns(START_NS, tick, rate_hz) <= now_ns;
        if due(ticks[1], filter_hz) {
            ticks[1] += 1;
            match loops.filter.step(now_ns, &sample) {
                Ok(message) => belief = message,
                Err(error) => loops.controller.guard().trip(Trip::Loop {
                    name: "filter",
                    message: error.to_string(),
                }),
            }
        }
        if due(ticks[2], policy_hz) {
            ticks[2] += 1;
            match loops.policy.step(now_ns, &belief) {
                Ok((newest, Verdict::Going)) => order = newest,
                Ok((newest, Verdict::Done)) => {
                    order = newest;
                    loops.signals.finish();
                }
                Ok((newest, Verdict::Violation(action))) => {
                    order = newest;
                    loops.controller.guard().trip(Trip::Violation { action });
                }
                Err(error) => loops.controller.guard().trip(Trip::Loop {
                    name: "policy",
                    message: error.to_string(),
                }),
            }
            watch(&loops.policy.status(now_ns));
        }
    };
    Finished {
        trip: loops.controller.guard().tripped().cloned(),
        recoveries: loops.filter.filter().recoveries(),
        notes: loops.filter.notes().to_vec(),
        time_s: (end_ns - START_NS) as f64 / SECOND_NS as f64,
        end_ns,
        policy: loops.policy,
        lateness: LatenessReport::default(),
        real_time: false,
    }
}
