//! The dashboard: a page for a browser, with a button that stops the arm.
//!
//! | path | what |
//! |---|---|
//! | `/` and the files of the page | the page; it knows nothing yet |
//! | `/scene.json` | the [`Scene`] |
//! | `/events` | server-sent events, each a JSON array of `[topic, message]`; topic `end` has the report, `missed` how many messages this viewer has not been given |
//! | `/stop` (POST) | stops the arm, as Ctrl-C does |
//!
//! The last three are for those alone whom [`Access`] admits; a token stands in the query.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use axum::extract::{Query, Request, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use pubs_run::recording::Listener;
use serde::Deserialize;
use serde_json::json;
use tokio::net::TcpListener;
use tokio::sync::broadcast::error::{RecvError, TryRecvError};
use tokio::sync::{mpsc, watch};
use tokio_stream::wrappers::ReceiverStream;

use crate::background::Background;
use crate::feed::{Feed, Line, Viewed, missed};
use crate::page::{FILES, PageFile};
use crate::{Access, LiveError, Scene};

/// Where it listens unless told otherwise.
pub const DEFAULT_PORT: u16 = 8780;

const WHAT: &str = "the dashboard";
/// Viewers at once.
const MOST_VIEWERS: usize = 16;
/// Messages of this long make one event.
const GATHER: Duration = Duration::from_millis(40);
/// Messages of one event at most.
const MOST_LINES: usize = 1000;
/// Events that may wait for a viewer's connection.
const WAITING: usize = 2;
/// At the end viewers have so long to hear it.
const FAREWELL: Duration = Duration::from_secs(2);
/// Between two looks whether somebody has come.
const LOOK: Duration = Duration::from_millis(50);

/// The page may load nothing from elsewhere, and no other page may frame it.
const POLICY: &str = "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'";

/// A server of the page, until it is dropped.
pub struct Dashboard {
    address: SocketAddr,
    access: Access,
    feed: Feed,
    /// Says that it is time to go.
    farewell: watch::Sender<bool>,
    /// Open as long as the server lives.
    served: mpsc::Receiver<()>,
    _background: Background,
}

struct Served {
    access: Access,
    scene: String,
    feed: Feed,
    stop: Arc<AtomicBool>,
}

