//! What a plugin is.
//!
//! The manifest (`plugin.toml`), its parameters and the words of the contract, shared by the host
//! and by authors of native plugins. Nothing here knows of devices, windows or rendering.

pub mod manifest;
pub mod problem;
pub mod reserved;
pub mod table;

pub use manifest::{Kind, Manifest, Param, ParamType, ParamValue, ParamValues};
pub use problem::{Place, Problem, Result};
