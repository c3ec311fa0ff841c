//! The law of sampling for an environment: its draws follow its density.
//!
//! The cells are texels, or parts of them where few send light. Where directions lie and how large cells are
//! comes from the host's own geometry in f64, the density from the shader in f64, the draws from the device.

mod kernels;

pub use kernels::Draws;

use std::sync::Arc;

use brdf_sdk::Result;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::chi_square::{ChiSquare, chi_square};
use super::integrals::gauss;
use super::sampling::{AGAIN, MASS};
use super::survey::DRAWS;
use super::verdict::{LEVEL, Law, Outcome, Verdict};
use crate::environment::{Environment, Filter, Purpose, Weighting};
use crate::exec::Executor;
use crate::measure::student::sidak;
use kernels::{CHUNK, Densities};

/// About as many cells as a map is cut into whose texels are fewer.
const CELLS: usize = 1 << 14;
/// No texel is cut finer, so that the roundings of directions are small beside a cell.
const FINEST: usize = 64;
/// Cells next to each other are joined until they expect this many draws.
const LEAST: f64 = 20.0;
/// Large cells, of many texels each.
const BLOCKS: usize = 1 << 10;
/// A direction in f32 may lie this far beside its texel [radians].
const BESIDE: f64 = 2e-6;

/// The tables that are held to the law: each filter, plain and compensated.
const PURPOSES: [Purpose; 4] = [
    of(Filter::Nearest, false),
    of(Filter::Nearest, true),
    of(Filter::Linear, false),
    of(Filter::Linear, true),
];

const fn of(filter: Filter, compensated: bool) -> Purpose {
    Purpose { filter, compensated, weighting: Weighting::Luminance }
}

/// Holds a map's sampler to the law, for both filters, and for tables with and without compensation; `world_from_map` turns the map.
pub fn light(
    executor: &mut dyn Executor,
    map: &Arc<Environment>,
    world_from_map: DMat3,
) -> Result<Vec<(Purpose, Verdict)>> {
    let proofs = PURPOSES.into_iter().map(|purpose| {
        let proof = Proof::new(map, world_from_map, purpose)?;
        let verdict = proof.judge(executor, sidak(LEVEL, 2.0 * PURPOSES.len() as f64))?;
        Ok((purpose, verdict))
    });
    proofs.collect()
}

/// What the density says of each cell.
struct Proof {
    map: Arc<Environment>,
    world_from_map: DMat3,
    purpose: Purpose,
    /// For each texel, the number of its first cell; `DARK` where nothing is drawn.
    first: Vec<u32>,
    /// Cells along each side of a texel.
    cut: usize,
    /// The probability of each cell.
    expected: Vec<f64>,
    /// The block of texels that each cell lies in.
    block: Vec<u32>,
}

const DARK: u32 = u32::MAX;

impl Proof {
    fn new(map: &Arc<Environment>, world_from_map: DMat3, purpose: Purpose) -> Result<Self> {
        let mut densities = Densities::new(map, world_from_map, purpose)?;
        let columns = map.width as usize;
        let texels: Vec<(u32, u32)> = (0..columns * map.height as usize)
            .map(|i| ((i % columns) as u32, (i / columns) as u32))
            .collect();
        let centres: Vec<_> = texels.iter().map(|texel| (*texel, [0.5; 2])).collect();
        let centres = densities.at(map, &centres)?;

        let lit = centres.iter().filter(|pdf| **pdf > 0.0).count();
        let cut = (CELLS as f64 / lit.max(1) as f64).sqrt().ceil() as usize;
        let cut = cut.clamp(1, FINEST);
        let side = (texels.len() as f64 / BLOCKS as f64).sqrt().ceil() as u32;
        let across = map.width.div_ceil(side);
        let (mut first, mut block, mut cells) = (Vec::new(), Vec::new(), Vec::new());
        for (texel, pdf) in texels.iter().zip(&centres) {
            first.push(if *pdf > 0.0 { cells.len() as u32 } else { DARK });
            if *pdf > 0.0 {
                let parts = cut * cut;
                let of = texel.1 / side * across + texel.0 / side;
                block.extend(std::iter::repeat_n(of, parts));
                cells.extend((0..parts).map(|i| (*texel, [i % cut, i / cut])));
            }
        }
        let expected = integrate(&mut densities, map, &cells, cut)?;
        let map = Arc::clone(map);
        Ok(Self { map, world_from_map, purpose, first, cut, expected, block })
    }

