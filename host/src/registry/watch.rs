//! Tells when the content of folders changes, whatever way an editor writes.
//!
//! Folders are watched, never files, since editors rename over them. An event only wakes the watcher:
//! what counts is the content's hash, once two looks in a row agree on it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant, SystemTime};

use brdf_sdk::{Problem, Result};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

/// Looks this far apart must see the same content: an editor may still be writing.
const SETTLING: Duration = Duration::from_millis(8);

/// Where nothing is told, what is there is looked at this often: a folder that was replaced tells nothing any more.
pub const LOOK_EVERY: Duration = Duration::from_secs(1);

/// Watches the folders of plugins, and files that they read, for changed content.
pub struct Watch {
    folders: Vec<PathBuf>,
    /// Files that are plugins by themselves, and others that plugins read.
    alone: Vec<PathBuf>,
    files: Vec<PathBuf>,
    events: Receiver<()>,
    seen: BTreeMap<PathBuf, u64>,
    /// What the system's watch on each folder hangs on.
    hung: Vec<Option<Identity>>,
    /// `None` where the file system tells nothing, and looking again and again is all there is.
    watcher: Option<RecommendedWatcher>,
}

/// A change of content.
#[derive(Debug, Clone, Copy)]
pub struct Change {
    /// When the newest of the files was written that changed or appeared, by the file system's clock.
    pub saved: SystemTime,
}

impl Watch {
    /// Starts watching the plugins in folders, and files; what is there now counts as seen.
    pub fn new(folders: Vec<PathBuf>, files: Vec<PathBuf>) -> Result<Self> {
        let (folders, alone, files) = apart(folders, files);
        let (sender, events) = channel();
        let mut watcher =
            notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
                let relevant = event
                    .is_ok_and(|event| !event.kind.is_access() || is_close_after_write(&event));
                if relevant {
                    // The receiver is gone when the program ends; then nobody is left to tell.
                    let _ = sender.send(());
                }
            })
            .map_err(|error| unwatchable(&error))?;
        for folder in &folders {
            watcher.watch(folder, RecursiveMode::Recursive).map_err(|error| unwatchable(&error))?;
        }
        for folder in folders_of(&files) {
            watcher
                .watch(&folder, RecursiveMode::NonRecursive)
                .map_err(|error| unwatchable(&error))?;
        }
        let seen = hashes(&folders, &files);
        let hung = identities(&folders);
        Ok(Self { folders, alone, files, events, seen, hung, watcher: Some(watcher) })
    }

    /// The same without word from the file system: only [`Watch::look`] finds something.
    pub fn without_events(folders: Vec<PathBuf>, files: Vec<PathBuf>) -> Self {
        let (folders, alone, files) = apart(folders, files);
        let seen = hashes(&folders, &files);
        let hung = identities(&folders);
        Self { folders, alone, files, events: channel().1, seen, hung, watcher: None }
    }

    /// Watches these files from now on, in the place of those before. What is new among them counts as seen.
    ///
    /// # Errors
    /// Where a folder cannot be watched.
    pub fn set_files(&mut self, mut files: Vec<PathBuf>) -> Result<()> {
        files.extend(self.alone.clone());
        let watched = folders_of(&self.files);
        for folder in folders_of(&files).difference(&watched) {
            if let Some(watcher) = &mut self.watcher {
                watcher
                    .watch(folder, RecursiveMode::NonRecursive)
                    .map_err(|error| unwatchable(&error))?;
            }
        }
        for file in self.files.iter().filter(|file| !files.contains(file)) {
            self.seen.remove(file);
        }
        for file in files.iter().filter(|file| !self.files.contains(file)) {
            add(file.clone(), &mut self.seen);
        }
        self.files = files;
        Ok(())
    }

    /// Waits at most `patience` for changed content that has settled.
    pub fn wait(&mut self, patience: Duration) -> Option<Change> {
        let start = Instant::now();
        loop {
            let left = patience.saturating_sub(start.elapsed());
            let heard = self.hears(left.min(LOOK_EVERY));
            if !heard && left < LOOK_EVERY {
                return None;
            }
            let change = self.look();
            if heard || change.is_some() {
                return change;
            }
        }
    }

    /// Waits at most `patience` for word from the file system; what it is about, [`Watch::look`] finds out.
    pub fn hears(&mut self, patience: Duration) -> bool {
        match self.events.recv_timeout(patience) {
            Ok(()) => true,
            Err(RecvTimeoutError::Timeout) => false,
            Err(RecvTimeoutError::Disconnected) => {
                std::thread::sleep(patience);
                false
            }
        }
    }

    /// Looks for changed content now, whether anything was told or not, and waits until it has settled.
    pub fn look(&mut self) -> Option<Change> {
        let event = SystemTime::now();
        while self.events.try_recv().is_ok() {}
        self.hang_again();
        let mut now = hashes(&self.folders, &self.files);
        loop {
            std::thread::sleep(SETTLING);
            let again = hashes(&self.folders, &self.files);
            if again == now {
                break;
            }
            now = again;
        }
        let before = std::mem::replace(&mut self.seen, now);
        let mut files: Vec<PathBuf> = before.keys().chain(self.seen.keys()).cloned().collect();
        files.sort();
        files.dedup();
        files.retain(|file| before.get(file) != self.seen.get(file));
        if files.is_empty() {
            return None;
        }
        let written = files.iter().filter_map(|file| fs::metadata(file).ok()?.modified().ok());
        // A file that was moved here carries an older time.
        let fresh = written.max().filter(|written| *written + Duration::from_secs(1) > event);
        Some(Change { saved: fresh.unwrap_or(event) })
    }

    /// Watches folders that came back, or others in their places: the system's watch hangs on the folder that was there.
    fn hang_again(&mut self) {
        let now = identities(&self.folders);
        let (Some(watcher), true) = (&mut self.watcher, now != self.hung) else { return };
        for ((folder, before), now) in self.folders.iter().zip(&self.hung).zip(&now) {
            if now.is_some() && now != before {
                // It fails where the system has noticed the loss itself; what is not watched is looked at.
                let _ = watcher.unwatch(folder);
                let _ = watcher.watch(folder, RecursiveMode::Recursive);
            }
        }
        self.hung = now;
    }
}

