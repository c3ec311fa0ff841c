//! How work is cut into dispatches: by measured time, within the kernel rules.
//!
//! Work is counted in steps of one pixel: samples, or terms. The cut never shows in the picture: the
//! kernels add a cut block's parts in the same order as the whole.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::link::LOOP_ITERATIONS;

/// Steps of a full block of one replicate. Its sum is f32; the blocks are added in f64.
pub const BLOCK: u32 = 1024;

/// Terms of a full block.
pub const TERM_BLOCK: u32 = 4096;

/// Dispatches of a stretch of work.
const STRETCH: u64 = 8;

/// The smallest share of the rows worth a dispatch of its own.
const MIN_ROWS: u32 = 4096;

/// No dispatch does more than this many times the work of the longest one so far.
const GROWTH: u64 = 8;

/// How long a dispatch should take while nobody waits.
pub const HEADLESS_BUDGET: Duration = Duration::from_millis(100);

/// How long dispatches shall take, and whether the rendering is still wanted: shared with whoever watches, who may
/// change both at any time.
#[derive(Debug)]
pub struct Pace {
    micros: AtomicU64,
    abandoned: AtomicBool,
    held: AtomicBool,
    /// When the last pause began, and when it ends.
    pause: Mutex<Option<[Instant; 2]>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Pace {
    /// Dispatches of about this long.
    pub fn new(budget: Duration) -> Arc<Self> {
        let [abandoned, held] = [false; 2].map(AtomicBool::new);
        let pace = Self { micros: AtomicU64::new(0), abandoned, held, pause: Mutex::default() };
        pace.set_budget(budget);
        Arc::new(pace)
    }

    /// How long a dispatch shall take.
    pub fn budget(&self) -> Duration {
        Duration::from_micros(self.micros.load(Ordering::Relaxed))
    }

    /// Changes it, from the next dispatch on.
    pub fn set_budget(&self, budget: Duration) {
        let micros = u64::try_from(budget.as_micros()).unwrap_or(u64::MAX);
        self.micros.store(micros, Ordering::Relaxed);
    }

    /// Whether a rendering shall end after the dispatch under way, with nothing to show.
    pub fn is_abandoned(&self) -> bool {
        self.abandoned.load(Ordering::Acquire) && !self.held.load(Ordering::Acquire)
    }

    /// Whether the rendering goes on to its end all the same: whoever is told to stop ever again would else never have
    /// anything to show.
    pub fn hold(&self, held: bool) {
        self.held.store(held, Ordering::Release);
    }

    /// Lets no dispatch begin for a while: somebody else needs the cores. Ten times as long must lie between the begins of
    /// two pauses; a wish that comes sooner is passed over.
    pub fn pause(&self, time: Duration) {
        let mut pause = lock(&self.pause);
        let now = Instant::now();
        if pause.is_none_or(|[begin, _]| now > begin + 10 * time) {
            *pause = Some([now, now + time]);
        }
    }

    /// Ends the pause.
    pub fn resume(&self) {
        if let Some([_, end]) = lock(&self.pause).as_mut() {
            *end = Instant::now().min(*end);
        }
    }

    /// Waits for the end of the pause, or until nobody wants the rendering any more. What goes on to its end in any case
    /// waits for nobody.
    fn sit_out(&self) {
        const MOMENT: Duration = Duration::from_millis(1);
        let pauses = || lock(&self.pause).is_some_and(|[_, end]| Instant::now() < end);
        let held = || self.held.load(Ordering::Acquire);
        while pauses() && !held() && !self.is_abandoned() {
            std::thread::sleep(MOMENT);
        }
    }

    /// Says whether it shall.
    pub fn abandon(&self, abandoned: bool) {
        self.abandoned.store(abandoned, Ordering::Release);
    }
}

/// Learns how fast steps are, and says how much the next dispatch may do.
#[derive(Debug, Clone)]
pub struct Schedule {
    pace: Arc<Pace>,
    /// Steps per second.
    rate: Option<f64>,
    /// No more steps per second are counted on.
    ceiling: f64,
    longest: u64,
    /// Invocations that keep the device busy.
    parallel: u32,
    /// Steps of one invocation in one dispatch; lowered where a plugin's loops ran out of budget.
    step_limit: u32,
}

/// What one dispatch does of a stretch of work: some rows, some replicates, some steps of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// Rows.
    pub rows: u32,
    /// Replicates.
    pub replicates: u32,
    /// Steps of each replicate at each row.
    pub steps: u32,
}

impl Cut {
    /// Its steps, over all rows and replicates.
    pub fn work(self) -> u64 {
        u64::from(self.rows) * u64::from(self.replicates) * u64::from(self.steps)
    }
}

