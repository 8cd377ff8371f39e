//! The table of an observation model written in Rust.

use std::ffi::{c_char, c_void};
use std::marker::PhantomData;

use crate::boundary::{
    ErrorBuffer, guarded, hand_out, input, output, parse_setup, place, take_back,
};
use crate::table::{
    ABI, CHANNEL_BERNOULLI, CHANNEL_GAUSSIAN, CHANNEL_NAME_BYTES, ChannelEntry,
    KIND_OBSERVATION_MODEL, ObservationModelTable, PluginTable, Text,
};
use crate::{
    Channel, ChannelKind, GridTransitions, ModelSetup, ObservationModel, PluginError, Support,
    Transitions,
};

/// The table of model `M`: what a built-in plugin's `table()` returns and what
/// [`export_observation_model!`](crate::export_observation_model) exports.
pub const fn observation_model_table<M: ObservationModel>() -> &'static PluginTable {
    ModelTable::<M>::PLUGIN
}

struct ModelTable<M>(PhantomData<M>);

impl<M: ObservationModel> ModelTable<M> {
    const FUNCTIONS: &'static ObservationModelTable = &ObservationModelTable {
        size: size_of::<ObservationModelTable>() as u32,
        reserved: 0,
        create: Some(create::<M>),
        destroy: Some(destroy::<M>),
        channels: Some(channels::<M>),
        moments: Some(moments::<M>),
        moments_grid: Some(moments_grid::<M>),
        log_likelihood: Some(log_likelihood::<M>),
        sample: Some(sample::<M>),
    };
    const PLUGIN: &'static PluginTable = &PluginTable {
        size: size_of::<PluginTable>() as u32,
        abi: ABI,
        kind: KIND_OBSERVATION_MODEL,
        reserved: 0,
        name: Text::new(M::NAME),
        version: Text::new(M::VERSION),
        params_schema: Text::new(M::PARAMS_SCHEMA),
        observation_model: Self::FUNCTIONS,
        driver: std::ptr::null(),
    };
}

/// A model with the two sizes that its arguments are checked against.
struct Instance<M> {
    model: M,
    actions: usize,
    channels: usize,
}

impl<M> Instance<M> {
    fn check_action(&self, action: usize) -> Result<(), PluginError> {
        if action < self.actions {
            return Ok(());
        }
        Err(PluginError::new(format!(
            "there is no action {action}, only 0 to {}",
            self.actions - 1
        )))
    }

    fn cells(&self, count: usize) -> Result<usize, PluginError> {
        self.channels.checked_mul(count).ok_or_else(|| {
            PluginError::new(format!(
                "{} channels × {count} states is too much",
                self.channels
            ))
        })
    }
}

/// # Safety
/// `instance` is null or came from `create::<M>` and is not destroyed yet.
unsafe fn borrow<'a, M>(instance: *mut c_void) -> Result<&'a Instance<M>, PluginError> {
    // SAFETY: promised by the caller.
    unsafe { instance.cast::<Instance<M>>().as_ref() }
        .ok_or_else(|| PluginError::new("`instance` is null"))
}

fn build<M: ObservationModel>(setup: &ModelSetup) -> Result<Instance<M>, PluginError> {
    if setup.actions.is_empty() {
        return Err(PluginError::new("the setup has no actions"));
    }
    let model = M::create(setup)?;
    let channels = model.channels();
    if channels.is_empty() {
        return Err(PluginError::new("the model has no channels"));
    }
    if let Some(long) = channels
        .iter()
        .find(|channel| channel.name.len() >= CHANNEL_NAME_BYTES)
    {
        let most = CHANNEL_NAME_BYTES - 1;
        return Err(PluginError::new(format!(
            "channel name `{}` is longer than {most} bytes",
            long.name
        )));
    }
    let channels = channels.len();
    Ok(Instance {
        model,
        actions: setup.actions.len(),
        channels,
    })
}

