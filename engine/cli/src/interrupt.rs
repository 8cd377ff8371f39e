//! Ctrl-C, heard once and passed on.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// A flag that Ctrl-C sets; whoever works looks at it and comes to an orderly end.
///
/// # Errors
/// Where the system takes no handler.
pub fn flag() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&flag);
    ctrlc::set_handler(move || handler.store(true, Ordering::Release))
        .map_err(|error| Failure::fault(&error))?;
    Ok(flag)
}
