//! Draws of a BRDF on a device, counted by cells.

use std::sync::Arc;

use brdf_sdk::Result;
use rayon::prelude::*;

use super::cell::Chart;
use super::tree::Tree;
use crate::exec::{Executor, Readout};
use crate::link::{BindingKind, StructLayout, View, endless_loop, link};
use crate::plugin::Configured;
use crate::render::rows::Rows;

/// One draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// The point of [0, 1)^3 that it came of.
    pub u: [f32; 3],
    /// Its direction.
    pub wi: [f32; 3],
    /// Its density [1/sr]; 0 below the horizon.
    pub pdf: f32,
    /// f cos / pdf.
    pub weight: [f32; 3],
}

impl Draw {
    /// Whether it is above the horizon, and so a sample at all.
    pub fn counts(&self) -> bool {
        self.wi[2] > 0.0
    }

    fn is_finite(&self) -> bool {
        self.wi.iter().chain(&self.weight).chain([&self.pdf]).all(|value| value.is_finite())
    }

    /// How far its direction is from length 1.
    pub fn off_length(&self) -> f64 {
        (self.wi.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt() - 1.0).abs()
    }
}

/// Directions may be this far from length 1.
pub const LENGTH: f64 = 1e-4;
/// Draws of one dispatch.
const CHUNK: usize = 1 << 17;

/// What became of many draws.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// All draws.
    pub draws: u64,
    /// Draws in each cell.
    pub counts: Vec<u64>,
    /// Draws above the horizon.
    pub above: u64,
    /// Sums of the weights, per channel.
    pub weights: [f64; 3],
    /// A draw that is Inf or NaN, in direction, density or weight.
    pub nonfinite: Option<Draw>,
    /// A draw above the horizon where `pdf` is 0.
    pub without_pdf: Option<Draw>,
    /// How many of them there are.
    pub without_pdf_count: u64,
}

impl Tally {
    fn new(cells: usize) -> Self {
        Self { counts: vec![0; cells], ..Self::default() }
    }

    fn take(&mut self, tree: &Tree, chart: Chart, draw: Draw) {
        self.draws += 1;
        let without_pdf = draw.counts() && draw.pdf == 0.0;
        if without_pdf {
            self.without_pdf_count += 1;
            self.without_pdf.get_or_insert(draw);
        } else if !draw.is_finite() {
            self.nonfinite.get_or_insert(draw);
            return;
        }
        if !draw.counts() {
            return;
        }
        self.above += 1;
        if !without_pdf {
            self.weights.iter_mut().zip(draw.weight).for_each(|(sum, w)| *sum += f64::from(w));
        }
        self.counts[tree.find(chart.angles(draw.wi))] += 1;
    }

    fn merge(mut self, other: Self) -> Self {
        self.draws += other.draws;
        self.above += other.above;
        self.without_pdf_count += other.without_pdf_count;
        self.counts.iter_mut().zip(other.counts).for_each(|(a, b)| *a += b);
        self.weights.iter_mut().zip(other.weights).for_each(|(a, b)| *a += b);
        self.nonfinite = self.nonfinite.or(other.nonfinite);
        self.without_pdf = self.without_pdf.or(other.without_pdf);
        self
    }
}

/// A BRDF's program of draws on a device.
pub struct Drawer {
    rows: Rows,
    brdf: String,
}

impl Drawer {
    /// Links and compiles the BRDF's program.
    pub fn new(executor: &mut dyn Executor, brdf: &Configured) -> Result<Self> {
        let program = Arc::new(link(&View::Draws { brdf: brdf.clone() })?);
        Ok(Self { rows: Rows::new(executor, program)?, brdf: brdf.plugin.id.clone() })
    }

    /// Draws as such.
    pub fn draws(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        wo: [f32; 3],
        seed: u32,
        count: usize,
    ) -> Result<Vec<Draw>> {
        let (read, layout) = self.run(executor, brdf, wo, seed, 0, count)?;
        let rows = Rows32::new(&layout);
        Ok((0..count).map(|row| rows.draw(&read, row)).collect())
    }

    /// Draws, counted by the tree's cells.
    pub fn tally(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        wo: [f32; 3],
        seed: u32,
        count: usize,
        tree: &Tree,
    ) -> Result<Tally> {
        let mut tally = Tally::new(tree.leaves.len());
        let chart = Chart::of(wo);
        for first in (0..count).step_by(CHUNK) {
            let count = CHUNK.min(count - first);
            let (read, layout) = self.run(executor, brdf, wo, seed, first, count)?;
            let rows = Rows32::new(&layout);
            let found = (0..count)
                .into_par_iter()
                .with_min_len(1 << 13)
                .fold(
                    || Tally::new(tree.leaves.len()),
                    |mut tally, row| {
                        tally.take(tree, chart, rows.draw(&read, row));
                        tally
                    },
                )
                .collect::<Vec<_>>();
            // Put together in order, so that the first draw of a kind stays the first.
            tally = found.into_iter().fold(tally, Tally::merge);
        }
        Ok(tally)
    }

    fn run(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        wo: [f32; 3],
        seed: u32,
        first: usize,
        count: usize,
    ) -> Result<(Readout, StructLayout)> {
        let batch = self.rows.program().required_layout("batch");
        let mut bytes = vec![0; batch.stride];
        batch.write(&mut bytes, 0, "wo", &wo);
        batch.write(&mut bytes, 0, "seed", &[seed]);
        batch.write(&mut bytes, 0, "first", &[first as u32]);
        let inputs = [("batch", BindingKind::Uniform, bytes)];
        let read = self.rows.run(executor, brdf, &inputs, "draws", count)?;
        let layout = self.rows.program().required_layout("draws");
        let at = layout.at("exhausted");
        if (0..count).any(|row| read.word(row * layout.stride + at) != 0) {
            return Err(endless_loop(&self.brdf, "for one sample"));
        }
        Ok((read, layout))
    }

    /// Frees what it holds on the device.
    pub fn free(self, executor: &mut dyn Executor) {
        self.rows.free(executor);
    }
}

/// Where the members of a draw lie.
struct Rows32 {
    stride: usize,
    wi: usize,
    pdf: usize,
    weight: usize,
    u: usize,
}

impl Rows32 {
    fn new(layout: &StructLayout) -> Self {
        let [wi, pdf, weight, u] = ["wi", "pdf", "weight", "u"].map(|name| layout.at(name));
        Self { stride: layout.stride, wi, pdf, weight, u }
    }

    fn draw(&self, read: &Readout, row: usize) -> Draw {
        let float = |at: usize| f32::from_bits(read.word(row * self.stride + at));
        let three = |at: usize| [0, 4, 8].map(|offset| float(at + offset));
        Draw {
            u: three(self.u),
            wi: three(self.wi),
            pdf: float(self.pdf),
            weight: three(self.weight),
        }
    }
}
