//! Error numbers whose meaning is known from reports; no list of the controller's was at hand.

/// Treated as "busy, ask again" by clients.
pub const BUSY: u32 = 5640;

/// L6130: reported when a program with an `Open "ENET:…"` line was started.
pub const NETWORK_ERROR: u32 = 6130;

/// H0117: reported where J4 to J6 were commanded to oscillate finely about zero.
pub const OSCILLATING_COMMAND: u32 = 117;

/// What is known of an error number. A controller's own text (`ERRORMES`) says more.
pub fn known_error(number: u32) -> Option<&'static str> {
    match number {
        BUSY => Some("the controller is busy"),
        NETWORK_ERROR => Some("network communication error"),
        OSCILLATING_COMMAND => Some("reported where joint targets oscillated finely about zero"),
        _ => None,
    }
}