    fn judge(&self, executor: &mut dyn Executor, level: f64) -> Result<Verdict> {
        let failed = |said: String| Verdict::new(Law::Sampling, Outcome::Failed, said);
        let tally = self.tally(executor, 1, DRAWS)?;
        let integral: f64 = self.expected.iter().sum();
        if self.expected.is_empty() {
            let drawn = tally.draws - tally.no_sample;
            return Ok(match drawn {
                0 => Verdict::new(Law::Sampling, Outcome::Skipped, "the map is black"),
                n => failed(format!(
                    "{n} of {} draws have a density and the map is black",
                    tally.draws
                )),
            });
        }
        if tally.no_sample > 0 {
            return Ok(failed(format!(
                "{} of {} draws have no density",
                tally.no_sample, tally.draws
            )));
        }
        if let Some(dir) = tally.outside {
            let said = format!(
                "{} of {} draws lie where the density is 0 or are not finite",
                tally.outside_count, tally.draws
            );
            return Ok(failed(said).shown_by(format!("direction {dir:?}")));
        }
        if (integral - 1.0).abs() > MASS {
            return Ok(failed(format!("the density integrates to {integral:.6}")));
        }
        let tests = self.tests(&tally);
        let worst = if tests[0].p < tests[1].p { tests[0] } else { tests[1] };
        let of = |found: &ChiSquare| {
            let cells = found.freedom + 1.0;
            format!("chi-square {:.0} over {cells} cells (p = {:.1e})", found.statistic, found.p)
        };
        let mut verdict = Verdict::new(Law::Sampling, Outcome::Passed, "");
        if worst.p < level {
            let again = self.tests(&self.tally(executor, 2, AGAIN)?);
            if again.iter().zip(&tests).any(|(again, first)| again.p < level && first.p < level) {
                verdict = failed(of(&worst));
            } else {
                verdict.notes.push(format!("p = {:.1e}, not again in {AGAIN} draws", worst.p));
            }
        }
        if verdict.outcome == Outcome::Passed {
            let texels = self.expected.len() / (self.cut * self.cut);
            verdict.said = format!("draws of {texels} texels follow their density; {}", of(&worst));
        }
        Ok(verdict.with(worst.p, level, 2))
    }

    /// Over the cells, neighbours joined that expect little, and over blocks of texels.
    fn tests(&self, tally: &Tally) -> [ChiSquare; 2] {
        let expected: Vec<f64> = self.expected.iter().map(|p| p * tally.draws as f64).collect();
        let blocks = self.block.iter().max().map_or(0, |last| *last as usize + 1);
        let (mut counted, mut wanted) = (vec![0; blocks], vec![0.0; blocks]);
        let (mut counts, mut fine) = (vec![0], vec![0.0]);
        for (cell, block) in self.block.iter().enumerate() {
            counted[*block as usize] += tally.counts[cell];
            wanted[*block as usize] += expected[cell];
            if fine.last().is_some_and(|sum| *sum >= LEAST) {
                counts.push(0);
                fine.push(0.0);
            }
            if let (Some(count), Some(sum)) = (counts.last_mut(), fine.last_mut()) {
                *count += tally.counts[cell];
                *sum += expected[cell];
            }
        }
        [chi_square(&counts, &fine), chi_square(&counted, &wanted)]
    }

    fn tally(&self, executor: &mut dyn Executor, seed: u32, draws: usize) -> Result<Tally> {
        let mut kernel = Draws::new(executor, &self.map, self.world_from_map, self.purpose)?;
        let mut tally = Tally::new(self.expected.len());
        for first in (0..draws).step_by(CHUNK) {
            let drawn = kernel.draw(executor, seed, first, CHUNK.min(draws - first))?;
            let found: Vec<Drawn> =
                drawn.par_iter().map(|(dir, pdf)| self.drawn(*dir, *pdf)).collect();
            drawn.iter().zip(found).for_each(|((dir, _), drawn)| tally.take(*dir, drawn));
        }
        kernel.free(executor);
        Ok(tally)
    }