/// What tells a folder from another one that takes its place, as far as the file system knows.
type Identity = Option<SystemTime>;

/// The identity of each folder that is there.
fn identities(folders: &[PathBuf]) -> Vec<Option<Identity>> {
    folders.iter().map(|folder| Some(fs::metadata(folder).ok()?.created().ok())).collect()
}

/// Folders, files among them, and all files.
fn apart(
    folders: Vec<PathBuf>,
    mut files: Vec<PathBuf>,
) -> (Vec<PathBuf>, Vec<PathBuf>, Vec<PathBuf>) {
    let (alone, folders): (Vec<_>, Vec<_>) = folders.into_iter().partition(|path| path.is_file());
    files.extend(alone.clone());
    (folders, alone, files)
}

fn unwatchable(error: &notify::Error) -> Problem {
    Problem::new(
        "--watch",
        format!("the folders cannot be watched ({error})"),
        "render without --watch",
    )
}

fn is_close_after_write(event: &notify::Event) -> bool {
    use notify::event::{AccessKind, AccessMode, EventKind};
    matches!(event.kind, EventKind::Access(AccessKind::Close(AccessMode::Write)))
}

/// The content hash of each file that belongs to a plugin; editors' swap files do not.
fn hashes(folders: &[PathBuf], files: &[PathBuf]) -> BTreeMap<PathBuf, u64> {
    let mut hashes = BTreeMap::new();
    for file in files {
        add(file.clone(), &mut hashes);
    }
    for folder in folders {
        gather(folder, 4, &mut hashes);
    }
    hashes
}

/// The folders that files lie in, as far as they are there.
fn folders_of(files: &[PathBuf]) -> BTreeSet<PathBuf> {
    let there = |file: &PathBuf| {
        let folder = file.parent()?;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        folder.is_dir().then(|| folder.to_owned())
    };
    files.iter().filter_map(there).collect()
}

/// Libraries and data are large: size and time stand for the content.
fn add(file: PathBuf, hashes: &mut BTreeMap<PathBuf, u64>) {
    if let Ok(known) = fs::metadata(&file) {
        let mut hasher = DefaultHasher::new();
        (known.len(), known.modified().ok()).hash(&mut hasher);
        hashes.insert(file, hasher.finish());
    }
}

fn gather(folder: &Path, depth: u32, hashes: &mut BTreeMap<PathBuf, u64>) {
    for name in super::folder::names(folder) {
        let path = folder.join(&name);
        let relevant = Path::new(&name).extension().is_some_and(|e| e == "toml" || e == "wgsl");
        // What cargo builds is of the size of hours, and no plugin's text.
        if path.is_dir() && depth > 0 && name != "target" {
            gather(&path, depth - 1, hashes);
        } else if relevant && let Ok(bytes) = fs::read(&path) {
            let mut hasher = DefaultHasher::new();
            bytes.hash(&mut hasher);
            hashes.insert(path, hasher.finish());
        }
    }
}
