//! What happens on the device's own thread. Every wgpu error becomes a problem; none panics.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use brdf_sdk::{Problem, Result};

use super::super::memory;
use super::adapters;
use super::clock::Clock;
use super::layout::{layout_entry, texture_format};
use super::lists::Lists;
use crate::exec::{KernelId, Limits, ResourceId, unbound};
use crate::link::{BindingKind, Program};

/// How long one dispatch may take before the device counts as hung: its compiler runs in the first.
const DISPATCH_PATIENCE: Duration = Duration::from_secs(45);

/// Some rounds of the lanes that the largest devices keep in flight (270,000 on an H100): no device tells their number,
/// and the last round is not full.
const PARALLEL: u32 = 1 << 21;

/// A wgpu device with all that was made on it.
pub(super) struct Device {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    lists: Lists,
    budget: u64,
    used: u64,
    errors: Arc<Mutex<Option<String>>>,
    /// Set once the device is lost; it never comes back.
    lost: Arc<Mutex<Option<String>>>,
    kernels: HashMap<KernelId, Kernel>,
    resources: HashMap<ResourceId, Resource>,
    staging: Option<wgpu::Buffer>,
    clock: Option<Clock>,
    hung: bool,
}

struct Kernel {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    program: Arc<Program>,
}

enum Resource {
    Buffer(wgpu::Buffer),
    Texture { view: wgpu::TextureView, texture: wgpu::Texture, bytes: u64 },
}

