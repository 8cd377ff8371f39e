//! The three loops at 100, 30 and 10 Hz, the guard around the driver, and their clock.
