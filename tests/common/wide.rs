//! An executor that says it has many lanes: its programs are cut as on a large graphics card.

use std::sync::Arc;
use std::time::Duration;

use brdf_host::exec::{Bound, Executor, KernelId, Limits, Readout, ResourceId};
use brdf_host::link::{BindingKind, Program};
use brdf_sdk::Result;

/// Another executor, whose lanes it makes more of.
pub struct Wide<E>(pub E);

impl<E: Executor> Executor for Wide<E> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn is_gone(&self) -> bool {
        self.0.is_gone()
    }
    fn wants_trial(&self) -> bool {
        self.0.wants_trial()
    }
    fn limits(&self) -> Limits {
        Limits { parallel: 1 << 20, ..self.0.limits() }
    }
    fn compile(&mut self, program: Arc<Program>) -> Result<KernelId> {
        self.0.compile(program)
    }
    fn buffer(&mut self, kind: BindingKind, bytes: usize) -> Result<ResourceId> {
        self.0.buffer(kind, bytes)
    }
    fn texture(&mut self, size: [u32; 2], texels: Arc<Vec<[f32; 4]>>) -> Result<ResourceId> {
        self.0.texture(size, texels)
    }
    fn words(&mut self, kind: BindingKind, words: Arc<[u32]>) -> Result<ResourceId> {
        self.0.words(kind, words)
    }
    fn write(&mut self, buffer: ResourceId, bytes: Vec<u8>) -> Result<()> {
        self.0.write(buffer, bytes)
    }
    fn dispatch(
        &mut self,
        kernel: KernelId,
        bound: &[Bound<'_>],
        invocations: u32,
    ) -> Result<Duration> {
        self.0.dispatch(kernel, bound, invocations)
    }
    fn read(&mut self, buffer: ResourceId, bytes: usize) -> Result<Readout> {
        self.0.read(buffer, bytes)
    }
    fn device_seconds(&mut self) -> Option<f64> {
        self.0.device_seconds()
    }
    fn note(&mut self, note: String) {
        self.0.note(note);
    }
    fn take_notes(&mut self) -> Vec<String> {
        self.0.take_notes()
    }
    fn free(&mut self, resource: ResourceId) {
        self.0.free(resource);
    }
    fn forget(&mut self, kernel: KernelId) {
        self.0.forget(kernel);
    }
}