fn entry(channel: &Channel) -> ChannelEntry {
    let mut name = [0; CHANNEL_NAME_BYTES];
    for (target, byte) in name.iter_mut().zip(channel.name.bytes()) {
        *target = byte as c_char;
    }
    let kind = match channel.kind {
        ChannelKind::Gaussian => CHANNEL_GAUSSIAN,
        ChannelKind::Bernoulli => CHANNEL_BERNOULLI,
    };
    ChannelEntry { name, kind }
}

unsafe extern "C" fn create<M: ObservationModel>(
    setup: *const u8,
    setup_length: usize,
    instance: *mut *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let setup = parse_setup::<ModelSetup>(setup, setup_length)?;
                hand_out(build::<M>(&setup)?, instance)
            },
        )
    }
}

unsafe extern "C" fn destroy<M: ObservationModel>(
    instance: *mut c_void,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || take_back::<Instance<M>>(instance),
        )
    }
}

unsafe extern "C" fn channels<M: ObservationModel>(
    instance: *mut c_void,
    channels: *mut ChannelEntry,
    capacity: usize,
    count: *mut usize,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let own = borrow::<M>(instance)?.model.channels();
                *place(count, "count")? = own.len();
                let targets = output(channels, capacity, "channels")?;
                for (target, channel) in targets.iter_mut().zip(own) {
                    *target = entry(channel);
                }
                Ok(Support::Given)
            },
        )
    }
}

unsafe extern "C" fn moments<M: ObservationModel>(
    instance: *mut c_void,
    action: usize,
    before: *const f32,
    after: *const f32,
    count: usize,
    mean: *mut f32,
    sigma: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let own = borrow::<M>(instance)?;
                own.check_action(action)?;
                let cells = own.cells(count)?;
                let transitions = Transitions {
                    action,
                    before: input(before, count, "before")?,
                    after: input(after, count, "after")?,
                };
                own.model.moments(
                    transitions,
                    output(mean, cells, "mean")?,
                    output(sigma, cells, "sigma")?,
                )
            },
        )
    }
}

unsafe extern "C" fn moments_grid<M: ObservationModel>(
    instance: *mut c_void,
    action: usize,
    before: f32,
    after: f32,
    spacing: f32,
    count: usize,
    mean: *mut f32,
    sigma: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let own = borrow::<M>(instance)?;
                own.check_action(action)?;
                let cells = own.cells(count)?;
                let grid = GridTransitions {
                    action,
                    before,
                    after,
                    spacing,
                    count,
                };
                own.model.moments_grid(
                    grid,
                    output(mean, cells, "mean")?,
                    output(sigma, cells, "sigma")?,
                )
            },
        )
    }
}

unsafe extern "C" fn log_likelihood<M: ObservationModel>(
    instance: *mut c_void,
    action: usize,
    before: *const f32,
    after: *const f32,
    count: usize,
    observation: *const f32,
    log_likelihood: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let own = borrow::<M>(instance)?;
                own.check_action(action)?;
                let transitions = Transitions {
                    action,
                    before: input(before, count, "before")?,
                    after: input(after, count, "after")?,
                };
                let observation = input(observation, own.channels, "observation")?;
                let target = output(log_likelihood, count, "log_likelihood")?;
                own.model.log_likelihood(transitions, observation, target)
            },
        )
    }
}

unsafe extern "C" fn sample<M: ObservationModel>(
    instance: *mut c_void,
    action: usize,
    before: *const f32,
    after: *const f32,
    count: usize,
    normals: *const f32,
    observations: *mut f32,
    error: *mut c_char,
    error_capacity: usize,
) -> i32 {
    // SAFETY: pubs_plugin.h asks these things of the caller.
    unsafe {
        guarded(
            ErrorBuffer {
                text: error,
                capacity: error_capacity,
            },
            || {
                let own = borrow::<M>(instance)?;
                own.check_action(action)?;
                let cells = own.cells(count)?;
                let transitions = Transitions {
                    action,
                    before: input(before, count, "before")?,
                    after: input(after, count, "after")?,
                };
                let normals = input(normals, cells, "normals")?;
                own.model.sample(
                    transitions,
                    normals,
                    output(observations, cells, "observations")?,
                )
            },
        )
    }
}
