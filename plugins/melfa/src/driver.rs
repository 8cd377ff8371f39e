//! The arm as a [`Driver`].

use std::time::Duration;

use pubs_plugin::{Driver, DriverCheck, DriverSetup, DriverStatus, PluginError, Reading, Twist};

use crate::baseline::{Baseline, BaselineLimits};
use crate::board::{Board, Order, Shared, Timed};
use crate::frames::parts;
use crate::motion::Phase;
use crate::params::{ForceSource, Params, SCHEMA, Zero, ms_ns, s_ns};
use crate::prepare::{self, prepare};
use crate::session::Session;
use crate::stats::Stats;
use crate::system::{monotonic_ns, sleep_until};
use crate::twist::Motion;
use crate::wrench::Wrench;

/// A motion thread that has not come round for so long hangs, ns.
const HUNG_NS: u64 = 200_000_000;

/// For so long after the opening the arm is only watched: the motion thread comes into step with
/// the controller, and readings have time to come, ns.
const FIRST_LOOK_NS: u64 = 300_000_000;

const LOOK: Duration = Duration::from_millis(1);

/// A MELFA arm.
///
/// `read` gives an error, with the reason, where a reading would be too old or the session has a
/// fault; so the guard stops with that reason. A session that had a fault is over: only opening
/// anew, after somebody has looked, begins another.
#[derive(Debug)]
pub struct Melfa {
    session: Option<Session>,
    board: Shared,
    params: Params,
    offset: Wrench,
}

impl Melfa {
    /// Figures of the session so far.
    pub fn stats(&self) -> Stats {
        self.board.lock().stats.clone()
    }

    /// What the motion thread is at.
    pub fn phase(&self) -> Phase {
        self.board.lock().phase
    }

    /// Ends the session as dropping does, and gives its figures.
    pub fn close(mut self) -> Stats {
        self.session = None;
        self.stats()
    }

    fn look_first(&mut self) -> Result<(), PluginError> {
        sleep_until(monotonic_ns() + FIRST_LOOK_NS);
        let until_ns = monotonic_ns() + FIRST_LOOK_NS;
        loop {
            match self.read() {
                Ok(_) => return Ok(()),
                Err(error) if monotonic_ns() >= until_ns => return Err(error),
                Err(_) => std::thread::sleep(LOOK),
            }
        }
    }

    /// Wrenches over the time of a baseline.
    fn watch_sensor(&self) -> Result<Vec<Wrench>, PluginError> {
        let until_ns = monotonic_ns() + s_ns(self.params.baseline_s);
        let (mut samples, mut last_ns) = (Vec::new(), 0);
        while monotonic_ns() < until_ns {
            let board = self.board.lock();
            check_health(&board, monotonic_ns())?;
            if let Some(wrench) = board.wrench.filter(|wrench| wrench.time_ns != last_ns) {
                last_ns = wrench.time_ns;
                samples.push(wrench.value);
            }
            drop(board);
            std::thread::sleep(LOOK);
        }
        Ok(samples)
    }

    /// The newest wrench, or zero where none is read.
    fn wrench(&self, board: &Board, now_ns: u64) -> Result<Timed<Wrench>, PluginError> {
        if self.params.force_source == ForceSource::None {
            return Ok(Timed {
                time_ns: now_ns,
                value: Wrench::default(),
            });
        }
        let Timed { time_ns, value } = young(
            board.wrench,
            now_ns,
            self.params.force_stale_ms,
            "force reading",
        )?;
        let value = value.without(&self.offset);
        Ok(Timed { time_ns, value })
    }
}

/// A value that is not too old.
fn young<T>(
    value: Option<Timed<T>>,
    now_ns: u64,
    stale_ms: f64,
    name: &str,
) -> Result<Timed<T>, PluginError> {
    let value = value.ok_or_else(|| PluginError::new(format!("no {name} has come yet")))?;
    let age_ns = now_ns.saturating_sub(value.time_ns);
    if age_ns > ms_ns(stale_ms) {
        return Err(PluginError::new(format!(
            "the newest {name} is {:.0} ms old: the link is interrupted",
            age_ns as f64 * 1e-6
        )));
    }
    Ok(value)
}

