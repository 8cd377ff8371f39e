//! What the observation model expects along the motion, at the state that is believed.

use pubs_core::belief::{Model, ModelError};
use pubs_plugin::{Support, Transitions};

use super::story::Story;

/// A band is so many sigma to each side.
const SIGMAS: f64 = 2.0;

/// Mean and sigma of f_d at each step of the filter, where the model speaks.
pub(super) struct Expected(Vec<(f64, Option<[f64; 2]>)>);

impl Expected {
    /// `None` where the model has no f_d or gives no moments.
    pub fn of(story: &Story<'_>, model: &dyn Model) -> Result<Option<Self>, ModelError> {
        let channels = model.channels();
        let Some(along) = channels.iter().position(|channel| channel.name == "f_d") else {
            return Ok(None);
        };
        let (mut mean, mut sigma) = (vec![0.0; channels.len()], vec![0.0; channels.len()]);
        let mut series = Vec::new();
        for step in &story.recording.beliefs {
            let time_s = story.time_s(step.time_ns);
            let Some(action) = action_at(story, step.tick).filter(|_| step.message.valid) else {
                series.push((time_s, None));
                continue;
            };
            let state = [step.message.summary.mean as f32];
            let transitions = Transitions {
                action,
                before: &state,
                after: &state,
            };
            if model.moments(transitions, &mut mean, &mut sigma)? == Support::Absent {
                return Ok(None);
            }
            let found = [mean[along], sigma[along]].map(f64::from);
            let finite = found.iter().all(|value| value.is_finite());
            series.push((time_s, finite.then_some(found)));
        }
        Ok(Some(Self(series)))
    }

    pub fn mean(&self) -> Vec<(f64, Option<f64>)> {
        let series = self.0.iter();
        series
            .map(|(time_s, found)| (*time_s, found.map(|[mean, _]| mean)))
            .collect()
    }

    pub fn band(&self) -> Vec<(f64, Option<[f64; 2]>)> {
        let band = |[mean, sigma]: [f64; 2]| [mean - SIGMAS * sigma, mean + SIGMAS * sigma];
        let series = self.0.iter();
        series
            .map(|(time_s, found)| (*time_s, found.map(band)))
            .collect()
    }
}

/// The movement that was in force at a tick, where the arm moved as it asks.
fn action_at(story: &Story<'_>, tick: u64) -> Option<usize> {
    let ticks = &story.recording.ticks;
    let at = ticks.binary_search_by_key(&tick, |tick| tick.tick).ok()?;
    let (frame, _) = ticks[at].felt.as_ref()?;
    let action = story.task.actions.get(frame.action)?;
    (frame.settled && !action.is_stop()).then_some(frame.action)
}
