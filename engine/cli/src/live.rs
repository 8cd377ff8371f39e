//! Live views of a run, as the command line asks for them.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use clap::Args;
use pubs_live::{
    Access, Dashboard, Foxglove, Listen, LiveError, Scene, Token, dashboard, foxglove,
};
use pubs_run::recording::Listener;

use crate::failure::Failure;
use crate::object::Ready;
use crate::{exit, show};

/// Between two looks whether a viewer has come.
const LOOK: Duration = Duration::from_millis(50);

/// Who may watch, and where.
#[derive(Args)]
pub struct LiveOptions {
    /// Serve a page that shows the run, with a stop button
    /// [default address: 127.0.0.1:8780; any other than this machine's own asks for a token]
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = "127.0.0.1")]
    dashboard: Option<Listen>,
    /// Serve the Foxglove app [default address: 127.0.0.1:8765]
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = "127.0.0.1")]
    foxglove: Option<Listen>,
    /// Ask viewers for this token [default: on other addresses than this machine's own, a new one]
    #[arg(long, value_name = "TOKEN", env = "PUBS_TOKEN", hide_env_values = true)]
    token: Option<Token>,
    /// Let the arm begin only once somebody watches
    #[arg(long)]
    wait_for_viewer: bool,
}

/// The views that are served.
pub struct Views {
    dashboard: Option<Dashboard>,
    foxglove: Option<Foxglove>,
}

/// Starts what was asked for and says where it is. The stop button sets `interrupt`.
///
/// # Errors
/// Where an address is taken or is none of this machine's, or nobody came before the user gave up.
pub fn start(
    options: &LiveOptions,
    ready: &Ready,
    goals: &[f64],
    interrupt: &Arc<AtomicBool>,
) -> Result<Views, Failure> {
    let views = serve(options, ready, goals, interrupt).map_err(|error| match error {
        LiveError::Address { .. } => Failure::invalid(error.to_string()),
        error => Failure::fault(&error),
    })?;
    if options.wait_for_viewer {
        if views.are_none() {
            return Err(Failure::invalid(
                "--wait-for-viewer waits for somebody at --dashboard or --foxglove; give one of them",
            ));
        }
        show::say("waiting for a viewer; Ctrl-C gives up");
        while !views.are_watched() {
            if interrupt.load(Ordering::Acquire) {
                return Err(Failure::Other {
                    code: exit::SAFETY_STOP,
                    message: "interrupted before anybody watched; nothing has moved".to_owned(),
                });
            }
            thread::sleep(LOOK);
        }
    }
    Ok(views)
}

fn serve(
    options: &LiveOptions,
    ready: &Ready,
    goals: &[f64],
    interrupt: &Arc<AtomicBool>,
) -> Result<Views, LiveError> {
    let access = |address: SocketAddr| Access::of(address, options.token.as_ref());
    let mut views = Views {
        dashboard: None,
        foxglove: None,
    };
    if let Some(listen) = options.dashboard {
        let address = listen.address(dashboard::DEFAULT_PORT);
        let scene = Scene::of(&ready.task, ready.model.as_ref(), goals)?;
        let stop = Arc::clone(interrupt);
        let page = Dashboard::start(address, access(address), &scene, stop)?;
        announce("dashboard", &page.url(), address);
        views.dashboard = Some(page);
    }
    if let Some(listen) = options.foxglove {
        let address = listen.address(foxglove::DEFAULT_PORT);
        let server = Foxglove::start(address, access(address))?;
        announce("foxglove", &server.url(), address);
        views.foxglove = Some(server);
    }
    Ok(views)
}

fn announce(what: &str, url: &str, address: SocketAddr) {
    let hint = match address.ip().is_unspecified() {
        true => "  (from elsewhere: with this machine's name in place of the zeros)",
        false => "",
    };
    show::say(&format!("{what}: {url}{hint}"));
}

impl Views {
    /// Those who listen to the recording.
    pub fn listeners(&self) -> Vec<Box<dyn Listener>> {
        let dashboard = self.dashboard.iter().map(Dashboard::listener);
        let foxglove = self.foxglove.iter().map(Foxglove::listener);
        dashboard.chain(foxglove).collect()
    }

    /// Lets viewers hear the end.
    pub fn finish(self) {
        if let Some(dashboard) = self.dashboard {
            dashboard.finish();
        }
    }

    fn are_none(&self) -> bool {
        self.dashboard.is_none() && self.foxglove.is_none()
    }

    fn are_watched(&self) -> bool {
        self.dashboard.as_ref().is_some_and(Dashboard::is_watched)
            || self.foxglove.as_ref().is_some_and(Foxglove::is_watched)
    }
}
