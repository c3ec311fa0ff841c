//! The host's modules that know of no device, no window and no command line, as a crate of their own: that they can
//! stand alone is the direction of the host's dependencies, and it spares the targets a build of hundreds of crates.

#![allow(dead_code, reason = "what only the rest of the host calls")]

#[path = "../../host/src/environment/mod.rs"]
pub mod environment;
#[path = "../../host/src/file.rs"]
pub mod file;
#[path = "../../host/src/held.rs"]
pub mod held;
#[path = "../../host/src/layout.rs"]
pub mod layout;
#[path = "../../host/src/link/mod.rs"]
pub mod link;
#[path = "../../host/src/native/mod.rs"]
pub mod native;
#[path = "../../host/src/plugin.rs"]
pub mod plugin;
#[path = "../../host/src/scene/mod.rs"]
pub mod scene;
#[path = "../../host/src/tone.rs"]
pub mod tone;
