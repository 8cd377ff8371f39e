//! The three loops on a virtual clock, one after the other: the same run byte for byte.

use std::sync::atomic::Ordering;

use crate::clock::{SECOND_NS, tick_ns};
use crate::control_loop::Tick;
use crate::guard::Trip;
use crate::loops::{Chooser, Drive, Driven, Follower, Verdict};
use crate::messages::{Order, Sample};
use crate::report::LatenessReport;

/// Virtual time begins here, so that no time is zero.
const START_NS: u64 = SECOND_NS;

/// Runs until the arm rests. At each moment the controller comes first, then the follower, then the
/// chooser; an order takes effect at the controller's next tick, as it does between threads.
pub fn run<F, C>(mut loops: Drive<F, C>, watch: &mut dyn FnMut(&C::Status)) -> Driven<F, C>
where
    F: Follower,
    C: Chooser<Message = F::Message>,
{
    let [control_hz, follower_hz, chooser_hz] = loops.rates_hz;
    let mut ticks = [0_u64; 3];
    let mut sample = Sample::default();
    let mut message = F::Message::default();
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
        if due(ticks[1], follower_hz) {
            ticks[1] += 1;
            match loops.follower.step(now_ns, &sample) {
                Ok(newest) => message = newest,
                Err(message) => loops.fail(loops.names[0], message),
            }
            loops.signals.follower_lives(now_ns);
        }
        if due(ticks[2], chooser_hz) {
            ticks[2] += 1;
            match loops.chooser.step(now_ns, &message) {
                Ok((newest, verdict)) => {
                    order = newest;
                    loops.follow(verdict);
                }
                Err(message) => loops.fail(loops.names[1], message),
            }
            watch(&loops.chooser.status(now_ns));
        }
    };
    Driven {
        trip: loops.controller.guard().tripped().cloned(),
        follower: Some(loops.follower),
        chooser: loops.chooser,
        time_s: (end_ns - START_NS) as f64 / SECOND_NS as f64,
        end_ns,
        lateness: LatenessReport::default(),
        real_time: false,
    }
}

impl<F, C> Drive<F, C> {
    fn fail(&mut self, name: &'static str, message: String) {
        self.controller.guard().trip(Trip::Loop { name, message });
    }

    fn follow(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Going => {}
            Verdict::Done => self.signals.finish(),
            Verdict::Violation(action) => self.controller.guard().trip(Trip::Violation { action }),
        }
    }
}