impl Schedule {
    /// A schedule for dispatches at this pace of a program whose step takes `iterations` of the
    /// kernel's loops at the most, on a device that `parallel` invocations keep busy.
    pub fn new(pace: Arc<Pace>, iterations: u32, parallel: u32) -> Self {
        Self {
            pace,
            parallel,
            rate: None,
            ceiling: f64::INFINITY,
            longest: u64::from(MIN_ROWS) / GROWTH,
            step_limit: (LOOP_ITERATIONS / iterations).max(1),
        }
    }

    /// Steps of each replicate in the next stretch, which goes over all of `rows` rows and
    /// `replicates` replicates: some dispatches, and one step at the least. A replicate's turn costs as
    /// much as a few steps, so several steps a turn are worth the wait.
    pub fn stretch(&self, rows: u64, replicates: u32) -> u32 {
        let each = self.by_time() * STRETCH / (rows.max(1) * u64::from(replicates)).max(1);
        // A replicate costs the kernel an iteration of its own, beside one for each step. A power of two divides a block:
        // no rest is left that is too short for a dispatch.
        let rows = u32::try_from(rows).unwrap_or(u32::MAX);
        let own = replicates.div_ceil(self.shares(rows, replicates));
        let by_iterations = (self.step_limit / own.max(1)).saturating_sub(1).max(1);
        let by_iterations = 1 << by_iterations.ilog2();
        u32::try_from(each).unwrap_or(u32::MAX).min(by_iterations).clamp(1, BLOCK)
    }

    /// The next dispatch of a stretch of which so much is left. An invocation has a price of its own, so
    /// rows are cut first, replicates where few rows are left, and steps last.
    pub fn cut(&self, left: Cut) -> Cut {
        let allowed = self.allowed();
        let fitting = |each: u64| u32::try_from(allowed / each.max(1)).unwrap_or(u32::MAX).max(1);
        let least_rows = MIN_ROWS.min(left.rows);
        let steps = left.steps.min(self.step_limit).min(fitting(least_rows.into()));
        let each = u64::from(least_rows) * u64::from(steps);
        // Fewer rows leave more invocations to each of them, not fewer.
        let shares = self.shares(left.rows, left.replicates);
        let by_iterations = shares.saturating_mul((self.step_limit / (steps + 1)).max(1));
        let replicates = left.replicates.min(by_iterations).min(fitting(each));
        let rows = fitting(u64::from(steps) * u64::from(replicates)).max(least_rows);
        Cut { rows: rows.min(left.rows), replicates, steps }
    }

    /// Invocations that share the replicates of a row: as many as keep the device busy, each with as many replicates
    /// as the others.
    pub fn shares(&self, rows: u32, replicates: u32) -> u32 {
        let replicates = replicates.max(1);
        let wanted = (self.parallel / rows.max(1)).clamp(1, replicates);
        replicates.div_ceil(replicates.div_ceil(wanted))
    }

    /// Steps of any pixel that one dispatch may do.
    fn allowed(&self) -> u64 {
        self.by_time().min(self.longest.saturating_mul(GROWTH)).max(1)
    }

    /// Steps of any pixel that take as long as a dispatch shall.
    fn by_time(&self) -> u64 {
        match self.rate {
            Some(rate) => (rate.min(self.ceiling) * self.pace.budget().as_secs_f64()) as u64,
            None => u64::from(MIN_ROWS),
        }
    }

    /// Whether nobody wants the rendering any more.
    pub fn is_abandoned(&self) -> bool {
        self.pace.is_abandoned()
    }

    /// Whether a dispatch may begin: where there is a pause, after it.
    pub fn goes_on(&self) -> bool {
        self.pace.sit_out();
        !self.is_abandoned()
    }

    /// Whether any dispatch was measured.
    pub fn knows(&self) -> bool {
        self.rate.is_some()
    }

    /// Takes note of a dispatch that did `steps` steps (of any pixel) in `time`.
    pub fn learn(&mut self, steps: u64, time: Duration) {
        self.rate = Some(steps as f64 / time.as_secs_f64().max(1e-6));
        self.longest = self.longest.max(steps);
    }

    /// Steps per second, as the last dispatch was measured.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// Counts on no more steps per second than this.
    pub fn set_ceiling(&mut self, ceiling: f64) {
        self.ceiling = ceiling;
    }

