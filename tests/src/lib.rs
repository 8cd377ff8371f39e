//! End-to-end tests that drive the program as a user does.
