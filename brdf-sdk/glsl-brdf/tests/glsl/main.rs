//! Files of BRDF Explorer, translated.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what it expects by unwrapping")]

mod common;
mod constructs;
mod mutations;
mod refusals;
mod sampling;
