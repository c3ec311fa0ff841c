//! Integrals of a BRDF and its density over cells of directions, in f64, by adaptive quadrature.
//!
//! Two rules of Gauss are compared in each cell; where they differ by more than is wanted, its quarters
//! take its place. All cells of a level make one dispatch on the CPU executor.

use std::sync::Arc;

use brdf_sdk::Result;

use super::cell::{Cell, Chart};
use super::tree::{Part, Seen, Tree};
use crate::exec::Precision;
use crate::exec::cpu::Cpu;
use crate::link::{BindingKind, View, link};
use crate::plugin::Configured;
use crate::render::rows::Rows;

/// Integrals over solid angle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Integral {
    /// Of the density.
    pub pdf: f64,
    /// Of f cos, per channel: in sum the directional albedo.
    pub light: [f64; 3],
    /// Of (f cos)^2 / pdf: second moment of the weights.
    pub own: [f64; 3],
    /// The same for draws by the cosine.
    pub cosine: [f64; 3],
    /// The same for draws by solid angle.
    pub uniform: [f64; 3],
    /// Estimated error of `pdf`.
    pub pdf_error: f64,
    /// Estimated error of `light`, its largest channel.
    pub light_error: f64,
}

impl Integral {
    /// Adds another region.
    pub fn add(&mut self, other: &Integral) {
        let channels = |a: &mut [f64; 3], b: &[f64; 3]| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        };
        self.pdf += other.pdf;
        channels(&mut self.light, &other.light);
        channels(&mut self.own, &other.own);
        channels(&mut self.cosine, &other.cosine);
        channels(&mut self.uniform, &other.uniform);
        self.pdf_error += other.pdf_error;
        self.light_error += other.light_error;
    }

    fn is_finite(&self) -> bool {
        let all = self.light.iter().chain([&self.pdf]);
        all.into_iter().all(|value| value.is_finite())
    }
}

/// What is integrated: at a view over cells.
pub struct Task<'a> {
    /// To the viewer.
    pub wo: [f32; 3],
    /// The cells, with the ridges in them.
    pub tree: &'a Tree,
    /// Draws whose densities the rules have to see, as the tree lists them.
    pub draws: Vec<Seen>,
}

/// How exact a cell's integrals shall be.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    /// Of `pdf`, as a share of sqrt(pdf): a part of the deviation of a count.
    pub pdf_deviation: f64,
    /// Of `light`, as a part of a cell's value, and, shared by all cells, of the whole.
    pub light: f64,
}

/// The integrals of one task.
#[derive(Debug, Clone)]
pub struct Integrals {
    /// One for each cell.
    pub cells: Vec<Integral>,
    /// A cell where f or pdf are not finite.
    pub broken: Option<Cell>,
    /// Cells that did not reach the tolerance.
    pub unsettled: usize,
}

impl Integrals {
    /// Over all cells.
    pub fn total(&self) -> Integral {
        let mut total = Integral::default();
        self.cells.iter().for_each(|cell| total.add(cell));
        total
    }
}

/// Levels of quarters at the most, and cells of a level.
const LEVELS: usize = 22;
const MOST_CELLS: usize = 1 << 19;
/// Cells of one dispatch.
const CHUNK: usize = 1 << 15;

/// A BRDF's program of integrals.
pub struct Integrator {
    cpu: Cpu,
    rows: Rows,
    nodes: Vec<u8>,
}

/// What is known of a part.
#[derive(Clone, Default)]
struct Found {
    integral: Integral,
    unsettled: usize,
    broken: Option<Cell>,
}

/// A part of one of the tasks' cells.
#[derive(Clone, Copy)]
struct Region {
    task: usize,
    /// The part of the tree that it lies in.
    origin: usize,
    part: Part,
}

