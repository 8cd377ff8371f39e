//! An observation model behind its table.

use std::ffi::{c_char, c_void};
use std::fmt;
use std::sync::Arc;

use pubs_plugin::table::ObservationModelTable;
use pubs_plugin::{Channel, GridTransitions, Support, Transitions};

use crate::call::{Failure, call};
use crate::{HostError, Plugin, sweep};

/// The model of one object. Its functions may be called from several threads at once; it ends when
/// dropped, and keeps its plugin until then.
pub struct ModelInstance {
    pub(crate) plugin: Arc<Plugin>,
    pub(crate) table: &'static ObservationModelTable,
    pub(crate) handle: *mut c_void,
    pub(crate) channels: Vec<Channel>,
    pub(crate) actions: Vec<String>,
    pub(crate) gaussian: bool,
}

// SAFETY: the contract of the ABI: after `create`, an instance's functions may be called from any
// thread, and from several at once; `destroy` is called once, by the last owner.
unsafe impl Send for ModelInstance {}
// SAFETY: as above.
unsafe impl Sync for ModelInstance {}

impl fmt::Debug for ModelInstance {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.plugin.name();
        formatter
            .debug_struct("ModelInstance")
            .field("plugin", &name)
            .field("channels", &self.channels)
            .finish()
    }
}

impl ModelInstance {
    /// The components of an observation, in the order of every `[C]` axis.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Whether [`moments`](Self::moments) answers; decided once, at creation. Otherwise
    /// [`log_likelihood`](Self::log_likelihood) and [`sample`](Self::sample) do.
    pub fn is_gaussian(&self) -> bool {
        self.gaussian
    }

    /// The plugin it is from.
    pub fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    /// Mean and sigma of each channel, both `[C][N]` (N, or a probability and nothing).
    ///
    /// # Errors
    /// Where array lengths do not match, the action does not exist, or the plugin fails.
    #[inline]
    pub fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, HostError> {
        let Transitions {
            action,
            before,
            after,
        } = transitions;
        let count = after.len();
        let cells = self.channels.len() * count;
        if before.len() != count
            || mean.len() != cells
            || sigma.len() != cells
            || action >= self.actions.len()
        {
            let arrays = [
                ("before", before.len()),
                ("mean", mean.len()),
                ("sigma", sigma.len()),
            ];
            return Err(self.mismatch("moments", action, count, &arrays));
        }
        let Some(moments) = self.table.moments else {
            return Ok(Support::Absent);
        };
        call(|error, capacity| {
            let (mean, sigma) = (mean.as_mut_ptr(), sigma.as_mut_ptr());
            // SAFETY: the handle is alive and the lengths were checked.
            unsafe {
                moments(
                    self.handle,
                    action,
                    before.as_ptr(),
                    after.as_ptr(),
                    count,
                    mean,
                    sigma,
                    error,
                    capacity,
                )
            }
        })
        .map_err(|failure| self.failed("moments", action, count, failure))
    }

