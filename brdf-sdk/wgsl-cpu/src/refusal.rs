//! What cannot be run, and where it stands.
//!
//! A refusal is for valid modules that ask for more than is covered. What is not valid is naga's to say, before it
//! comes here.

use std::fmt;

use naga::Span;

/// A construct that is not covered: it is refused, never computed wrongly.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// What it is, in a few words.
    pub reason: String,
    /// Where it stands in the text that the module was parsed from.
    pub span: Span,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the CPU executor does not run {}", self.reason)
    }
}

impl std::error::Error for Refusal {}
