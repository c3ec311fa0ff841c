//! The executor on wgpu: a device that lives on its own thread, behind calls that time out.
//!
//! A driver that hangs takes its thread with it: the call returns a problem, the thread and its
//! device are left behind, and the caller may open a fresh one. Only this folder names wgpu.

mod adapters;
mod clock;
mod device;
mod layout;
mod lists;

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};

pub use adapters::{AdapterFacts, interfaces, list};
use device::Device;
pub use lists::Lists;

use super::{Bound, Executor, KernelId, Limits, Readout, ResourceId};
use crate::link::{BindingKind, Program};

/// The longest that any call may take; the dispatches themselves are kept below a tenth of a second.
const PATIENCE: Duration = Duration::from_secs(60);

/// Drivers recurse along expressions as the shader compiler does.
const STACK: usize = 256 << 20;

type Task = Box<dyn FnOnce(&mut Device) + Send>;

/// A wgpu device.
pub struct Gpu {
    name: String,
    limits: Limits,
    /// `None` once the device was given up.
    tasks: Option<Sender<Task>>,
    thread: Option<JoinHandle<()>>,
    next: u64,
    /// What is worth telling and was not told yet.
    notes: BTreeSet<String>,
}

impl Gpu {
    /// Opens the adapter that `choice` names by index or a part of its name, or the preferred one.
    pub fn open(choice: Option<&str>) -> Result<Self> {
        Self::open_with(choice, None)
    }

    /// As [`Gpu::open`]; lists lie where they are told to, and without that where the device reads them best.
    pub fn open_with(choice: Option<&str>, lists: Option<Lists>) -> Result<Self> {
        let (tasks, queue) = channel::<Task>();
        let (opened, opening) = channel();
        let choice = choice.map(str::to_owned);
        let builder = std::thread::Builder::new().name("device".into()).stack_size(STACK);
        let thread =
            builder.spawn(move || serve(choice.as_deref(), lists, &opened, &queue)).map_err(
                |error| Problem::new("the device", error.to_string(), "free memory and try again"),
            )?;
        let (name, limits) =
            opening.recv_timeout(PATIENCE).unwrap_or_else(|_| Err(unresponsive()))?;
        Ok(Self {
            name,
            limits,
            tasks: Some(tasks),
            thread: Some(thread),
            next: 0,
            notes: BTreeSet::new(),
        })
    }

    /// Loses the device, as a driver that crashes does: every later call is a problem. For tests.
    pub fn lose(&mut self) -> Result<()> {
        self.ask(|device| {
            device.destroy();
            Ok(())
        })
    }

    /// Runs a task on the device's thread and waits for its answer.
    fn ask<T: Send + 'static>(
        &mut self,
        task: impl FnOnce(&mut Device) -> Result<T> + Send + 'static,
    ) -> Result<T> {
        let Some(tasks) = &self.tasks else { return Err(given_up()) };
        let (answer, answered) = channel();
        let sent = tasks.send(Box::new(move |device| {
            let result = task(device);
            // Nobody listens once the caller has timed out.
            let _ = answer.send(result);
        }));
        let result = match sent {
            Ok(()) => answered.recv_timeout(PATIENCE),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        };
        match result {
            Ok(result) => result,
            Err(error) => {
                self.tasks = None;
                Err(if error == RecvTimeoutError::Timeout { unresponsive() } else { given_up() })
            }
        }
    }

    fn new_id(&mut self) -> u64 {
        self.next += 1;
        self.next
    }
}

impl Drop for Gpu {
    /// Waits until the device is gone: a program that ends while a driver still cleans up can crash.
    /// A device that was given up is not waited for.
    fn drop(&mut self) {
        const LEAVE: Duration = Duration::from_secs(5);
        let alive = self.tasks.take().is_some();
        let Some(thread) = self.thread.take().filter(|_| alive) else { return };
        let start = Instant::now();
        while !thread.is_finished() && start.elapsed() < LEAVE {
            std::thread::sleep(Duration::from_millis(1));
        }
        if thread.is_finished() {
            // A panic on the device's thread has already shown itself as a lost device.
            let _ = thread.join();
        }
    }
}

