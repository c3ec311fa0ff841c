//! What a BRDF's `sample` did at one view, beside what its `pdf` and `eval` say of it: the numbers that the
//! laws of sampling, mean and variance judge.

use brdf_sdk::Result;

use super::cell::Chart;
use super::draws::{Draw, Drawer, Tally};
use super::integrals::{Integrals, Integrator, Task, Tolerance};
use super::settings::{Setting, direction};
use super::tree::{Seen, Tree};
use crate::exec::Executor;
use crate::plugin::Configured;

/// Draws of one test.
pub const DRAWS: usize = 1_000_000;
/// Draws that the cells follow; of another seed than those that are counted.
const PILOT: usize = 1 << 16;
/// Draws whose densities the integrals have to see.
const GUIDES: usize = 1 << 18;
/// Halvings to a cell: 4,096 cells.
const DEPTH: usize = 12;
/// How many times each cell is quartered at the least, where a failure is looked at again.
const FINER: usize = 3;
const PILOT_SEED: u32 = 0x9e37_79b9;

/// One view.
pub struct Survey {
    /// The number of the setting.
    pub setting: usize,
    /// Angles of `wo` from the normal and the tangent [degrees].
    pub view: [f64; 2],
    /// To the viewer.
    pub wo: [f32; 3],
    /// The cells.
    pub tree: Tree,
    /// What is expected in them.
    pub integrals: Integrals,
    /// What was drawn.
    pub tally: Tally,
}

/// A BRDF's programs of draws and integrals; for one choice of its constants.
pub struct Surveyor {
    drawer: Drawer,
    integrator: Integrator,
    of: Configured,
}

impl Surveyor {
    /// Links the programs.
    pub fn new(executor: &mut dyn Executor, brdf: &Configured) -> Result<Self> {
        let integrator = Integrator::new(brdf)?;
        Ok(Self { drawer: Drawer::new(executor, brdf)?, integrator, of: brdf.clone() })
    }

    /// The one for a BRDF: what is held already where its constants are the same.
    pub fn at<'a>(
        executor: &mut dyn Executor,
        held: &'a mut Option<Self>,
        brdf: &Configured,
    ) -> Result<&'a mut Self> {
        let surveyor = match held.take() {
            Some(surveyor) if surveyor.of.constants() == brdf.constants() => surveyor,
            other => {
                if let Some(other) = other {
                    other.free(executor);
                }
                Self::new(executor, brdf)?
            }
        };
        Ok(held.insert(surveyor))
    }

    /// Some draws at a view, and the direction that a large part of them has in common.
    pub fn look(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        view: [f64; 2],
        count: usize,
    ) -> Result<(Vec<Draw>, Option<Draw>)> {
        let draws = self.drawer.draws(executor, brdf, direction(view), PILOT_SEED, count)?;
        let dirac = dirac(&draws);
        Ok((draws, dirac))
    }

    /// Draws and integrates at one view.
    pub fn survey(
        &mut self,
        executor: &mut dyn Executor,
        setting: (usize, &Setting),
        view: [f64; 2],
        seed: u32,
    ) -> Result<Survey> {
        let (setting, Setting { brdf, .. }) = setting;
        let wo = direction(view);
        let (tree, draws) = self.cells(executor, brdf, wo, [PILOT, GUIDES], DEPTH)?;
        let tasks = vec![Task { wo, tree: &tree, draws }];
        let integrals = self.integrator.integrate(brdf, tasks, tolerance(DRAWS))?.remove(0);
        let tally = self.drawer.tally(executor, brdf, wo, seed, DRAWS, &tree)?;
        Ok(Survey { setting, view, wo, tree, integrals, tally })
    }

    /// The same view in the same cells, with other numbers and more of them; integrated more finely, since a density
    /// with steps can make two rules agree on what is wrong.
    pub fn again(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        survey: &Survey,
        seed: u32,
        draws: usize,
    ) -> Result<Survey> {
        let Survey { setting, view, wo, .. } = *survey;
        let (mut tree, seen) = self.cells(executor, brdf, wo, [PILOT, GUIDES], DEPTH)?;
        for part in &mut tree.parts {
            part.ridge = part.ridge.max(FINER);
        }
        let tasks = vec![Task { wo, tree: &tree, draws: seen }];
        let integrals = self.integrator.integrate(brdf, tasks, tolerance(draws))?.remove(0);
        let tally = self.drawer.tally(executor, brdf, wo, seed, draws, &tree)?;
        Ok(Survey { setting, view, wo, tree, integrals, tally })
    }

    /// The directional albedo at each view.
    pub fn albedos(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        views: &[[f32; 3]],
        tolerance: f64,
    ) -> Result<Vec<Integrals>> {
        const PILOT: usize = 1 << 14;
        const DEPTH: usize = 9;
        let trees = views.iter().map(|wo| self.cells(executor, brdf, *wo, [PILOT; 2], DEPTH));
        let trees: Vec<(Tree, Vec<Seen>)> = trees.collect::<Result<_>>()?;
        let (trees, draws): (Vec<Tree>, Vec<_>) = trees.into_iter().unzip();
        let tasks = views.iter().zip(&trees).zip(draws);
        let tasks = tasks.map(|((wo, tree), draws)| Task { wo: *wo, tree, draws });
        let tasks: Vec<Task<'_>> = tasks.collect();
        let tolerance = Tolerance { pdf_deviation: f64::INFINITY, light: tolerance };
        self.integrator.integrate(brdf, tasks, tolerance)
    }

    /// Cells that follow the BRDF's draws and the places where lobes may be; and draws, part by part.
    fn cells(
        &mut self,
        executor: &mut dyn Executor,
        brdf: &Configured,
        wo: [f32; 3],
        [pilot, guides]: [usize; 2],
        depth: usize,
    ) -> Result<(Tree, Vec<Seen>)> {
        let draws = self.drawer.draws(executor, brdf, wo, PILOT_SEED, guides)?;
        let above = draws.iter().filter(|d| d.wi[2] > 0.0 && d.wi.iter().all(|c| c.is_finite()));
        let chart = Chart::of(wo);
        let seen = |draw: &Draw| Seen {
            at: chart.angles(draw.wi).map(|angle| angle as f32),
            pdf: draw.pdf,
        };
        let seen: Vec<Seen> = above.map(seen).collect();
        let mut points: Vec<[f32; 2]> = seen.iter().take(pilot).map(|seen| seen.at).collect();
        let hints = hints(wo, pilot / 16).into_iter();
        points.extend(hints.map(|w| chart.angles(w).map(|a| a as f32)));
        let mut tree = Tree::grow(&mut points, depth, wo[2]);
        let seen = tree.put(&seen);
        Ok((tree, seen))
    }

    /// Frees what it holds on the device.
    pub fn free(self, executor: &mut dyn Executor) {
        self.drawer.free(executor);
    }
}

