//! A second thread, for questions that plots ask: it runs them on the cores, one after the other, and of each asker
//! only the newest.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use brdf_sdk::{Problem, Result};

use super::{Wake, fresh_number, lock};
use crate::exec::{Executor, Precision, cpu::Cpu};

/// A job, and what it calls before it begins its work.
type Job = Box<dyn FnOnce(&mut dyn Executor, &dyn Fn()) + Send>;

/// The thread; it ends with the desk.
pub struct Desk {
    jobs: Sender<Job>,
    wake: Wake,
}

impl Desk {
    /// Starts it. `stand_back` is called before each job that is still wanted: it may wait until more
    /// urgent work is done.
    ///
    /// # Errors
    /// Where the system has no thread left.
    pub fn start(wake: Wake, stand_back: impl Fn() + Send + 'static) -> Result<Self> {
        let (jobs, received): (Sender<Job>, Receiver<Job>) = channel();
        let run = move || {
            let mut executor = Cpu::new(Precision::F32);
            while let Ok(job) = received.recv() {
                job(&mut executor, &stand_back);
            }
        };
        let spawned = std::thread::Builder::new().name("desk".to_owned()).spawn(run);
        spawned.map_err(|error| {
            Problem::new("the thread for plots", error.to_string(), "close other programs")
        })?;
        Ok(Self { jobs, wake })
    }
}

/// An answer.
pub struct Answered<A> {
    /// No other answer has it.
    pub number: u64,
    /// What was found.
    pub found: A,
}

impl<A> std::ops::Deref for Answered<A> {
    type Target = A;

    fn deref(&self) -> &A {
        &self.found
    }
}

/// The newest answer that is one, and what was wrong with a newer one.
type Found<A> = (Option<Arc<Answered<A>>>, Option<Problem>);

/// A question that changes, and the answer to the newest one that was answered.
pub struct Asked<Q, A> {
    question: Option<Q>,
    found: Arc<Mutex<Found<A>>>,
    /// Whether the job under way is still of use.
    wanted: Arc<AtomicBool>,
}

impl<Q, A> Default for Asked<Q, A> {
    fn default() -> Self {
        Self { question: None, found: Arc::default(), wanted: Arc::default() }
    }
}

impl<Q: PartialEq + Clone + Send + 'static, A: Send + Sync + 'static> Asked<Q, A> {
    /// Asks, where this was not the last question.
    pub fn ask(
        &mut self,
        desk: &Desk,
        question: &Q,
        work: impl FnOnce(&Q, &mut dyn Executor) -> Result<A> + Send + 'static,
    ) {
        if self.question.as_ref() == Some(question) {
            return;
        }
        self.question = Some(question.clone());
        self.wanted.store(false, Ordering::Release);
        self.wanted = Arc::new(AtomicBool::new(true));
        let (wanted, slot) = (Arc::clone(&self.wanted), Arc::clone(&self.found));
        let (question, wake) = (question.clone(), Arc::clone(&desk.wake));
        let job: Job = Box::new(move |executor, stand_back| {
            if !wanted.load(Ordering::Acquire) {
                return;
            }
            stand_back();
            let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                work(&question, executor)
            }));
            let made = caught.unwrap_or_else(|_| {
                Err(Problem::new("this view", "its computation failed", "report this"))
            });
            if wanted.swap(false, Ordering::AcqRel) {
                let mut slot = lock(&slot);
                match made {
                    Ok(found) => {
                        let number = fresh_number();
                        *slot = (Some(Arc::new(Answered { number, found })), None);
                    }
                    Err(problem) => slot.1 = Some(problem),
                }
                wake();
            }
        });
        // The thread ends after the desk, and catches what its jobs do.
        let _ = desk.jobs.send(job);
    }

    /// The answer to the newest question that has one.
    pub fn answer(&self) -> Option<Arc<Answered<A>>> {
        lock(&self.found).0.clone()
    }

    /// What is wrong with the newest question that was looked at.
    pub fn problem(&self) -> Option<Problem> {
        lock(&self.found).1.clone()
    }

    /// Whether the newest question is not answered yet.
    pub fn is_waiting(&self) -> bool {
        self.wanted.load(Ordering::Acquire)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn wait(asked: &Asked<u32, u32>) {
        let start = Instant::now();
        while asked.is_waiting() {
            assert!(start.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn found(asked: &Asked<u32, u32>) -> Option<u32> {
        asked.answer().map(|answer| answer.found)
    }

    #[test]
    fn the_newest_question_counts_and_the_last_answer_stays_where_one_fails() {
        let desk = Desk::start(Arc::new(|| ()), || ()).unwrap();
        let mut asked: Asked<u32, u32> = Asked::default();
        let runs = Arc::new(Mutex::new(Vec::new()));
        let slow = |runs: &Arc<Mutex<Vec<u32>>>| {
            let runs = Arc::clone(runs);
            move |question: &u32, _: &mut dyn Executor| {
                std::thread::sleep(Duration::from_millis(30));
                lock(&runs).push(*question);
                Ok(10 * question)
            }
        };
        for question in [1, 2, 3, 3] {
            asked.ask(&desk, &question, slow(&runs));
        }
        wait(&asked);
        assert_eq!(found(&asked), Some(30));
        // The first one may have begun before the second was asked; the second never did.
        assert!(!lock(&runs).contains(&2), "{:?}", lock(&runs));

        asked.ask(&desk, &4, |_, _| Err(Problem::new("4", "it fails", "ask 5")));
        wait(&asked);
        assert_eq!(found(&asked), Some(30));
        assert_eq!(asked.problem().unwrap().thing, "4");
        asked.ask(&desk, &5, |_, _| panic!("a fault"));
        wait(&asked);
        assert!(asked.problem().unwrap().reason.contains("failed"));
        asked.ask(&desk, &6, |question, _| Ok(*question));
        wait(&asked);
        assert_eq!((found(&asked), asked.problem()), (Some(6), None));
    }
}
