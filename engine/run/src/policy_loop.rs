//! The policy loop: chooses an action from the belief summary, and judges goals.

use std::sync::Arc;

use pubs_core::Task;
use pubs_core::input::Seen;
use pubs_core::repetition::{Place, Repetition};
use pubs_core::reward::violates_safety;
use pubs_policy::{RunError as PolicyFault, choose};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::actor::Actor;
use crate::loops::{Chooser, Verdict};
use crate::messages::{BeliefMessage, Order, Signals, Status};
use crate::recording::{Choice, ChoiceVerdict, Tape};
use crate::report::{BeliefReport, GoalReport, JudgedBy, Outcome};
use crate::run::GoalPlan;

/// After a stop the arm comes to rest for so long before the goal is judged.
const SETTLING_S: f64 = 0.3;

enum Phase {
    /// Choosing actions.
    Acting,
    /// The policy said stop at this time.
    Settling {
        since_ns: u64,
    },
    Over,
}

/// State of the loop between two ticks.
pub struct PolicyLoop {
    task: Arc<Task>,
    policies: Vec<Actor>,
    goals: Vec<GoalPlan>,
    max_steps: u32,
    signals: Signals,
    rng: Xoshiro256PlusPlus,
    phase: Phase,
    goal: usize,
    goal_began_ns: u64,
    began_ns: Option<u64>,
    steps: u32,
    actions_used: Vec<u32>,
    reports: Vec<GoalReport>,
    last: BeliefMessage,
    repetition: Repetition,
    action: usize,
    /// Steps of the loop, whatever they were for.
    ticks: u64,
    /// The true state as this step judges by it.
    truth: Option<f64>,
    tape: Option<Tape>,
}

impl PolicyLoop {
    /// A loop for goals that name their policies by index; `seed` is for policies with a random
    /// input, `tape` records every step.
    pub fn new(
        task: Arc<Task>,
        policies: Vec<Actor>,
        goals: Vec<GoalPlan>,
        max_steps: u32,
        signals: Signals,
        seed: u64,
        tape: Option<Tape>,
    ) -> Self {
        Self {
            ticks: 0,
            truth: None,
            tape,
            action: task.stop,
            actions_used: vec![0; task.actions.len()],
            task,
            policies,
            goals,
            max_steps,
            signals,
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            phase: Phase::Acting,
            goal: 0,
            goal_began_ns: 0,
            began_ns: None,
            steps: 0,
            reports: Vec::new(),
            last: BeliefMessage::default(),
            repetition: Repetition::default(),
        }
    }

    fn choose(
        &mut self,
        now_ns: u64,
        belief: &BeliefMessage,
    ) -> Result<(Order, Verdict), PolicyFault> {
        if !belief.valid {
            // The first belief has not come yet.
            return Ok((self.order(now_ns), Verdict::Going));
        }
        self.last = *belief;
        if self.began_ns.is_none() {
            self.began_ns = Some(now_ns);
            self.goal_began_ns = now_ns;
        }
        let verdict = match self.phase {
            Phase::Acting => self.act(now_ns)?,
            Phase::Settling { since_ns } => self.settle(now_ns, since_ns),
            Phase::Over => Verdict::Done,
        };
        Ok((self.order(now_ns), verdict))
    }

    fn order(&self, now_ns: u64) -> Order {
        Order {
            time_ns: now_ns,
            action: self.action,
            demonstration: 0,
            valid: true,
        }
    }