fn serve(
    choice: Option<&str>,
    lists: Option<Lists>,
    opened: &Sender<Result<(String, Limits)>>,
    queue: &Receiver<Task>,
) {
    let mut device = match Device::open(choice, lists) {
        Ok(device) => device,
        Err(problem) => {
            let _ = opened.send(Err(problem));
            return;
        }
    };
    let _ = opened.send(Ok((device.name(), device.limits())));
    while let Ok(task) = queue.recv() {
        task(&mut device);
        if device.is_hung() {
            leave_behind(device);
            return;
        }
        if device.is_lost() {
            return;
        }
    }
}

/// Dropping a device that hangs can block for ever. One that was only slow, as on a machine with too much to do, gives
/// its memory back once it is through with its work: a thread waits for that, and nobody for the thread.
fn leave_behind(device: Device) {
    let waiting = std::thread::Builder::new().name("device given up".into());
    let spawned = waiting.spawn(move || match device.comes_to_its_end() {
        true => drop(device),
        false => std::mem::forget(device),
    });
    // Without a thread the device went with the closure, and whoever dropped it waits: no worse than ending here.
    drop(spawned);
}

fn unresponsive() -> Problem {
    Problem::new(
        "the device",
        format!("it did not answer within {} s", PATIENCE.as_secs()),
        "look for an endless loop in the plugin's last change, or choose another `--device`",
    )
}

fn given_up() -> Problem {
    Problem::new("the device", "it was lost or given up after an earlier error", "open it again")
}

impl Executor for Gpu {
    fn name(&self) -> &str {
        &self.name
    }

    fn is_gone(&self) -> bool {
        self.tasks.is_none() || self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    fn wants_trial(&self) -> bool {
        true
    }

    fn limits(&self) -> Limits {
        self.limits
    }

    fn compile(&mut self, program: Arc<Program>) -> Result<KernelId> {
        let id = KernelId(self.new_id());
        self.ask(move |device| device.compile(id, &program))?;
        Ok(id)
    }

    fn buffer(&mut self, kind: BindingKind, bytes: usize) -> Result<ResourceId> {
        let id = ResourceId(self.new_id());
        self.ask(move |device| device.buffer(id, kind, bytes as u64))?;
        Ok(id)
    }

    fn texture(&mut self, size: [u32; 2], texels: Arc<Vec<[f32; 4]>>) -> Result<ResourceId> {
        let id = ResourceId(self.new_id());
        self.ask(move |device| device.texture(id, BindingKind::Texture, size, &texels))?;
        Ok(id)
    }

    fn list(
        &mut self,
        kind: BindingKind,
        size: [u32; 2],
        texels: Arc<Vec<[f32; 4]>>,
    ) -> Result<ResourceId> {
        let id = ResourceId(self.new_id());
        self.ask(move |device| device.list(id, kind, size, &texels))?;
        Ok(id)
    }

    fn words(&mut self, kind: BindingKind, words: Arc<[u32]>) -> Result<ResourceId> {
        let id = self.buffer(kind, words.len() * 4)?;
        let written = self.ask(move |device| device.write(id, bytemuck::cast_slice(&words)));
        match written {
            Ok(()) => Ok(id),
            Err(problem) => {
                self.free(id);
                Err(problem)
            }
        }
    }

    fn write(&mut self, buffer: ResourceId, bytes: Vec<u8>) -> Result<()> {
        self.ask(move |device| device.write(buffer, &bytes))
    }

    fn dispatch(
        &mut self,
        kernel: KernelId,
        bound: &[Bound<'_>],
        invocations: u32,
    ) -> Result<Duration> {
        let bound: Vec<(String, ResourceId)> =
            bound.iter().map(|(name, id)| ((*name).to_owned(), *id)).collect();
        self.ask(move |device| device.dispatch(kernel, &bound, invocations))
    }

    fn read(&mut self, buffer: ResourceId, bytes: usize) -> Result<Readout> {
        let words = self.ask(move |device| device.read(buffer, bytes as u64))?;
        Ok(Readout::new(words))
    }

    fn device_seconds(&mut self) -> Option<f64> {
        self.ask(Device::seconds).ok().flatten()
    }

    fn note(&mut self, note: String) {
        self.notes.insert(note);
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes).into_iter().collect()
    }

    fn free(&mut self, resource: ResourceId) {
        if let Some(tasks) = &self.tasks {
            let _ = tasks.send(Box::new(move |device| device.free(resource)));
        }
    }

    fn forget(&mut self, kernel: KernelId) {
        if let Some(tasks) = &self.tasks {
            let _ = tasks.send(Box::new(move |device| device.forget(kernel)));
        }
    }
}
