//! A thread that notices when files of plugins are saved, appear or vanish.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::{Duration, Instant, SystemTime};

use brdf_sdk::{Problem, Result};

use super::Wake;
use crate::registry::watch::{LOOK_EVERY, Watch};

/// What is told so long after a change is about the same one.
const ECHO: Duration = Duration::from_millis(200);

/// New wishes are taken up this fast.
const PATIENCE: Duration = Duration::from_millis(100);

/// Files that were saved, appeared or vanished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    /// The newest of them was written then.
    At(SystemTime),
    /// Watching has just begun: what was read before may be older than its file, and nobody will tell.
    Perhaps,
}

/// The thread; it ends when this is dropped.
pub struct Follow {
    wishes: Sender<[Vec<PathBuf>; 2]>,
    saved: Receiver<Saved>,
    followed: [Vec<PathBuf>; 2],
}

impl Follow {
    /// Starts it, following nothing. `heard` is told where there is word of a file, before it is known
    /// what (true), and where nothing had changed (false).
    ///
    /// # Errors
    /// Where the system has no thread left.
    pub fn start(wake: Wake, heard: impl Fn(bool) + Send + 'static) -> Result<Self> {
        let (wishes, received) = channel();
        let (sender, saved) = channel();
        std::thread::Builder::new()
            .name("follow".to_owned())
            .spawn(move || follow(&received, &sender, &wake, &heard))
            .map_err(|error| {
                Problem::new(
                    "the thread that follows files",
                    error.to_string(),
                    "close other programs",
                )
            })?;
        Ok(Self { wishes, saved, followed: Default::default() })
    }

    /// Follows the plugins in these folders, and these files, from now on.
    pub fn set(&mut self, folders: Vec<PathBuf>, files: Vec<PathBuf>) {
        let wish = [folders, files];
        if wish != self.followed {
            self.followed.clone_from(&wish);
            // The thread lives as long as this.
            let _ = self.wishes.send(wish);
        }
    }

    /// What was saved since the last call.
    pub fn saved(&self) -> Vec<Saved> {
        self.saved.try_iter().collect()
    }
}

fn follow(
    wishes: &Receiver<[Vec<PathBuf>; 2]>,
    sender: &Sender<Saved>,
    wake: &Wake,
    heard: &dyn Fn(bool),
) {
    let mut watch: Option<Watch> = None;
    let mut looked = Instant::now();
    let mut told: Option<Instant> = None;
    loop {
        let wish = match watch {
            None => wishes.recv().ok(),
            Some(_) => match wishes.try_recv() {
                Ok(wish) => Some(wish),
                Err(TryRecvError::Empty) => None,
                Err(TryRecvError::Disconnected) => return,
            },
        };
        match (wish, &watch) {
            (Some([folders, files]), _) => {
                let fresh = Watch::new(folders.clone(), files.clone());
                watch = Some(fresh.unwrap_or_else(|_| Watch::without_events(folders, files)));
                if sender.send(Saved::Perhaps).is_err() {
                    return;
                }
                wake();
            }
            (None, None) => return,
            (None, Some(_)) => {}
        }
        let Some(watch) = &mut watch else { return };
        let mut change = None;
        if watch.hears(PATIENCE) {
            heard(true);
            change = watch.look();
            // One save is told of several times: only the first finds what has changed.
            match (&change, told) {
                (Some(_), _) => told = Some(Instant::now()),
                (None, Some(then)) if then.elapsed() < ECHO => {}
                (None, _) => heard(false),
            }
        }
        if change.is_none() && looked.elapsed() >= LOOK_EVERY {
            looked = Instant::now();
            change = watch.look();
        }
        if let Some(change) = change {
            if sender.send(Saved::At(change.saved)).is_err() {
                return;
            }
            wake();
        }
    }
}