    fn act(&mut self, now_ns: u64) -> Result<Verdict, PolicyFault> {
        if self.steps >= self.max_steps {
            self.judge(now_ns, Some(Outcome::TimedOut));
            return Ok(Verdict::Done);
        }
        let plan = &self.goals[self.goal];
        let seen = Seen {
            summary: self.last.summary,
            goal: plan.state,
            readings: &self.last.readings,
            random_entropy: self.rng.random(),
        };
        let logits = self.policies[plan.policy].logits(&seen)?;
        let here = Place {
            handle: self.last.displacement,
            summary: self.last.summary,
        };
        self.repetition.end(&self.task.joint, here);
        let (shield, repetition) = (self.last.allowed, self.repetition);
        let index = choose(logits, self.task.stop, |index| {
            shield >> index & 1 == 1 && repetition.allows(index)
        });
        self.repetition.begin(index, here);
        self.steps += 1;
        self.actions_used[index] += 1;
        let action = &self.task.actions[index];
        if self
            .truth
            .is_some_and(|state| violates_safety(&self.task.joint, action, state))
        {
            self.action = self.task.stop;
            return Ok(Verdict::Violation(action.name.clone()));
        }
        self.action = index;
        if action.is_stop() {
            self.phase = Phase::Settling { since_ns: now_ns };
        }
        Ok(Verdict::Going)
    }

    fn settle(&mut self, now_ns: u64, since_ns: u64) -> Verdict {
        let resting = self.last.speed_m_s == 0.0;
        if !resting || now_ns.saturating_sub(since_ns) < (SETTLING_S * 1e9) as u64 {
            return Verdict::Going;
        }
        self.judge(now_ns, None);
        if self.goal + 1 >= self.goals.len() {
            self.phase = Phase::Over;
            return Verdict::Done;
        }
        self.goal += 1;
        self.goal_began_ns = now_ns;
        self.steps = 0;
        self.actions_used.fill(0);
        self.phase = Phase::Acting;
        Verdict::Going
    }

    /// Closes the present goal; without an outcome given, the true state decides, or where nobody
    /// knows it the belief.
    pub fn judge(&mut self, now_ns: u64, outcome: Option<Outcome>) {
        if self.reports.len() > self.goal {
            return;
        }
        let goal = self.goals[self.goal].state;
        let truth = self.signals.truth();
        let judged_state = truth.unwrap_or(self.last.summary.mean);
        let reached = self.task.reward.in_goal_region(judged_state, goal);
        let by_place = if reached {
            Outcome::Reached
        } else {
            Outcome::Missed
        };
        let names = self.task.actions.iter().map(|action| action.name.clone());
        self.reports.push(GoalReport {
            outcome: outcome.unwrap_or(by_place),
            judged_by: if truth.is_some() {
                JudgedBy::Truth
            } else {
                JudgedBy::Belief
            },
            goal,
            belief: BeliefReport {
                mean: self.last.summary.mean,
                entropy: self.last.summary.entropy,
            },
            true_state: truth,
            goal_error: truth.map(|state| (state - goal).abs()),
            time_s: now_ns.saturating_sub(self.goal_began_ns) as f64 * 1e-9,
            policy_steps: self.steps,
            actions: names.zip(self.actions_used.iter().copied()).collect(),
        });
    }

    /// The goals judged so far.
    pub fn into_reports(self) -> Vec<GoalReport> {
        self.reports
    }
}

impl Chooser for PolicyLoop {
    type Message = BeliefMessage;
    type Status = Status;

    /// One tick with the newest belief. It fails where the policy gives no action.
    fn step(&mut self, now_ns: u64, belief: &BeliefMessage) -> Result<(Order, Verdict), String> {
        self.ticks += 1;
        self.truth = self.signals.truth();
        let goal = self.goal;
        let result = self
            .choose(now_ns, belief)
            .map_err(|error| error.to_string());
        if let Some(tape) = &self.tape {
            let verdict = result.as_ref().map(|(_, verdict)| verdict.into());
            tape.choice(Choice {
                step: self.ticks,
                time_ns: now_ns,
                belief: belief.step,
                truth: self.truth,
                goal,
                action: self.action,
                verdict: verdict.unwrap_or(ChoiceVerdict::Going),
                error: result.as_ref().err().cloned(),
            });
        }
        result
    }

    fn status(&self, now_ns: u64) -> Status {
        let began_ns = self.began_ns.unwrap_or(now_ns);
        Status {
            time_s: now_ns.saturating_sub(began_ns) as f64 * 1e-9,
            goal: self.goal,
            summary: self.last.summary,
            action: self.action,
            steps: self.steps,
        }
    }
}