/// A twentieth of the deviation of what so many draws count.
fn tolerance(draws: usize) -> Tolerance {
    Tolerance { pdf_deviation: 0.05 / (draws as f64).sqrt(), light: 2e-5 }
}

/// Directions where lobes may be that `sample` does not know of: rings about the mirror direction and
/// about `wo`, ever closer, and some everywhere.
fn hints(wo: [f32; 3], count: usize) -> Vec<[f32; 3]> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let wo = wo.map(f64::from);
    let centres = [wo, [-wo[0], -wo[1], wo[2]]];
    let mut found = Vec::new();
    for index in 0..count {
        let part = (index as f64 + 0.5) / count as f64;
        let turn = std::f64::consts::TAU * GOLDEN * index as f64;
        // Everywhere by the cosine.
        let radius = part.sqrt();
        found.push([radius * turn.cos(), radius * turn.sin(), (1.0 - part).sqrt()]);
        let angle = 10f64.powf(-5.0 * part);
        let centre = centres[index % 2];
        let r = centre[0].hypot(centre[1]);
        let (cosine, sine) = if r > 0.0 { (centre[0] / r, centre[1] / r) } else { (1.0, 0.0) };
        let down = [centre[2] * cosine, centre[2] * sine, -r];
        let along = [-sine, cosine, 0.0];
        found.push([0, 1, 2].map(|i| {
            angle.cos() * centre[i] + angle.sin() * (turn.cos() * down[i] + turn.sin() * along[i])
        }));
    }
    found.into_iter().filter(|w| w[2] > 0.0).map(|w| w.map(|c| c as f32)).collect()
}

/// A direction that more than a tenth of the draws have in common.
fn dirac(draws: &[Draw]) -> Option<Draw> {
    let mut sorted: Vec<&Draw> = draws.iter().filter(|draw| draw.counts()).collect();
    let bits = |draw: &Draw| draw.wi.map(f32::to_bits);
    sorted.sort_unstable_by_key(|draw| bits(draw));
    let runs = sorted.chunk_by(|a, b| bits(a) == bits(b));
    let longest = runs.max_by_key(|run| run.len())?;
    (longest.len() * 10 > draws.len()).then(|| *longest[0])
}
