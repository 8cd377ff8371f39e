//! The three loops as three threads in real time.
//!
//! Latest values travel through triple buffers, so that writing and reading never wait. The
//! calling thread watches: it shows the status, and calls the run off when the controller gives
//! no more sign of life (the driver then ramps to rest by itself, because its command runs out).

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use triple_buffer::{Input, Output, triple_buffer};

use crate::clock::{make_timely, now_ns, sleep_until, tick_ns};
use crate::control_loop::{ControlLoop, Tick};
use crate::guard::Trip;
use crate::lateness::{Lateness, LatenessSummary};
use crate::loops::{Chooser, Drive, Driven, Follower, Verdict};
use crate::messages::{Order, Sample, Signals};
use crate::report::LatenessReport;

/// Room for the lateness of so many seconds.
const KEPT_S: f64 = 3600.0;

/// Between two looks of the watching thread.
const WATCH: Duration = Duration::from_millis(50);

/// A loop may be silent for so long before the run goes on without it.
const GIVE_UP_NS: u64 = 1_000_000_000;

/// A reason to stop that another loop has found, for the controller.
type Alarms = mpsc::Sender<Trip>;

struct Paced<T> {
    state: T,
    lateness: LatenessSummary,
    real_time: bool,
}

/// Runs until the arm rests.
pub fn run<F, C>(drive: Drive<F, C>, watch: &mut dyn FnMut(&C::Status)) -> Driven<F, C>
where
    F: Follower,
    C: Chooser<Message = F::Message>,
{
    let Drive {
        controller,
        follower,
        chooser,
        signals,
        names,
        rates_hz,
        interrupt,
    } = drive;
    let (sample_in, sample_out) = triple_buffer(&Sample::default());
    let (message_in, message_out) = triple_buffer(&F::Message::default());
    let (order_in, order_out) = triple_buffer(&Order::default());
    let (status_in, mut status_out) = triple_buffer(&C::Status::default());
    let (alarms, heard) = mpsc::channel();
    let start_ns = now_ns();
    let pace = |rate_hz| Pace {
        start_ns,
        rate_hz,
        signals: signals.clone(),
    };

    let control = {
        let pace = pace(rates_hz[0]);
        thread::spawn(move || {
            control_thread(controller, &pace, sample_in, order_out, &heard, &interrupt)
        })
    };
    let follower = {
        let (pace, alarms) = (pace(rates_hz[1]), alarms.clone());
        thread::spawn(move || {
            follower_thread(names[0], follower, &pace, sample_out, message_in, &alarms)
        })
    };
    let chooser = {
        let pace = pace(rates_hz[2]);
        thread::spawn(move || {
            chooser_thread(
                names[1],
                chooser,
                &pace,
                message_out,
                order_in,
                status_in,
                &alarms,
            )
        })
    };
    let given_up = supervise(&control, &signals, start_ns, &mut || {
        watch(status_out.read())
    });
    signals.finish();
    let end_ns = now_ns();
    let follower = joined_in_time(follower);
    let chooser = chooser
        .join()
        .unwrap_or_else(|_| unreachable!("the thread catches panics"));
    let control = if given_up { None } else { control.join().ok() };
    let trip = match &control {
        Some(control) => control.state.clone(),
        None => Some(Trip::Silent {
            name: "controller",
            silent_s: GIVE_UP_NS as f64 * 1e-9,
        }),
    };
    let (follower, follower_lateness) = match follower {
        Some(paced) => (Some(paced.state), paced.lateness),
        None => (None, LatenessSummary::default()),
    };
    Driven {
        follower,
        chooser: chooser.state,
        trip,
        time_s: (end_ns - start_ns) as f64 * 1e-9,
        end_ns,
        lateness: LatenessReport {
            controller: control
                .as_ref()
                .map_or_else(LatenessSummary::default, |control| control.lateness),
            filter: follower_lateness,
            policy: chooser.lateness,
        },
        real_time: control.is_some_and(|control| control.real_time),
    }
}

/// What a loop leaves behind; where it hangs in a plugin, nothing, for the arm rests already and
/// the report must not wait for it.
fn joined_in_time<T>(thread: JoinHandle<Paced<T>>) -> Option<Paced<T>> {
    let deadline_ns = now_ns() + GIVE_UP_NS;
    while !thread.is_finished() && now_ns() < deadline_ns {
        thread::sleep(WATCH);
    }
    thread.is_finished().then(|| thread.join().ok()).flatten()
}

/// Watches until the controller is done; true where it hangs.
fn supervise<T>(
    control: &JoinHandle<T>,
    signals: &Signals,
    start_ns: u64,
    watch: &mut dyn FnMut(),
) -> bool {
    while !control.is_finished() {
        thread::sleep(WATCH);
        watch();
        let alive_ns = signals.controller_alive_ns().max(start_ns);
        if now_ns().saturating_sub(alive_ns) > GIVE_UP_NS && !control.is_finished() {
            return true;
        }
    }
    false
}

