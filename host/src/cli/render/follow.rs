//! `--watch`: the picture follows the plugins' files.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use brdf_sdk::{Problem, Result};

use crate::cli::studio::Studio;
use crate::registry::Registry;
use crate::registry::watch::{Change, Watch};
use crate::render::Wish;
use crate::session::Session;

/// Starts watching the folders of the plugins that were read from disk.
pub(super) fn start(session: &Session) -> Result<Watch> {
    let folders: Vec<PathBuf> =
        [&session.brdf, &session.integrator].into_iter().filter_map(|c| c.folder.clone()).collect();
    let files = session.brdf.files();
    if folders.is_empty() && files.is_empty() {
        return Err(Problem::new(
            "--watch",
            "both plugins are embedded in the program, where no file changes",
            "name the folder of a plugin; `brdf new brdf NAME` makes one",
        ));
    }
    Watch::new(folders, files)
}

/// Renders again after every change, until the program is stopped. A broken plugin is told of once,
/// and the last good picture stays.
pub(super) fn follow(
    registry: &Registry,
    mut session: Session,
    export: &Path,
    mut studio: Studio,
    mut watch: Watch,
) -> Result<()> {
    eprintln!("watching; stop with Ctrl-C");
    let mut pending: Option<Change> = None;
    let mut told: Option<String> = None;
    loop {
        let change = match pending.take() {
            Some(change) => change,
            None => match watch.wait(Duration::from_secs(3600)) {
                Some(change) => change,
                None => continue,
            },
        };
        let mut first_pixel = None;
        let made = reloaded(registry, &session).and_then(|fresh| {
            // An edited manifest may name other data or another library.
            watch.set_files(fresh.brdf.files())?;
            let made = studio.picture(&fresh, export, &mut |_| {
                first_pixel.get_or_insert_with(|| since(change.saved));
                pending = watch.wait(Duration::ZERO);
                if pending.is_some() { Wish::Abandon } else { Wish::GoOn }
            })?;
            session = fresh;
            Ok(made)
        });
        match made {
            Ok(made) => {
                told = None;
                eprintln!(
                    "reloaded: first pixel {:.0} ms after the save (link {:.0} ms, compile {:.0} ms)",
                    first_pixel.unwrap_or_default().as_secs_f64() * 1e3,
                    made.link.as_secs_f64() * 1e3,
                    made.rendered.compile.as_secs_f64() * 1e3,
                );
            }
            Err(problem) => {
                // Half a file may have been read; the rest comes within moments.
                pending = watch.wait(Duration::from_millis(150));
                if pending.is_some() {
                    continue;
                }
                let message = problem.to_string();
                if told.as_ref() != Some(&message) {
                    eprintln!("error: {message}\nthe last good picture stays");
                }
                told = Some(message);
            }
        }
    }
}

/// Both plugins read again, parameters kept by name.
fn reloaded(registry: &Registry, session: &Session) -> Result<Session> {
    Ok(Session {
        brdf: session.brdf.reload(registry)?,
        integrator: session.integrator.reload(registry)?,
        ..session.clone()
    })
}

fn since(saved: SystemTime) -> Duration {
    SystemTime::now().duration_since(saved).unwrap_or_default()
}