    /// The same on a regular grid; [`Support::Absent`] where the plugin does not provide it.
    ///
    /// # Errors
    /// As [`moments`](Self::moments).
    #[inline]
    pub fn moments_grid(
        &self,
        grid: GridTransitions,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, HostError> {
        let GridTransitions {
            action,
            before,
            after,
            spacing,
            count,
        } = grid;
        let cells = self.channels.len() * count;
        if mean.len() != cells || sigma.len() != cells || action >= self.actions.len() {
            let arrays = [("mean", mean.len()), ("sigma", sigma.len())];
            return Err(self.mismatch("moments_grid", action, count, &arrays));
        }
        let Some(moments_grid) = self.table.moments_grid else {
            return Ok(Support::Absent);
        };
        call(|error, capacity| {
            let (mean, sigma) = (mean.as_mut_ptr(), sigma.as_mut_ptr());
            // SAFETY: the handle is alive and the lengths were checked.
            unsafe {
                moments_grid(
                    self.handle,
                    action,
                    before,
                    after,
                    spacing,
                    count,
                    mean,
                    sigma,
                    error,
                    capacity,
                )
            }
        })
        .map_err(|failure| self.failed("moments_grid", action, count, failure))
    }

    /// ln Z of one observation `[C]` under each hypothesis, into `[N]`; untempered.
    ///
    /// # Errors
    /// As [`moments`](Self::moments).
    #[inline]
    pub fn log_likelihood(
        &self,
        transitions: Transitions<'_>,
        observation: &[f32],
        log_likelihood: &mut [f32],
    ) -> Result<Support, HostError> {
        let Transitions {
            action,
            before,
            after,
        } = transitions;
        let count = after.len();
        let given = observation.len();
        if before.len() != count
            || given != self.channels.len()
            || log_likelihood.len() != count
            || action >= self.actions.len()
        {
            let arrays = [
                ("before", before.len()),
                ("observation", given),
                ("log_likelihood", log_likelihood.len()),
            ];
            return Err(self.mismatch("log_likelihood", action, count, &arrays));
        }
        let Some(function) = self.table.log_likelihood else {
            return Ok(Support::Absent);
        };
        call(|error, capacity| {
            let (observation, target) = (observation.as_ptr(), log_likelihood.as_mut_ptr());
            let (before, after) = (before.as_ptr(), after.as_ptr());
            // SAFETY: the handle is alive and the lengths were checked.
            unsafe {
                function(
                    self.handle,
                    action,
                    before,
                    after,
                    count,
                    observation,
                    target,
                    error,
                    capacity,
                )
            }
        })
        .map_err(|failure| self.failed("log_likelihood", action, count, failure))
    }

    /// Draws one observation per hypothesis, `[C][N]`, from standard normals `[C][N]`.
    ///
    /// # Errors
    /// As [`moments`](Self::moments).
    #[inline]
    pub fn sample(
        &self,
        transitions: Transitions<'_>,
        normals: &[f32],
        observations: &mut [f32],
    ) -> Result<Support, HostError> {
        let Transitions {
            action,
            before,
            after,
        } = transitions;
        let count = after.len();
        let cells = self.channels.len() * count;
        if before.len() != count
            || normals.len() != cells
            || observations.len() != cells
            || action >= self.actions.len()
        {
            let arrays = [
                ("before", before.len()),
                ("normals", normals.len()),
                ("observations", observations.len()),
            ];
            return Err(self.mismatch("sample", action, count, &arrays));
        }
        let Some(sample) = self.table.sample else {
            return Ok(Support::Absent);
        };
        call(|error, capacity| {
            let (normals, target) = (normals.as_ptr(), observations.as_mut_ptr());
            let (before, after) = (before.as_ptr(), after.as_ptr());
            // SAFETY: the handle is alive and the lengths were checked.
            unsafe {
                sample(
                    self.handle,
                    action,
                    before,
                    after,
                    count,
                    normals,
                    target,
                    error,
                    capacity,
                )
            }
        })
        .map_err(|failure| self.failed("sample", action, count, failure))
    }

    /// Checks moments that this model gave: means finite, sigmas positive, probabilities within
    /// [0, 1]. For after something has gone wrong; too slow for every update. `states` are those
    /// after the move, for the account alone.
    ///
    /// # Errors
    /// Names the first value that is not so, its channel and state.
    pub fn check_finite(
        &self,
        action: usize,
        states: &[f32],
        mean: &[f32],
        sigma: &[f32],
    ) -> Result<(), HostError> {
        match sweep::bad_moment(&self.channels, states, mean, sigma) {
            None => Ok(()),
            Some(text) => Err(self.failed("moments", action, states.len(), Failure::Value(text))),
        }
    }

    /// `moments` past the checks of action and lengths: for the conformance kit.
    pub(crate) fn moments_unchecked(
        &self,
        action: usize,
        before: &[f32],
        after: &[f32],
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, Failure> {
        let Some(moments) = self.table.moments else {
            return Ok(Support::Absent);
        };
        let count = after.len().min(before.len());
        call(|error, capacity| {
            let (mean, sigma) = (mean.as_mut_ptr(), sigma.as_mut_ptr());
            // SAFETY: the handle is alive; the caller's outputs have room for every channel.
            unsafe {
                moments(
                    self.handle,
                    action,
                    before.as_ptr(),
                    after.as_ptr(),
                    count,
                    mean,
                    sigma,
                    error,
                    capacity,
                )
            }
        })
    }

    /// An error of this instance's function.
    #[cold]
    pub(crate) fn failed(
        &self,
        function: &'static str,
        action: usize,
        count: usize,
        failure: Failure,
    ) -> HostError {
        let name = self
            .actions
            .get(action)
            .map_or("there is none", String::as_str);
        let states = if count == 1 { "state" } else { "states" };
        let context = format!("{count} {states} of action {action} (`{name}`)");
        HostError::Call {
            plugin: self.plugin.name().to_owned(),
            function,
            context,
            failure,
        }
    }

    #[cold]
    fn mismatch(
        &self,
        function: &'static str,
        action: usize,
        count: usize,
        arrays: &[(&str, usize)],
    ) -> HostError {
        let lengths: Vec<String> = arrays
            .iter()
            .map(|(name, length)| format!("`{name}` has {length}"))
            .collect();
        let (channels, actions) = (self.channels.len(), self.actions.len());
        let text = format!(
            "the engine's arrays do not match {channels} channels × {count} states of one of {actions} actions: {}",
            lengths.join(", ")
        );
        self.failed(function, action, count, Failure::Value(text))
    }
}

impl Drop for ModelInstance {
    fn drop(&mut self) {
        if let Some(destroy) = self.table.destroy {
            // SAFETY: the last use of the handle. A failure has nobody left to be told.
            let _ = call(|error: *mut c_char, capacity| unsafe {
                destroy(self.handle, error, capacity)
            });
        }
    }
}
