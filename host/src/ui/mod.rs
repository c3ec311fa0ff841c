//! The window: every view of the BRDFs that are open, and of the picture that is rendered.
//!
//! It is the only user of egui. Nothing is computed here: pictures come from [`crate::live`], numbers of plots from
//! [`crate::plot`] on a desk, drawings for files from [`crate::figure`]. Functions that draw end in `_ui`.

mod actions;
mod asked;
mod beside;
mod compare;
mod convergence;
mod create;
mod editor;
mod environment;
mod files;
mod key;
mod layout;
mod lit;
mod lobe;
mod materials;
mod memory;
mod menu;
mod palette;
mod parameters;
mod parts;
mod plots;
mod problems;
mod proofs;
mod slices;
mod start;
mod textures;
mod viewer;

pub use start::{Begin, open};
pub use viewer::Viewer;
