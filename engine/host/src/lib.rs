//! Loads plugins, finds them on the search path and checks that they keep the contract.