impl Integrator {
    /// Links the BRDF's program.
    pub fn new(brdf: &Configured) -> Result<Self> {
        let program = Arc::new(link(&View::Cells { brdf: brdf.clone() })?);
        let mut cpu = Cpu::new(Precision::F64);
        let rows = Rows::new(&mut cpu, program)?;
        let nodes = [8, 5].into_iter().flat_map(gauss).flat_map(|node| node.map(two_parts));
        let nodes = nodes.flatten().flat_map(f32::to_ne_bytes).collect();
        Ok(Self { cpu, rows, nodes })
    }

    /// Integrates, with the BRDF's numbers as they are now.
    pub fn integrate(
        &mut self,
        brdf: &Configured,
        mut tasks: Vec<Task<'_>>,
        tolerance: Tolerance,
    ) -> Result<Vec<Integrals>> {
        let mut results: Vec<Integrals> = tasks
            .iter()
            .map(|task| Integrals {
                cells: vec![Integral::default(); task.tree.leaves.len()],
                broken: None,
                unsettled: 0,
            })
            .collect();
        let mut parts: Vec<Vec<Found>> =
            tasks.iter().map(|task| vec![Found::default(); task.tree.parts.len()]).collect();
        let draws = tasks.iter_mut().map(|task| std::mem::take(&mut task.draws)).collect();
        self.refine(brdf, &tasks, draws, tolerance, &mut parts)?;
        for ((task, result), parts) in tasks.iter().zip(&mut results).zip(&parts) {
            for (part, found) in task.tree.parts.iter().zip(parts) {
                result.cells[part.leaf].add(&found.integral);
                result.unsettled += found.unsettled;
                result.broken = result.broken.or(found.broken);
            }
        }
        Ok(results)
    }

