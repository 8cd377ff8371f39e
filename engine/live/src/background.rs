//! Threads that give way to the loops.

use std::future::Future;
use std::thread::{self, JoinHandle};

use tokio::runtime::{Builder, Runtime};
use tokio::sync::oneshot;

use crate::LiveError;

/// How much less of a busy processor a viewer gets than the loops, where these have no real-time
/// scheduling.
const NICENESS: i32 = 10;

/// A server in a thread of its own, until it is dropped.
pub(crate) struct Background {
    runtime: tokio::runtime::Handle,
    end: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Background {
    /// Starts the thread; its tasks are those of [`spawn`](Self::spawn).
    pub fn start(what: &'static str) -> Result<Self, LiveError> {
        let failed = |error: std::io::Error| LiveError::System {
            what,
            reason: error.to_string(),
        };
        let runtime = runtime().map_err(failed)?;
        let handle = runtime.handle().clone();
        let (end, ended) = oneshot::channel();
        let thread = thread::Builder::new()
            .name("live".to_owned())
            .spawn(move || {
                give_way();
                // An error: the other end is gone, and that is the end as well.
                _ = runtime.block_on(ended);
                runtime.shutdown_background();
            })
            .map_err(failed)?;
        Ok(Self {
            runtime: handle,
            end: Some(end),
            thread: Some(thread),
        })
    }

    /// Runs a task in the thread.
    pub fn spawn(&self, task: impl Future<Output = ()> + Send + 'static) {
        self.runtime.spawn(task);
    }

    /// For what has to be made within the runtime.
    pub fn enter(&self) -> tokio::runtime::EnterGuard<'_> {
        self.runtime.enter()
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        if let Some(end) = self.end.take() {
            _ = end.send(());
        }
        if let Some(thread) = self.thread.take() {
            _ = thread.join();
        }
    }
}

fn runtime() -> std::io::Result<Runtime> {
    Builder::new_current_thread().enable_all().build()
}

/// Lowers the priority of the calling thread. That it may not be so is no reason to fail.
fn give_way() {
    // On Linux the calling thread is what has a priority, and "none" names it.
    _ = rustix::process::setpriority_process(None, NICENESS);
}