    /// Lowers the steps of one invocation after `done` of them used up the plugins' loop budget;
    /// false where a single one did.
    pub fn shorten(&mut self, done: u32) -> bool {
        self.step_limit = (done / 8).max(1);
        done > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_grows_from_a_small_start_to_the_budget() {
        let mut schedule = Schedule::new(Pace::new(Duration::from_millis(100)), 1, 1);
        let rows = 150_000;
        assert_eq!(schedule.stretch(rows, 16), 1);
        let all = Cut { rows: rows as u32, replicates: 16, steps: 64 };
        assert_eq!(schedule.cut(all), Cut { rows: 4096, replicates: 1, steps: 1 });
        // A device of 100 million steps per second: 10 million a dispatch.
        let mut largest = 0;
        for _ in 0..20 {
            let steps = schedule.stretch(rows, 16);
            let cut = schedule.cut(Cut { rows: rows as u32, replicates: 16, steps });
            let steps = u64::from(cut.rows) * u64::from(cut.replicates) * u64::from(cut.steps);
            assert!(steps <= 10_000_000);
            largest = largest.max(steps);
            schedule.learn(steps, Duration::from_secs_f64(steps as f64 / 1e8));
        }
        // A stretch takes eight dispatches.
        assert!(largest > 9_000_000, "{largest}");
        assert_eq!(schedule.stretch(rows, 16), 33);
    }

    #[test]
    fn nothing_begins_in_a_pause_until_it_ends_or_is_ended() {
        let pace = Pace::new(Duration::from_millis(30));
        let schedule = Schedule::new(Arc::clone(&pace), 1, 1);
        let begin = Instant::now();
        pace.pause(Duration::from_millis(40));
        assert!(schedule.goes_on());
        assert!(begin.elapsed() >= Duration::from_millis(40));
        // Another one would come too soon.
        let hour = Duration::from_secs(3600);
        pace.pause(hour);
        assert!(begin.elapsed() > Duration::from_millis(400) || schedule.goes_on());

        // Of an hour nothing is left where it is ended, where the rendering is held, or where nobody wants it any more.
        let paused = || {
            let pace = Pace::new(Duration::from_millis(30));
            pace.pause(hour);
            (Arc::clone(&pace), Schedule::new(pace, 1, 1))
        };
        let (pace, schedule) = paused();
        pace.resume();
        assert!(schedule.goes_on());
        let (pace, schedule) = paused();
        pace.hold(true);
        assert!(schedule.goes_on());
        let (pace, schedule) = paused();
        pace.abandon(true);
        assert!(!schedule.goes_on());
    }

    #[test]
    fn slow_plugins_get_few_steps_and_kernel_loops_stay_in_their_half() {
        let mut slow = Schedule::new(Pace::new(Duration::from_millis(100)), 1, 1);
        slow.learn(4096, Duration::from_secs(1));
        let all = Cut { rows: 150_000, replicates: 16, steps: 1 };
        assert_eq!(slow.cut(all), Cut { rows: 4096, replicates: 1, steps: 1 });

        let mut fast = Schedule::new(Pace::new(Duration::from_secs(100)), 1, 1);
        fast.learn(u64::from(u32::MAX), Duration::from_millis(1));
        let steps = fast.stretch(10, 16);
        assert_eq!(steps, 512);
        assert_eq!(
            fast.cut(Cut { rows: 10, replicates: 16, steps }),
            Cut { rows: 10, replicates: 16, steps }
        );
        assert!(fast.shorten(1024));
        assert_eq!(
            fast.cut(Cut { rows: 10, replicates: 16, steps: 31 }),
            Cut { rows: 10, replicates: 4, steps: 31 }
        );
        assert_eq!(
            fast.cut(Cut { rows: 10, replicates: 1, steps: 1000 }),
            Cut { rows: 10, replicates: 1, steps: 128 }
        );
        assert!(fast.shorten(2) && !fast.shorten(1));
    }

    #[test]
    fn many_lanes_share_the_replicates_of_few_rows() {
        let wide = |iterations| {
            let pace = Pace::new(Duration::from_secs(100));
            let mut schedule = Schedule::new(pace, iterations, 1 << 21);
            schedule.learn(u64::from(u32::MAX), Duration::from_millis(1));
            schedule
        };
        let schedule = wide(1);
        assert_eq!(schedule.shares(2000, 16), 16);
        // 14 lanes for each row: two replicates for each of eight, and not one for some and two for others.
        assert_eq!(schedule.shares(150_000, 16), 8);
        assert_eq!(schedule.shares(3_000_000, 16), 1);
        assert_eq!(Schedule::new(Pace::new(Duration::from_secs(1)), 1, 1).shares(1, 16), 1);
        // Each invocation has the kernel's loops to itself: whole blocks, and with long searches more steps than where
        // it does all replicates.
        assert_eq!(schedule.stretch(2000, 16), BLOCK);
        assert_eq!(wide(64).stretch(2000, 16), 128);
        let all = Cut { rows: 2000, replicates: 16, steps: 128 };
        assert_eq!(wide(64).cut(all), all);
    }
}