/// Whether the session can go on at all.
fn check_health(board: &Board, now_ns: u64) -> Result<(), PluginError> {
    if let Some(fault) = &board.fault {
        return Err(PluginError::new(fault.reason.clone()));
    }
    let silent_ns = now_ns.saturating_sub(board.alive_ns);
    if silent_ns > HUNG_NS && board.phase != Phase::Ended {
        return Err(PluginError::new(format!(
            "the motion thread has not come round for {:.0} ms",
            silent_ns as f64 * 1e-6
        )));
    }
    Ok(())
}

impl Driver for Melfa {
    const NAME: &'static str = "melfa";
    const VERSION: &'static str = env!("CARGO_PKG_VERSION");
    const PARAMS_SCHEMA: &'static str = SCHEMA;

    fn open(setup: &DriverSetup) -> Result<Self, PluginError> {
        let params = Params::from_driver_table(&setup.driver)?;
        let ready = prepare(&params, setup)?;
        let offset = match params.zero {
            Zero::Resting => ready.resting,
            Zero::Given => Wrench {
                force: params.force_offset_n.into(),
                torque: params.torque_offset_nm.into(),
            },
        };
        let board = Shared::default();
        let session = Session::start(ready, &params, setup, board.clone())?;
        let mut driver = Self {
            session: Some(session),
            board,
            params,
            offset,
        };
        driver.look_first()?;
        Ok(driver)
    }

    fn diagnose(setup: &DriverSetup) -> Result<Option<Vec<DriverCheck>>, PluginError> {
        let params = Params::from_driver_table(&setup.driver)?;
        Ok(Some(prepare::diagnose(&params, setup)))
    }

    fn sensor(&self) -> &str {
        &self.params.sensor
    }

    fn read(&mut self) -> Result<Reading, PluginError> {
        let board = self.board.lock();
        let now_ns = monotonic_ns();
        check_health(&board, now_ns)?;
        let pose = young(board.pose, now_ns, self.params.pose_stale_ms, "pose")?;
        let wrench = self.wrench(&board, now_ns)?;
        let following = board.order.is_some_and(|order| now_ns < order.expires_ns);
        let (position_m, orientation_xyzw) = parts(&pose.value);
        Ok(Reading {
            time_ns: pose.time_ns.min(wrench.time_ns),
            position_m,
            orientation_xyzw,
            force_n: wrench.value.force.into(),
            torque_nm: wrench.value.torque.into(),
            status: if following {
                DriverStatus::Ready
            } else {
                DriverStatus::Stopped
            },
        })
    }

    fn command(&mut self, twist: Twist, expires_ns: u64) -> Result<(), PluginError> {
        let finite = twist
            .linear_m_s
            .iter()
            .chain(&twist.angular_rad_s)
            .all(|part| part.is_finite());
        if !finite {
            return Err(PluginError::new(format!(
                "refused a twist that is not finite: {twist:?}"
            )));
        }
        let mut board = self.board.lock();
        let now_ns = monotonic_ns();
        check_health(&board, now_ns)?;
        if let Some(hold) = board.hold(now_ns) {
            return Err(hold.into());
        }
        if board.phase == Phase::Lost {
            return Err("the link to MXT is lost; it is tried again".into());
        }
        board.order = Some(Order {
            velocity: Motion::from(&twist),
            expires_ns,
        });
        Ok(())
    }

    fn tare(&mut self) -> Result<(), PluginError> {
        if self.params.force_source == ForceSource::None {
            return Ok(());
        }
        if !matches!(self.phase(), Phase::Watching | Phase::Holding) {
            return Err("tare needs an arm at rest, but it moves".into());
        }
        let samples = self.watch_sensor()?;
        let limits = BaselineLimits::new(&self.params);
        let baseline = Baseline::of(&samples, self.params.baseline_s)
            .and_then(|baseline| baseline.check(&limits).map(|()| baseline))
            .map_err(|fault| PluginError::new(format!("tare: {fault}")))?;
        if self.params.zero == Zero::Resting {
            self.offset = baseline.mean;
        }
        Ok(())
    }

    fn stop(&mut self) -> Result<(), PluginError> {
        self.board.lock().order = None;
        Ok(())
    }
}
