//! Rendering behind a window: a thread with a device of its own that is told what shall be seen, and shows it better
//! and better until it is told something else.
//!
//! [`Live::show`] gives an order, the newest one counts; [`Live::status`] says what came of it. Nothing here waits
//! for a device, and nothing here knows of windows: `wake` is called where there is something new to look at.

mod desk;
mod document;
mod follow;
mod frame;
mod history;
mod kept;
mod order;
mod pictures;
mod seen;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};

pub use desk::{Answered, Asked, Desk};
pub use document::{Document, Material, Opened};
pub use follow::{Follow, Saved};
pub use frame::{Frame, Timing, fresh_number};
pub use history::History;
use kept::Kept;
pub use order::Order;

use crate::environment::Environment;
use crate::registry::Registry;
use crate::render::Pace;
use crate::session::Session;

/// How long a dispatch takes while somebody moves something: two of them and a small picture fit into 33 ms.
const INTERACTIVE_BUDGET: Duration = Duration::from_millis(12);

/// How long it takes else: a file that is saved waits for one.
const WATCHED_BUDGET: Duration = Duration::from_millis(30);

/// How long rendering stands back where a file was saved: the time to read it, and a picture's drawing.
const ROOM: Duration = Duration::from_millis(100);

/// How long other work stands back behind the picture of a saved file.
const PRECEDENCE: Duration = Duration::from_millis(150);

/// Who moves something sends the next order within this time; three frames of a screen.
const MOVING: Duration = Duration::from_millis(50);

/// Called on the rendering thread where there is news.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// What the rendering thread is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Doing {
    /// Nothing is left to do.
    #[default]
    Waiting,
    /// Reading the environment or a mesh.
    Loading,
    /// Linking, and the device's own compiler.
    Compiling,
    /// Samples, or terms.
    Rendering,
}

/// What came of the newest order.
#[derive(Debug, Clone, Default)]
pub struct Status {
    /// The newest picture; that of an earlier order where the newest one has none.
    pub frame: Option<Arc<Frame>>,
    /// What is wrong with the newest order. The picture is then made without what is broken.
    pub problem: Option<Problem>,
    /// What is worth telling of the newest order.
    pub notes: Vec<String>,
    /// What the thread is at.
    pub doing: Doing,
    /// How far the whole picture is, where it is not shown yet: samples or texels, of all.
    pub progress: Option<[u64; 2]>,
    /// The map, as it was read.
    pub environment: Option<Arc<Environment>>,
    /// The device's name.
    pub device: String,
    /// How long the newest program took to link, to compile and to show its first pixel.
    pub timing: Option<Timing>,
}

/// A rendering thread.
pub struct Live {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    desired: Mutex<Desired>,
    changed: Condvar,
    pace: Arc<Pace>,
    /// Whether somebody is moving something.
    moving: AtomicBool,
    /// Whether the order for a saved file has no picture yet.
    awaited: Arc<AtomicBool>,
    status: Mutex<Status>,
    wake: Wake,
}

#[derive(Default)]
struct Desired {
    order: Option<Order>,
    quit: bool,
}

fn waits_no_longer(desired: &Desired) -> bool {
    desired.order.is_some() || desired.quit
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Whether another order waits, or comes within moments from somebody who is moving something.
    fn is_moving(&self) -> bool {
        let waits = |desired: &mut Desired| desired.order.is_none() && !desired.quit;
        let desired = lock(&self.desired);
        if !waits_no_longer(&desired) && self.moving.load(Ordering::Acquire) {
            let waited = self.changed.wait_timeout_while(desired, MOVING, waits);
            let (desired, _) = waited.unwrap_or_else(PoisonError::into_inner);
            return waits_no_longer(&desired);
        }
        waits_no_longer(&desired)
    }

    /// Nobody waits for the order's first picture any more, unless a newer one has come.
    fn picture_is_there(&self) {
        let desired = lock(&self.desired);
        if desired.order.is_none() {
            self.awaited.store(false, Ordering::Release);
        }
    }

    /// Whether the picture that is seen is of this scene, and nothing is left to do in it.
    fn has_finished(&self, scene: &Session) -> bool {
        let frame = lock(&self.status).frame.clone().filter(|frame| frame.complete);
        frame.is_some_and(|frame| (*frame.session).clone().bare() == scene.clone().bare())
    }

    fn update(&self, change: impl FnOnce(&mut Status)) {
        change(&mut lock(&self.status));
        (self.wake)();
    }
}

