//! The device's own clock: how long dispatches took there, without the way to it and back.

use std::mem::size_of;

/// Dispatches whose times wait on the device to be read together.
const PAIRS: u32 = 64;

/// Bytes of the begin and the end of that many dispatches.
const BYTES: u64 = 2 * PAIRS as u64 * size_of::<u64>() as u64;

/// Adds up the time of dispatches.
pub(super) struct Clock {
    marks: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    /// Length of a tick [s].
    tick: f64,
    /// Dispatches that are marked and not read yet.
    waiting: u32,
    seconds: f64,
}

impl Clock {
    /// The feature that a device needs for it.
    pub(super) const FEATURE: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY;

    /// A clock at 0; none where the device has none.
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        if !device.features().contains(Self::FEATURE) {
            return None;
        }
        let marks = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Timestamp,
            count: 2 * PAIRS,
        });
        let buffer = |usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            marks,
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            staging: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
            tick: f64::from(queue.get_timestamp_period()) * 1e-9,
            waiting: 0,
            seconds: 0.0,
        })
    }

    /// Where the next dispatch marks its begin and its end.
    pub(super) fn mark(&mut self) -> wgpu::ComputePassTimestampWrites<'_> {
        let first = 2 * self.waiting;
        self.waiting += 1;
        wgpu::ComputePassTimestampWrites {
            query_set: &self.marks,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Whether no further dispatch can be marked before these are read.
    pub(super) fn is_full(&self) -> bool {
        self.waiting == PAIRS
    }

    /// Brings the marks to where they can be read; nothing where there are none. [`Clock::read`] takes them once that is done.
    pub(super) fn fetch(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Option<wgpu::SubmissionIndex> {
        if self.waiting == 0 {
            return None;
        }
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.resolve_query_set(&self.marks, 0..2 * self.waiting, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, BYTES);
        let submission = queue.submit([encoder.finish()]);
        self.staging.map_async(wgpu::MapMode::Read, .., |_| {});
        Some(submission)
    }

    /// Adds what was brought.
    pub(super) fn read(&mut self) {
        if let Ok(view) = self.staging.get_mapped_range(..) {
            let pairs = view.chunks_exact(2 * size_of::<u64>()).take(self.waiting as usize);
            self.seconds += pairs
                .map(|pair| {
                    let [begin, end]: [u64; 2] = bytemuck::pod_read_unaligned(pair);
                    end.saturating_sub(begin) as f64 * self.tick
                })
                .sum::<f64>();
        }
        self.staging.unmap();
        self.waiting = 0;
    }

    /// Seconds of all dispatches that were read.
    pub(super) fn seconds(&self) -> f64 {
        self.seconds
    }
}
