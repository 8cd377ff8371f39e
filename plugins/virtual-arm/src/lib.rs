//! Driver: an arm and a real object, simulated.
