//! Helpers shared by the verification and validation tests.
