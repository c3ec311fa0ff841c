//! The BRDF explorer as a library; the program `brdf` is its command line.
//!
//! Dependencies run one way: `cli -> render -> exec -> link -> brdf-sdk`; `scene`, `environment`,
//! `measure` and `picture` stand beside them and know nothing of devices.

pub mod bench;
pub mod catalogue;
pub mod cli;
pub mod conformance;
mod data;
pub mod environment;
pub mod exec;
pub mod figure;
mod fit;
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
pub mod tables;
pub mod tabulation;
pub mod template;
pub mod tone;
pub mod ui;