impl Live {
    /// Starts the thread; `device` as `--device` names it.
    ///
    /// # Errors
    /// Where the system has no thread left. A device that does not open is told of in the status.
    pub fn start(registry: Registry, device: Option<String>, wake: Wake) -> Result<Self> {
        let shared = Arc::new(Shared {
            desired: Mutex::default(),
            changed: Condvar::new(),
            pace: Pace::new(WATCHED_BUDGET),
            moving: AtomicBool::new(false),
            awaited: Arc::default(),
            status: Mutex::default(),
            wake,
        });
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("live".to_owned())
            .spawn(move || work(&own, &registry, device.as_deref()))
            .map_err(|error| {
                Problem::new("the rendering thread", error.to_string(), "close other programs")
            })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Says what shall be seen from now on; what is under way ends with its dispatch.
    pub fn show(&self, order: Order) {
        let mut desired = lock(&self.shared.desired);
        if order.saved.is_some() {
            self.shared.awaited.store(true, Ordering::Release);
        }
        desired.order = Some(order);
        // Together with the order: else the thread might take it first, and then be told to leave it.
        self.shared.pace.abandon(true);
        self.shared.changed.notify_one();
    }

    /// Whether somebody is moving something: then dispatches are short, so that an order waits for no long one.
    pub fn interact(&self, interacting: bool) {
        let budget = if interacting { INTERACTIVE_BUDGET } else { WATCHED_BUDGET };
        self.shared.moving.store(interacting, Ordering::Release);
        self.shared.pace.set_budget(budget);
    }

    /// Lets the rendering stand back for a moment (true), since another order will follow, or go on (false): for whoever
    /// hears of it first.
    pub fn make_room(&self) -> impl Fn(bool) + Send + 'static {
        let pace = Arc::clone(&self.shared.pace);
        move |room| if room { pace.pause(ROOM) } else { pace.resume() }
    }

    /// Waits until the order for a saved file has its first picture, a while at the most: for work that would take the
    /// cores from it, and that nobody waits for as much.
    pub fn precedence(&self) -> impl Fn() + Send + 'static {
        let awaited = Arc::clone(&self.shared.awaited);
        move || {
            let start = Instant::now();
            while awaited.load(Ordering::Acquire) && start.elapsed() < PRECEDENCE {
                std::thread::sleep(Duration::from_millis(2));
            }
        }
    }

    /// What came of the newest order so far.
    pub fn status(&self) -> Status {
        lock(&self.shared.status).clone()
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        lock(&self.shared.desired).quit = true;
        self.shared.pace.abandon(true);
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // It has caught its own panics.
            let _ = thread.join();
        }
    }
}

/// The thread: one order after the other.
fn work(shared: &Shared, registry: &Registry, device: Option<&str>) {
    let mut kept: Option<Kept> = None;
    while let Some(order) = next(shared) {
        if kept.as_ref().is_none_or(Kept::is_gone) {
            match Kept::open(registry, device) {
                Ok((fresh, note)) => {
                    shared.update(|status| {
                        status.device = fresh.device();
                        status.notes.extend(note);
                    });
                    kept = Some(fresh);
                }
                Err(problem) => {
                    shared.update(|status| status.problem = Some(problem));
                    shared.picture_is_there();
                    continue;
                }
            }
        }
        let Some(on) = &mut kept else { continue };
        let drawn = catch_unwind(AssertUnwindSafe(|| on.draw(shared, &order)));
        shared.picture_is_there();
        let problem = match drawn {
            Ok(Ok(())) => None,
            Ok(Err(problem)) => Some(problem),
            Err(_) => {
                kept = None;
                // It may have failed at a picture that went on in any case.
                shared.pace.hold(false);
                Some(Problem::new(
                    "the rendering thread",
                    "it failed at this order and was started anew",
                    "change what you changed last, and report this",
                ))
            }
        };
        shared.update(|status| {
            status.doing = Doing::Waiting;
            if problem.is_some() {
                status.problem = problem;
            }
        });
        // A device that was lost under an order gets a second try on a fresh one.
        if kept.as_ref().is_some_and(Kept::is_gone) && !order.retried {
            let mut desired = lock(&shared.desired);
            desired.order.get_or_insert(Order { retried: true, ..order });
        }
    }
}

/// Waits for the next order; `None` at the end.
fn next(shared: &Shared) -> Option<Order> {
    let mut desired = lock(&shared.desired);
    loop {
        if desired.quit {
            return None;
        }
        if let Some(order) = desired.order.take() {
            shared.pace.abandon(false);
            shared.pace.resume();
            return Some(order);
        }
        desired = shared.changed.wait(desired).unwrap_or_else(PoisonError::into_inner);
    }
}

/// Seconds since then.
fn since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}
