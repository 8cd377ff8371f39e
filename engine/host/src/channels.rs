//! What an observation model says its observations consist of.

use std::ffi::c_void;

use pubs_plugin::table::{
    CHANNEL_BERNOULLI, CHANNEL_GAUSSIAN, CHANNEL_NAME_BYTES, ChannelEntry, ObservationModelTable,
};
use pubs_plugin::{Channel, ChannelKind};

use crate::call::{Failure, demand, filled_text};

/// More channels than any observation has.
const MOST_CHANNELS: usize = 64;

/// The components of an instance's observations, checked.
pub(crate) fn ask(
    table: &ObservationModelTable,
    handle: *mut c_void,
) -> Result<Vec<Channel>, Failure> {
    let function = table.channels.ok_or(Failure::Absent)?;
    let mut entries = [ChannelEntry {
        name: [0; CHANNEL_NAME_BYTES],
        kind: u32::MAX,
    }; MOST_CHANNELS];
    let mut count = 0;
    // SAFETY: the handle is alive and the array has MOST_CHANNELS entries.
    demand(|error, capacity| unsafe {
        function(
            handle,
            entries.as_mut_ptr(),
            MOST_CHANNELS,
            &mut count,
            error,
            capacity,
        )
    })?;
    if count == 0 || count > MOST_CHANNELS {
        return Err(Failure::Value(format!(
            "a model has 1 to {MOST_CHANNELS} channels, this one {count}"
        )));
    }
    let channels: Vec<Channel> = entries[..count]
        .iter()
        .map(channel)
        .collect::<Result<_, _>>()?;
    for (index, channel) in channels.iter().enumerate() {
        if channels[..index]
            .iter()
            .any(|other| other.name == channel.name)
        {
            return Err(Failure::Value(format!(
                "two channels are named `{}`",
                channel.name
            )));
        }
    }
    Ok(channels)
}

fn channel(entry: &ChannelEntry) -> Result<Channel, Failure> {
    let bytes = entry.name.map(|character| character as u8);
    let name = filled_text(&bytes).map_err(Failure::Value)?;
    if name.is_empty() {
        return Err(Failure::Value("a channel has no name".to_owned()));
    }
    let kind = match entry.kind {
        CHANNEL_GAUSSIAN => ChannelKind::Gaussian,
        CHANNEL_BERNOULLI => ChannelKind::Bernoulli,
        other => {
            let text = format!(
                "channel `{name}` is of kind {other}, which is neither 0 (Gaussian) nor 1 (Bernoulli)"
            );
            return Err(Failure::Value(text));
        }
    };
    Ok(Channel { name, kind })
}
