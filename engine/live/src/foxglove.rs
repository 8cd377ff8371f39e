//! A server for the Foxglove app: the topics of the recording, live.
//!
//! The server is that of Foxglove's own library, which asks for no token; where one is needed it
//! listens on loopback behind a `gate`. It takes nothing from the app: only the
//! dashboard has a stop button. On loopback without a token any page that a browser of this machine
//! has open may look, since the app itself is such a page; where that matters, give a token. A viewer that is too slow misses the oldest messages.

use std::collections::HashMap;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::{Arc, Mutex, PoisonError};

use foxglove::websocket::{ChannelView, Client, ServerListener};
use foxglove::{
    ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema, WebSocketServer,
    WebSocketServerHandle,
};
use pubs_run::RunReport;
use pubs_run::recording::{Listener, Message, TopicNote, run_topics};
use tokio::sync::oneshot;

use crate::background::Background;
use crate::{Access, LiveError, gate};

/// Where it listens unless told otherwise: where the app looks first.
pub const DEFAULT_PORT: u16 = 8765;

const WHAT: &str = "the Foxglove app";
const OPTION: &str = "--foxglove";
/// Comes once, before most viewers are there.
const LIMITS: &str = "/limits";

/// A server for the app, until it is dropped.
pub struct Foxglove {
    address: SocketAddr,
    access: Access,
    channels: Channels,
    server: WebSocketServerHandle,
    /// The server forgets its channels with it.
    _context: Arc<Context>,
    _background: Background,
}

/// One per topic.
#[derive(Clone)]
struct Channels {
    by_topic: Arc<HashMap<&'static str, Arc<RawChannel>>>,
    limits: Arc<Mutex<Option<Kept>>>,
}

/// A message for those who come later.
struct Kept {
    time_ns: u64,
    json: Vec<u8>,
}

impl Foxglove {
    /// Starts to serve.
    ///
    /// # Errors
    /// Where nobody can listen at `address`.
    pub fn start(address: SocketAddr, access: Access) -> Result<Self, LiveError> {
        let background = Background::start(WHAT)?;
        let context = Context::new();
        let channels = Channels::of(&context, run_topics()).map_err(system)?;
        let inner = match access {
            Access::Loopback => address,
            Access::Token(_) => (Ipv4Addr::LOCALHOST, 0).into(),
        };
        let server = started(&background, &context, inner, channels.clone())?;
        let served: SocketAddr = (inner.ip(), server.port()).into();
        let address = match &access {
            Access::Loopback => served,
            Access::Token(token) => gate::open(&background, address, served, token.clone())
                .map_err(|source| LiveError::Address {
                    what: WHAT,
                    option: OPTION,
                    address,
                    source,
                })?,
        };
        Ok(Self {
            address,
            access,
            channels,
            server,
            _context: context,
            _background: background,
        })
    }

    /// What to type into the app, under "Open connection".
    pub fn url(&self) -> String {
        format!("ws://{}/{}", self.address, self.access.query())
    }

    /// Hears the run for all viewers.
    pub fn listener(&self) -> Box<dyn Listener> {
        Box::new(self.channels.clone())
    }

    /// Whether somebody looks.
    pub fn is_watched(&self) -> bool {
        self.server.client_count() > 0
    }
}

/// Starts the server in the background.
fn started(
    background: &Background,
    context: &Arc<Context>,
    address: SocketAddr,
    channels: Channels,
) -> Result<WebSocketServerHandle, LiveError> {
    let host = match address {
        SocketAddr::V4(address) => address.ip().to_string(),
        SocketAddr::V6(address) => format!("[{}]", address.ip()),
    };
    let server = WebSocketServer::new()
        .context(context)
        .name("pubs-engine")
        .bind(host, address.port())
        .listener(Arc::new(channels));
    let (tell, told) = oneshot::channel();
    background.spawn(async move {
        // An error: nobody waits for it any more.
        _ = tell.send(server.start().await);
    });
    match told.blocking_recv() {
        Ok(Ok(server)) => Ok(server),
        Ok(Err(FoxgloveError::Bind(source))) => Err(LiveError::Address {
            what: WHAT,
            option: OPTION,
            address,
            source,
        }),
        Ok(Err(error)) => Err(system(error)),
        Err(_) => Err(LiveError::System {
            what: WHAT,
            reason: "its thread has ended".to_owned(),
        }),
    }
}

fn system(error: FoxgloveError) -> LiveError {
    LiveError::System {
        what: WHAT,
        reason: error.to_string(),
    }
}

impl Channels {
    fn of(context: &Arc<Context>, topics: Vec<TopicNote>) -> Result<Self, FoxgloveError> {
        let mut by_topic = HashMap::new();
        for topic in topics {
            let schema = topic.schema.to_string().into_bytes();
            let channel = ChannelBuilder::new(topic.name)
                .context(context)
                .message_encoding("json")
                .schema(Schema::new(topic.schema_name, "jsonschema", schema))
                .build_raw()?;
            by_topic.insert(topic.name, channel);
        }
        Ok(Self {
            by_topic: Arc::new(by_topic),
            limits: Arc::default(),
        })
    }
}

impl Listener for Channels {
    fn hear(&mut self, message: &Message<'_>) {
        if message.topic == LIMITS {
            let kept = Kept {
                time_ns: message.time_ns,
                json: message.json.to_vec(),
            };
            *self.limits.lock().unwrap_or_else(PoisonError::into_inner) = Some(kept);
        }
        if let Some(channel) = self.by_topic.get(message.topic) {
            channel.log_with_meta(
                message.json,
                PartialMetadata::with_log_time(message.time_ns),
            );
        }
    }

    fn end(&mut self, _report: &RunReport) {}
}

impl ServerListener for Channels {
    /// Who comes late is told the limits as well.
    fn on_subscribe(&self, client: Client, channel: ChannelView) {
        if channel.topic() != LIMITS {
            return;
        }
        let limits = self.limits.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some(kept), Some(channel)) = (limits.as_ref(), self.by_topic.get(LIMITS)) {
            let time = PartialMetadata::with_log_time(kept.time_ns);
            channel.log_with_meta_to_sink(&kept.json, time, client.sink_id());
        }
    }
}
