//! The BRDF explorer as a library; the program `brdf` is its command line.
//!
//! `registry` finds plugins, `link` makes programs of them, `exec` runs programs, `render` makes pictures with them, and
//! `cli` and `ui` are for people. Dependencies run one way: tests/tidy.rs has a line for each module with what it may name.

pub mod bench;
pub mod catalogue;
pub mod cli;
pub mod conformance;
mod data;
pub mod environment;
pub mod exec;
pub mod figure;
mod file;
mod held;
pub mod layout;
pub mod link;
pub mod live;
pub mod measure;
pub mod native;
pub mod numerics;
pub mod open;
pub mod picture;
pub mod plot;
pub mod plugin;
pub mod registry;
pub mod render;
pub mod scene;
pub mod session;
pub mod tabulation;
pub mod template;
pub mod tone;
pub mod ui;
