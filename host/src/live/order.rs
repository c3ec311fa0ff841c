//! An order to the rendering thread: what shall be seen, and when two of them are of the same program.

use std::time::SystemTime;

use crate::plugin::Configured;
use crate::session::Session;

/// A scene to show.
#[derive(Debug, Clone)]
pub struct Order {
    /// The scene.
    pub session: Session,
    /// When the file was saved that this order follows, by the file system's clock.
    pub saved: Option<SystemTime>,
    pub(super) retried: bool,
}

impl Order {
    /// An order for a scene.
    pub fn new(session: Session) -> Self {
        Self { session, saved: None, retried: false }
    }
}

/// Whether two plugins with their values make the same program and load the same data: only numbers differ, which are
/// uniforms, and none of them is given to a native library. A fitted sampler is made anew for other numbers.
pub(super) fn same_program(a: &Configured, b: &Configured) -> bool {
    let manifest = &a.plugin.manifest;
    let free = |key: &str| {
        manifest.param(key).is_some_and(|param| param.ty.wgsl_member().is_some())
            && !manifest.load.iter().any(|load| load == key)
    };
    a.plugin == b.plugin
        && a.fit_sampler == b.fit_sampler
        && std::iter::zip(a.values.iter(), b.values.iter())
            .all(|((key, one), (_, other))| one == other || free(key))
}