impl Device {
    pub(super) fn open(choice: Option<&str>, lists: Option<Lists>) -> Result<Self> {
        let adapter = adapters::choose(choice)?;
        let info = adapter.get_info();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("brdf"),
            // The adapter's own limits, not wgpu's defaults: those stop at 8,192 texels and 128 MiB.
            required_limits: adapter.limits(),
            required_features: adapter.features() & Clock::FEATURE,
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
                Problem::new(
                    &info.name,
                    format!("the device cannot be opened ({error})"),
                    "choose another `--device`",
                )
            })?;
        let errors = Arc::new(Mutex::new(None));
        let sink = Arc::clone(&errors);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            note(&sink, error.to_string());
        }));
        let lost = Arc::new(Mutex::new(None));
        let sink = Arc::clone(&lost);
        device.set_device_lost_callback(move |_, message| note(&sink, message));
        // Software devices take their memory from the machine, and grant what it does not have.
        let budget = match info.device_type {
            wgpu::DeviceType::Cpu | wgpu::DeviceType::IntegratedGpu => memory::budget(),
            _ => u64::MAX,
        };
        let clock = Clock::new(&device, &queue);
        Ok(Self {
            lists: lists.unwrap_or_else(|| Lists::best(&info, &device.limits())),
            clock,
            device,
            queue,
            info,
            budget,
            used: 0,
            errors,
            lost,
            kernels: HashMap::new(),
            resources: HashMap::new(),
            staging: None,
            hung: false,
        })
    }

    pub(super) fn name(&self) -> String {
        format!("{} ({} {})", self.info.name, self.info.backend, self.info.driver_info)
    }

    pub(super) fn limits(&self) -> Limits {
        let limits = self.device.limits();
        Limits {
            buffer_bytes: limits.max_storage_buffer_binding_size.min(limits.max_buffer_size),
            total_bytes: self.budget,
            parallel: match self.info.device_type {
                wgpu::DeviceType::Cpu => 1,
                _ => PARALLEL,
            },
        }
    }

    pub(super) fn destroy(&self) {
        self.device.destroy();
        // The loss is told while polling; there is nothing to wait for.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    pub(super) fn is_lost(&self) -> bool {
        self.lost.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    pub(super) fn is_hung(&self) -> bool {
        self.hung
    }

    pub(super) fn compile(&mut self, id: KernelId, program: &Arc<Program>) -> Result<()> {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Naga(Cow::Owned(self.lists.module_of(program)?)),
        });
        let entries: Vec<_> = program
            .bindings
            .iter()
            .map(|binding| layout_entry(binding.index, self.lists.kind_of(program, binding)))
            .collect();
        let layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        });
        let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        self.check("compiling the program", "choose another `--device`")?;
        let program = Arc::clone(program);
        self.kernels.insert(id, Kernel { pipeline, layout, program });
        Ok(())
    }

    pub(super) fn buffer(&mut self, id: ResourceId, kind: BindingKind, bytes: u64) -> Result<()> {
        let bytes = bytes.max(4).next_multiple_of(4);
        let limit = self.limits().buffer_bytes;
        if bytes > limit {
            return Err(Problem::new(
                "the device",
                format!(
                    "a buffer of {} exceeds its limit of {}",
                    memory::shown(bytes),
                    memory::shown(limit)
                ),
                "lower --resolution or choose another `--device`",
            ));
        }
        self.reserve(bytes)?;
        let role = match kind {
            BindingKind::Uniform => wgpu::BufferUsages::UNIFORM,
            _ => wgpu::BufferUsages::STORAGE,
        };
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: role | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        self.resources.insert(id, Resource::Buffer(buffer));
        self.check_allocation(id)
    }

    pub(super) fn texture(
        &mut self,
        id: ResourceId,
        kind: BindingKind,
        size: [u32; 2],
        texels: &[[f32; 4]],
    ) -> Result<()> {
        let limit = self.device.limits().max_texture_dimension_2d;
        if size.iter().any(|side| *side > limit) {
            return Err(Problem::new(
                "the environment",
                format!("{}x{} texels exceed the device's {limit} a side", size[0], size[1]),
                "scale the map down or choose another `--device`",
            ));
        }
        let bytes = size_of_val(texels) as u64;
        self.reserve(bytes)?;
        let extent = wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: texture_format(kind),
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size[0] * 16),
            rows_per_image: Some(size[1]),
        };
        self.queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(texels),
            layout,
            extent,
        );
        self.resources.insert(id, Resource::Texture { view, texture, bytes });
        self.check_allocation(id)
    }

    pub(super) fn list(
        &mut self,
        id: ResourceId,
        kind: BindingKind,
        size: [u32; 2],
        texels: &[[f32; 4]],
    ) -> Result<()> {
        match self.lists {
            Lists::Textures => self.texture(id, kind, size, texels),
            Lists::Buffers => {
                self.buffer(id, BindingKind::Read, size_of_val(texels) as u64)?;
                let written = self.write(id, bytemuck::cast_slice(texels));
                if written.is_err() {
                    self.free(id);
                }
                written
            }
        }
    }

    pub(super) fn write(&mut self, id: ResourceId, bytes: &[u8]) -> Result<()> {
        if let Some(Resource::Buffer(buffer)) = self.resources.get(&id) {
            self.queue.write_buffer(buffer, 0, bytes);
        }
        self.check("writing to the device", "free memory or choose another `--device`")
    }

    pub(super) fn dispatch(
        &mut self,
        kernel: KernelId,
        bound: &[(String, ResourceId)],
        invocations: u32,
    ) -> Result<Duration> {
        if self.clock.as_ref().is_some_and(Clock::is_full) {
            self.read_clock()?;
        }
        let missing =
            || Problem::new("the device", "a kernel or a resource is gone", "start again");
        let kernel = self.kernels.get(&kernel).ok_or_else(missing)?;
        let mut entries = Vec::new();
        for binding in &kernel.program.bindings {
            let (_, id) = bound
                .iter()
                .find(|(name, _)| *name == binding.name)
                .ok_or_else(|| unbound(&binding.name))?;
            let resource = match self.resources.get(id).ok_or_else(missing)? {
                Resource::Buffer(buffer) => buffer.as_entire_binding(),
                Resource::Texture { view, .. } => wgpu::BindingResource::TextureView(view),
            };
            entries.push(wgpu::BindGroupEntry { binding: binding.index, resource });
        }
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &kernel.layout,
            entries: &entries,
        });
        let start = Instant::now();
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: self.clock.as_mut().map(Clock::mark),
            });
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &group, &[]);
            let [x, y, z] = kernel.program.groups(invocations);
            pass.dispatch_workgroups(x, y, z);
        }
        let submission = self.queue.submit([encoder.finish()]);
        self.wait(submission)?;
        Ok(start.elapsed())
    }

    /// Seconds that dispatches took by the device's own clock, since it was opened; none without one.
    pub(super) fn seconds(&mut self) -> Result<Option<f64>> {
        self.read_clock()?;
        Ok(self.clock.as_ref().map(Clock::seconds))
    }

    fn read_clock(&mut self) -> Result<()> {
        let fetched = self.clock.as_ref().and_then(|clock| clock.fetch(&self.device, &self.queue));
        let Some(submission) = fetched else { return Ok(()) };
        let waited = self.wait(submission);
        // Marks that cannot be read are passed over: the next ones begin anew in any case.
        self.clock.iter_mut().for_each(Clock::read);
        waited
    }

    pub(super) fn read(&mut self, id: ResourceId, bytes: u64) -> Result<Vec<u32>> {
        let Some(Resource::Buffer(buffer)) = self.resources.get(&id) else {
            return Err(Problem::new("the device", "a buffer is gone", "start again"));
        };
        let staging = match self.staging.take().filter(|staging| staging.size() >= bytes) {
            Some(staging) => staging,
            None => self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        };
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes);
        let submission = self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, 0..bytes, |_| {});
        self.wait(submission)?;
        let copied =
            staging.get_mapped_range(0..bytes).map(|view| bytemuck::pod_collect_to_vec(&view[..]));
        staging.unmap();
        self.staging = Some(staging);
        copied.map_err(|error| {
            Problem::new(
                "the device",
                format!("its results cannot be read ({error})"),
                "choose another `--device`",
            )
        })
    }

    pub(super) fn free(&mut self, id: ResourceId) {
        match self.resources.remove(&id) {
            Some(Resource::Buffer(buffer)) => {
                self.used = self.used.saturating_sub(buffer.size());
                buffer.destroy();
            }
            Some(Resource::Texture { texture, bytes, .. }) => {
                self.used = self.used.saturating_sub(bytes);
                texture.destroy();
            }
            None => {}
        }
    }

    pub(super) fn forget(&mut self, kernel: KernelId) {
        self.kernels.remove(&kernel);
    }

    /// Waits, for ever if need be, until all that was submitted is done; false where the device is lost instead.
    pub(super) fn comes_to_its_end(&self) -> bool {
        self.device.poll(wgpu::PollType::wait_indefinitely()).is_ok()
    }

    fn wait(&mut self, submission: wgpu::SubmissionIndex) -> Result<()> {
        let polled = self.device.poll(wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: Some(DISPATCH_PATIENCE),
        });
        if let Err(wgpu::PollError::Timeout) = polled {
            self.hung = true;
            return Err(Problem::new(
                &self.info.name,
                format!("a dispatch did not end within {} s", DISPATCH_PATIENCE.as_secs()),
                "look for an endless loop in the plugin's last change, or choose another `--device`",
            ));
        }
        self.check("running the program", "choose another `--device`")
    }

    fn reserve(&mut self, bytes: u64) -> Result<()> {
        let wanted = self.used.saturating_add(bytes);
        if wanted > self.budget {
            return Err(Problem::new(
                &self.info.name,
                format!(
                    "{} are needed and {} may be used",
                    memory::shown(wanted),
                    memory::shown(self.budget)
                ),
                "lower --resolution, use a smaller map, or choose another `--device`",
            ));
        }
        self.used = wanted;
        Ok(())
    }

    /// wgpu reports a failed allocation late: nothing is used before this has passed.
    fn check_allocation(&mut self, id: ResourceId) -> Result<()> {
        let checked =
            self.check("allocating memory", "lower --resolution or choose another `--device`");
        if checked.is_err() {
            self.free(id);
        }
        checked
    }

    fn check(&self, doing: &str, cure: &str) -> Result<()> {
        if let Some(message) = self.lost.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            return Err(Problem::new(
                &self.info.name,
                format!("the device was lost ({})", message.trim()),
                "start again, or choose another `--device`",
            ));
        }
        let error = self.errors.lock().unwrap_or_else(PoisonError::into_inner).take();
        match error {
            None => Ok(()),
            Some(error) => {
                let first = error.split('\n').map(str::trim).collect::<Vec<_>>().join(" ");
                Err(Problem::new(&self.info.name, format!("{doing} failed: {first}"), cure))
            }
        }
    }
}

/// Keeps the first error: later ones only follow from it.
fn note(errors: &Mutex<Option<String>>, error: String) {
    errors.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
}