impl Dashboard {
    /// Starts to serve. The stop button sets `stop`.
    ///
    /// # Errors
    /// Where nobody can listen at `address`.
    pub fn start(
        address: SocketAddr,
        access: Access,
        scene: &Scene,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, LiveError> {
        let system = |reason: String| LiveError::System { what: WHAT, reason };
        let background = Background::start(WHAT)?;
        let listener = listen(&background, address).map_err(|source| LiveError::Address {
            what: WHAT,
            option: "--dashboard",
            address,
            source,
        })?;
        let address = listener
            .local_addr()
            .map_err(|error| system(error.to_string()))?;
        let feed = Feed::new();
        let served = Arc::new(Served {
            access: access.clone(),
            scene: serde_json::to_string(scene).map_err(|error| system(error.to_string()))?,
            feed: feed.clone(),
            stop,
        });
        let (farewell, mut is_time) = watch::channel(false);
        let (alive, served_until) = mpsc::channel(1);
        background.spawn(async move {
            let until = async move {
                // An error: the dashboard is dropped, and that is the end as well.
                _ = is_time.wait_for(|&is_time| is_time).await;
            };
            // It serves until it is told; accepting goes on after any error.
            _ = axum::serve(listener, router(served))
                .with_graceful_shutdown(until)
                .await;
            drop(alive);
        });
        Ok(Self {
            address,
            access,
            feed,
            farewell,
            served: served_until,
            _background: background,
        })
    }

    /// What to type into a browser.
    pub fn url(&self) -> String {
        format!("http://{}/{}", self.address, self.access.query())
    }

    /// Hears the run for all viewers.
    pub fn listener(&self) -> Box<dyn Listener> {
        Box::new(self.feed.clone())
    }

    /// Whether somebody looks.
    pub fn is_watched(&self) -> bool {
        self.feed.viewers() > 0
    }

    /// Lets viewers hear the end, and closes. One that has vanished is not waited for longer than
    /// two seconds.
    pub fn finish(mut self) {
        self.farewell.send_replace(true);
        let deadline = Instant::now() + FAREWELL;
        while Instant::now() < deadline {
            match self.served.try_recv() {
                Err(mpsc::error::TryRecvError::Disconnected) => return,
                _ => thread::sleep(LOOK),
            }
        }
    }
}

fn listen(background: &Background, address: SocketAddr) -> std::io::Result<TcpListener> {
    let listener = std::net::TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    let _runtime = background.enter();
    TcpListener::from_std(listener)
}

fn router(served: Arc<Served>) -> Router {
    let mut router = Router::new()
        .route("/scene.json", get(scene))
        .route("/events", get(events))
        .route("/stop", post(stop))
        .route_layer(middleware::from_fn_with_state(Arc::clone(&served), admit));
    for file in &FILES {
        router = router.route(file.path, get(move || async { page(file) }));
    }
    router.with_state(served)
}

fn page(file: &'static PageFile) -> Response {
    let headers = [
        (header::CONTENT_TYPE, file.media_type),
        (header::CACHE_CONTROL, "no-store"),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    (headers, file.text).into_response()
}

#[derive(Deserialize)]
struct Asked {
    token: Option<String>,
}

/// Lets those alone pass who may look.
async fn admit(
    State(served): State<Arc<Served>>,
    Query(asked): Query<Asked>,
    headers: HeaderMap,
    request: Request,
    next: Next,
) -> Response {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let (host, origin) = (text(header::HOST), text(header::ORIGIN));
    if served.access.admits(host, origin, asked.token.as_deref()) {
        return next.run(request).await;
    }
    let cure = match served.access {
        Access::Token(_) => "the token is missing or wrong; the run prints the address with it",
        Access::Loopback => "another site may not look; open the address that the run prints",
    };
    (StatusCode::FORBIDDEN, Json(json!({ "error": cure }))).into_response()
}

async fn scene(State(served): State<Arc<Served>>) -> Response {
    let headers = [
        (header::CONTENT_TYPE, "application/json"),
        (header::CACHE_CONTROL, "no-store"),
    ];
    (headers, served.scene.clone()).into_response()
}

async fn stop(State(served): State<Arc<Served>>) -> Response {
    served.stop.store(true, Ordering::Release);
    Json(json!({ "stopping": true })).into_response()
}

async fn events(State(served): State<Arc<Served>>) -> Response {
    if served.feed.viewers() >= MOST_VIEWERS {
        let error = format!("{MOST_VIEWERS} viewers are there already; close one");
        return (
            StatusCode::SERVICE_UNAVAILABLE,
            Json(json!({ "error": error })),
        )
            .into_response();
    }
    let (events, stream) = mpsc::channel(WAITING);
    tokio::spawn(show(served.feed.view(), events));
    Sse::new(ReceiverStream::new(stream))
        .keep_alive(KeepAlive::default())
        .into_response()
}

/// Everything comes to an event sooner or later.
type Shown = Result<Event, std::convert::Infallible>;

/// Shows one viewer the run, to its end or until they are gone. Where their connection takes
/// nothing, this waits; the feed does not.
async fn show(viewed: Viewed, events: mpsc::Sender<Shown>) {
    let Viewed { past, mut coming } = viewed;
    for lines in past.chunks(MOST_LINES) {
        if !send(&events, lines).await {
            return;
        }
    }
    if past.last().is_some_and(is_end) {
        return;
    }
    loop {
        let mut lines = Vec::new();
        match coming.recv().await {
            Ok(line) => lines.push(line),
            Err(RecvError::Lagged(count)) => lines.push(missed(count)),
            Err(RecvError::Closed) => return,
        }
        tokio::time::sleep(GATHER).await;
        while lines.len() < MOST_LINES {
            match coming.try_recv() {
                Ok(line) => lines.push(line),
                Err(TryRecvError::Lagged(count)) => lines.push(missed(count)),
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
            }
        }
        let ends = lines.last().is_some_and(is_end);
        if !send(&events, &lines).await || ends {
            return;
        }
    }
}

fn is_end(line: &Line) -> bool {
    line.starts_with("[\"end\"")
}

/// Whether the viewer is still there.
async fn send(events: &mpsc::Sender<Shown>, lines: &[Line]) -> bool {
    let event = Event::default().data(format!("[{}]", lines.join(",")));
    events.send(Ok(event)).await.is_ok()
}
