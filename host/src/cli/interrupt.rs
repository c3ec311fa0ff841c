//! Ctrl-C: the picture ends with what there is; a second one ends the program.

use std::sync::atomic::{AtomicBool, Ordering};

use brdf_sdk::{Problem, Result};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was interrupted.
const INTERRUPTED: i32 = 130;

/// Takes Ctrl-C for a wish to finish, from now on.
pub(super) fn listen() -> Result<()> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    })
    .map_err(|error| Problem::new("Ctrl-C", error.to_string(), "start the program again"))
}

/// Whether it was asked to finish.
pub(super) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
