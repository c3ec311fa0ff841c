//! What a plugin is.
//!
//! The manifest (`plugin.toml`), its parameters and the words of the contract, for the host; and what authors
//! of native plugins write against ([`native`], which needs none of the rest: `default-features = false`).
//! Nothing here knows of devices, windows or rendering.

#[cfg(feature = "manifest")]
pub mod manifest;
pub mod native;
#[cfg(feature = "manifest")]
pub mod problem;
#[cfg(feature = "manifest")]
pub mod reserved;
#[cfg(feature = "manifest")]
pub mod table;

#[cfg(feature = "manifest")]
pub use manifest::{Kind, Manifest, Param, ParamType, ParamValue, ParamValues};
#[cfg(feature = "manifest")]
pub use problem::{Place, Problem, Result};