struct Pace {
    start_ns: u64,
    rate_hz: f64,
    signals: Signals,
}

impl Pace {
    /// Calls `step` at each tick until it says so, or, for the slower loops, the run is over.
    fn keep(
        &self,
        ends_with_run: bool,
        mut step: impl FnMut(u64) -> bool,
    ) -> (LatenessSummary, bool) {
        let real_time = make_timely();
        let mut lateness = Lateness::new(self.rate_hz, (KEPT_S * self.rate_hz) as usize);
        let mut tick = 1;
        loop {
            let due_ns = tick_ns(self.start_ns, tick, self.rate_hz);
            sleep_until(due_ns);
            let came_ns = now_ns();
            tick += 1 + lateness.record(due_ns, came_ns);
            let over = ends_with_run && (self.signals.is_finished() || self.signals.is_tripped());
            if over || !step(came_ns) {
                return (lateness.summary(), real_time);
            }
        }
    }
}

fn control_thread(
    mut controller: ControlLoop,
    pace: &Pace,
    mut samples: Input<Sample>,
    mut orders: Output<Order>,
    alarms: &mpsc::Receiver<Trip>,
    interrupt: &std::sync::atomic::AtomicBool,
) -> Paced<Option<Trip>> {
    let mut kept = (LatenessSummary::default(), false);
    let result = catch_unwind(AssertUnwindSafe(|| {
        kept = pace.keep(false, |now_ns| {
            if let Ok(trip) = alarms.try_recv() {
                controller.guard().trip(trip);
            }
            let (sample, tick) =
                controller.step(now_ns, orders.read(), interrupt.load(Ordering::Acquire));
            if let Some(sample) = sample {
                samples.write(sample);
            }
            tick == Tick::Going
        });
    }));
    if let Err(panic) = result {
        controller.guard().trip(Trip::Loop {
            name: "controller",
            message: text_of(panic.as_ref()),
        });
        controller.guard().stop();
        pace.signals.trip();
    }
    Paced {
        state: controller.guard().tripped().cloned(),
        lateness: kept.0,
        real_time: kept.1,
    }
}

fn follower_thread<F: Follower>(
    name: &'static str,
    mut follower: F,
    pace: &Pace,
    mut samples: Output<Sample>,
    mut messages: Input<F::Message>,
    alarms: &Alarms,
) -> Paced<F> {
    let lateness = caught(name, alarms, || {
        pace.keep(true, |now_ns| {
            let step = follower.step(now_ns, samples.read());
            pace.signals.follower_lives(now_ns);
            match step {
                Ok(message) => {
                    messages.write(message);
                    true
                }
                Err(message) => raise(alarms, Trip::Loop { name, message }),
            }
        })
        .0
    });
    Paced {
        state: follower,
        lateness,
        real_time: false,
    }
}

fn chooser_thread<C: Chooser>(
    name: &'static str,
    mut chooser: C,
    pace: &Pace,
    mut messages: Output<C::Message>,
    mut orders: Input<Order>,
    mut statuses: Input<C::Status>,
    alarms: &Alarms,
) -> Paced<C>
where
    C::Message: Send,
{
    let lateness = caught(name, alarms, || {
        pace.keep(true, |now_ns| {
            let step = chooser.step(now_ns, messages.read());
            statuses.write(chooser.status(now_ns));
            match step {
                Ok((order, verdict)) => {
                    orders.write(order);
                    match verdict {
                        Verdict::Going => true,
                        Verdict::Done => {
                            pace.signals.finish();
                            false
                        }
                        Verdict::Violation(action) => raise(alarms, Trip::Violation { action }),
                    }
                }
                Err(message) => raise(alarms, Trip::Loop { name, message }),
            }
        })
        .0
    });
    Paced {
        state: chooser,
        lateness,
        real_time: false,
    }
}

/// Tells the controller to stop for good; the loop that found the reason ends.
fn raise(alarms: &Alarms, trip: Trip) -> bool {
    // Nobody hears once the controller is done, and then the arm rests already.
    let _ = alarms.send(trip);
    false
}

/// A loop that panics raises an alarm instead.
fn caught(
    name: &'static str,
    alarms: &Alarms,
    body: impl FnOnce() -> LatenessSummary,
) -> LatenessSummary {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|panic| {
        raise(
            alarms,
            Trip::Loop {
                name,
                message: text_of(panic.as_ref()),
            },
        );
        LatenessSummary::default()
    })
}

fn text_of(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    format!("panic: {}", text.unwrap_or_else(|| "no message".to_owned()))
}