    /// The cell that a draw lies in, or beside.
    fn drawn(&self, dir: [f64; 3], pdf: f64) -> Drawn {
        if pdf == 0.0 {
            return Drawn::NoSample;
        }
        if !dir.iter().chain([&pdf]).all(|value| value.is_finite()) {
            return Drawn::Outside;
        }
        let d = self.world_from_map.transpose() * DVec3::from_array(dir);
        if let Some(cell) = self.cell(d) {
            return Drawn::In(cell);
        }
        // Rounded over an edge: a neighbour that is as near as that has it.
        let (x, y) = d.any_orthonormal_pair();
        let around = (0..8).map(|i| std::f64::consts::FRAC_PI_4 * f64::from(i));
        let near = around.map(|turn| d + BESIDE * (turn.cos() * x + turn.sin() * y));
        near.into_iter().find_map(|d| self.cell(d)).map_or(Drawn::Outside, Drawn::In)
    }

    fn cell(&self, direction: DVec3) -> Option<usize> {
        let ((column, row), at) = self.map.place_of(direction);
        let first = self.first[row as usize * self.map.width as usize + column as usize];
        let part = |at: f64| ((at * self.cut as f64) as usize).min(self.cut - 1);
        (first != DARK).then(|| first as usize + part(at[1]) * self.cut + part(at[0]))
    }
}

/// The integral of the density over each cell, a texel's part in column and row, by Gauss's rule of 3 x 3
/// points: within a texel only the solid angle varies.
fn integrate(
    densities: &mut Densities,
    map: &Environment,
    cells: &[((u32, u32), [usize; 2])],
    cut: usize,
) -> Result<Vec<f64>> {
    let rule = gauss(3);
    let nodes: Vec<_> = rule.iter().flat_map(|a| rule.iter().map(move |b| (*a, *b))).collect();
    let at = |low: usize, x: f64| (low as f64 + 0.5 + 0.5 * x) / cut as f64;
    let area = 0.25 / (cut * cut) as f64;
    let mut expected = Vec::with_capacity(cells.len());
    for part in cells.chunks(CHUNK / nodes.len()) {
        let places: Vec<_> = part
            .iter()
            .flat_map(|(texel, low)| {
                nodes.iter().map(|(x, y)| (*texel, [at(low[0], x[0]), at(low[1], y[0])]))
            })
            .collect();
        let pdf = densities.at(map, &places)?;
        let terms = places.chunks(nodes.len()).zip(pdf.chunks(nodes.len()));
        expected.extend(terms.map(|(places, pdf)| {
            let terms = places.iter().zip(pdf).zip(&nodes);
            let terms = terms.map(|(((texel, at), pdf), (x, y))| {
                x[1] * y[1] * area * pdf * map.solid_angle_at(*texel, *at)
            });
            terms.sum::<f64>()
        }));
    }
    Ok(expected)
}

#[derive(Clone, Copy)]
enum Drawn {
    In(usize),
    Outside,
    NoSample,
}

/// What became of many draws.
struct Tally {
    draws: u64,
    counts: Vec<u64>,
    /// Draws whose own density is 0.
    no_sample: u64,
    /// The first draw outside of all cells.
    outside: Option<[f64; 3]>,
    outside_count: u64,
}

impl Tally {
    fn new(cells: usize) -> Self {
        Self { draws: 0, counts: vec![0; cells], no_sample: 0, outside: None, outside_count: 0 }
    }

    fn take(&mut self, dir: [f64; 3], drawn: Drawn) {
        self.draws += 1;
        match drawn {
            Drawn::In(cell) => self.counts[cell] += 1,
            Drawn::NoSample => self.no_sample += 1,
            Drawn::Outside => {
                self.outside_count += 1;
                self.outside.get_or_insert(dir);
            }
        }
    }
}