    /// Integrates the parts of the tasks, quarter by quarter.
    fn refine(
        &mut self,
        brdf: &Configured,
        tasks: &[Task<'_>],
        mut draws: Vec<Vec<Seen>>,
        tolerance: Tolerance,
        sums: &mut [Vec<Found>],
    ) -> Result<()> {
        let all = tasks.iter().enumerate().flat_map(|(task, one)| {
            let parts = one.tree.parts.iter().enumerate();
            parts.map(move |(origin, part)| Region { task, origin, part: *part })
        });
        let mut regions: Vec<Region> = all.collect();
        let largest = |values: &[f64; 3]| values.iter().fold(0.0f64, |a, b| a.max(*b));
        let mut wholes = Vec::new();
        for level in 0..LEVELS {
            let found = self.level(brdf, tasks, &regions)?;
            if level == 0 {
                wholes = vec![[0.0; 3]; tasks.len()];
                for (region, (integral, _)) in regions.iter().zip(&found) {
                    let whole: &mut [f64; 3] = &mut wholes[region.task];
                    whole.iter_mut().zip(integral.light).for_each(|(sum, part)| *sum += part);
                }
            }
            let last = level + 1 == LEVELS;
            let mut next = Vec::new();
            for (region, (integral, peak)) in regions.iter().zip(&found) {
                let part = region.part;
                let count = tasks[region.task].tree.leaves.len() as f64;
                let whole = largest(&wholes[region.task]);
                let draws = &mut draws[region.task][part.draws.0..part.draws.1];
                let settled = level >= part.ridge
                    && integral.pdf_error
                        <= tolerance.pdf_deviation * integral.pdf.max(1e-5).sqrt()
                    && integral.light_error
                        <= tolerance.light * (largest(&integral.light) + whole / count)
                    && (is_seen(draws, *peak) || part.cell.is_tiny());
                let sum = &mut sums[region.task][region.origin];
                if !integral.is_finite() {
                    sum.broken.get_or_insert(part.cell);
                } else if settled || last || next.len() + 4 > MOST_CELLS {
                    sum.unsettled += usize::from(!settled);
                    sum.integral.add(integral);
                } else {
                    let quarters = part.quarters(draws);
                    next.extend(quarters.map(|part| Region { part, ..*region }));
                }
            }
            if next.is_empty() {
                break;
            }
            regions = next;
        }
        Ok(())
    }

    fn level(
        &mut self,
        brdf: &Configured,
        tasks: &[Task<'_>],
        regions: &[Region],
    ) -> Result<Vec<(Integral, f64)>> {
        let input = self.rows.program().required_layout("cells");
        let output = self.rows.program().required_layout("integrals");
        let names =
            ["pdf", "light", "own", "cosine", "uniform", "pdf_error", "light_error", "peak"];
        let [pdf, light, own, cosine, uniform, pdf_error, light_error, peak] =
            names.map(|name| output.at(name));
        let mut found = Vec::with_capacity(regions.len());
        for chunk in regions.chunks(CHUNK) {
            let mut bytes = vec![0; input.stride * chunk.len()];
            for (index, Region { task, part, .. }) in chunk.iter().enumerate() {
                let base = index * input.stride;
                let wo = tasks[*task].wo;
                input.write(&mut bytes, base, "wo", &wo);
                input.write(&mut bytes, base, "wo_rest", &short_of_unit(wo));
                input.write(&mut bytes, base, "zero", &two_parts(Chart::of(wo).zero));
                input.write(&mut bytes, base, "low", &part.cell.low);
                input.write(&mut bytes, base, "high", &part.cell.high);
            }
            let inputs = [
                ("nodes", BindingKind::Read, self.nodes.clone()),
                ("cells", BindingKind::Read, bytes),
            ];
            let read = self.rows.run(&mut self.cpu, brdf, &inputs, "integrals", chunk.len())?;
            for row in (0..chunk.len()).map(|row| row * output.stride) {
                let three = |at: usize| [0, 4, 8].map(|offset| read.float(row + at + offset));
                let errors = three(light_error);
                let integral = Integral {
                    pdf: read.float(row + pdf),
                    light: three(light),
                    own: three(own),
                    cosine: three(cosine),
                    uniform: three(uniform),
                    pdf_error: read.float(row + pdf_error),
                    light_error: errors.iter().fold(0.0, |a, b| a.max(*b)),
                };
                found.push((integral, read.float(row + peak)));
            }
        }
        Ok(found)
    }
}

/// Whether a rule whose places met this largest density has seen what draws met: both rules may step over a
/// ridge, and agree that there is nothing. Where it is resolved they come nearer to its top than a quarter.
fn is_seen(draws: &[Seen], peak: f64) -> bool {
    let top = draws.iter().fold(0.0f32, |top, draw| top.max(draw.pdf));
    f64::from(top) <= 4.0 * peak
}

/// What a unit vector in f32 is short of one in f64.
fn short_of_unit(w: [f32; 3]) -> [f32; 3] {
    let wide = w.map(f64::from);
    let length = wide.iter().map(|c| c * c).sum::<f64>().sqrt();
    wide.map(|c| (c / length - c) as f32)
}

/// A number as the sum of two f32, with 48 bits.
fn two_parts(value: f64) -> [f32; 2] {
    let high = value as f32;
    [high, (value - f64::from(high)) as f32]
}

/// Places and weights of Gauss's rule of n points on [-1, 1], by Newton's method on Legendre polynomials.
pub(super) fn gauss(n: usize) -> Vec<[f64; 2]> {
    let node = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut p, mut before) = (1.0, 0.0);
            for k in 0..n {
                let k = k as f64;
                (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
            }
            slope = n as f64 * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        [x, 2.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rule of n points is exact for polynomials up to degree 2n - 1: the integral of x^k over
    /// [-1, 1] is 2 / (k + 1) for even k.
    #[test]
    fn the_rules_are_exact_for_polynomials() {
        for n in [5, 8] {
            for k in (0..2 * n).step_by(2) {
                let sum: f64 = gauss(n).iter().map(|[x, w]| w * x.powi(k as i32)).sum();
                assert!((sum - 2.0 / (k as f64 + 1.0)).abs() < 1e-14, "{n} {k} {sum}");
            }
        }
    }
}
