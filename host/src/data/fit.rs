//! A sampler for BRDFs that bring none: their values are looked at, and tables to draw by are made of them.
//!
//! The tables are those of native libraries (`brdf_sdk::native::lobes`), whose density is exact whatever they hold:
//! what they miss costs samples and no truth. They are made on the cores, in f32, anew for other values of the
//! parameters.

use std::sync::{Arc, Weak};

use brdf_sdk::manifest::Array;
use brdf_sdk::native::Loaded;
use brdf_sdk::native::directions::Vec3;
use brdf_sdk::native::lobes::{self, Grid};
use brdf_sdk::{Problem, Result};

use crate::exec::cpu::Cpu;
use crate::exec::{Executor, KernelId, Precision, ResourceId};
use crate::held::Held;
use crate::link::{BindingKind, Program, View, endless_loop, link};
use crate::native::{Packed, pack};
use crate::plugin::Configured;

/// Views and nodes of a BRDF that does not change as both directions turn about the normal, and of one that does.
const ISOTROPIC: Grid = Grid { theta_o: 32, phi_o: 1, theta_h: 64, phi_h: 17 };
const ANISOTROPIC: Grid = Grid { theta_o: 12, phi_o: 24, theta_h: 40, phi_h: 24 };

/// Where a BRDF is asked whether it changes as both directions turn, by which angles [rad], and from which mean
/// relative change on it counts.
const PROBES: Grid = Grid { theta_o: 6, phi_o: 1, theta_h: 24, phi_h: 7 };
const TURNS: [f64; 3] = [0.77, 1.54, 2.31];
const LEAST_CHANGE: f64 = 0.01;

/// The arrays of the BRDF's library, if it has one, and behind them the tables; from memory where nothing has changed
/// since they were made.
///
/// # Errors
/// What linking and running report, and loops without an end.
pub fn fitted(brdf: &Configured, own: Option<Arc<Packed>>) -> Result<Arc<Packed>> {
    let key = Key { brdf: brdf.clone(), own: own.as_ref().map(Arc::downgrade) };
    HELD.get(key, Key::is, |_| fit(brdf, own), |held| held.len() > MOST_HELD)
}

fn fit(brdf: &Configured, own: Option<Arc<Packed>>) -> Result<Arc<Packed>> {
    let id = &brdf.plugin.id;
    let mut values = Values::of(brdf)?;
    let grid = if values.turns()? { ANISOTROPIC } else { ISOTROPIC };
    let tables = lobes::tables_by(grid, |pairs| values.at(pairs))?;
    let declared: Vec<Array> = Array::of_lobes().collect();
    let mut packed = pack(id, &declared, Loaded::new(tables))?;
    if let Some(own) = own {
        packed = own.followed_by(id, &brdf.plugin.manifest.arrays, packed)?;
    }
    Ok(Arc::new(packed))
}

/// Recent ones: a slider that comes back, another view of the same numbers.
static HELD: Held<Key, Arc<Packed>> = Held::new();
const MOST_HELD: usize = 4;

/// What tables depend on. Arrays of a library are the same where they are one.
struct Key {
    brdf: Configured,
    own: Option<Weak<Packed>>,
}

impl Key {
    fn is(&self, other: &Self) -> bool {
        let same = match (&self.own, &other.own) {
            (Some(one), Some(other)) => one.ptr_eq(other),
            (None, None) => true,
            _ => false,
        };
        same && self.brdf == other.brdf
    }
}

/// A BRDF's `eval`, ready on the cores.
struct Values {
    brdf: Configured,
    program: Arc<Program>,
    kernel: KernelId,
    cores: Cpu,
    /// Its numbers and what it brings along, under the names of the program's variables.
    bound: Vec<(String, ResourceId)>,
}

impl Values {
    fn of(brdf: &Configured) -> Result<Self> {
        let brdf = Configured { fit_sampler: false, ..brdf.clone() };
        let program = Arc::new(link(&View::Eval { brdf: brdf.clone() })?);
        let mut cores = Cpu::new(Precision::F32);
        let kernel = cores.compile(Arc::clone(&program))?;
        let mut bound = Vec::new();
        if let Some((name, bytes)) = program.parameter_bytes(&brdf) {
            let buffer = cores.buffer(BindingKind::Uniform, bytes.len())?;
            cores.write(buffer, bytes)?;
            bound.push((name, buffer));
        }
        for brought in super::of(&program, &brdf)?.0 {
            bound.push((brought.name.clone(), brought.upload(&mut cores)?));
        }
        Ok(Self { brdf, program, kernel, cores, bound })
    }

    /// The root of the mean square of f's channels for each pair, since that is what noise comes from; 0 where it is
    /// no number.
    fn at(&mut self, pairs: &[[Vec3; 2]]) -> Result<Vec<f64>> {
        if pairs.is_empty() {
            return Ok(Vec::new());
        }
        let layout = self.program.required_layout("pairs");
        let mut bytes = vec![0; layout.stride * pairs.len()];
        let places = [layout.at("wo"), layout.at("wi")];
        for (row, pair) in bytes.chunks_exact_mut(layout.stride).zip(pairs) {
            for (place, direction) in places.into_iter().zip(pair) {
                let three = direction.map(|c| c as f32);
                row[place..place + 12].copy_from_slice(bytemuck::bytes_of(&three));
            }
        }
        let layout = self.program.required_layout("scattered");
        let inputs = self.cores.buffer(BindingKind::Read, bytes.len())?;
        self.cores.write(inputs, bytes)?;
        let size = layout.stride * pairs.len();
        let results = self.cores.buffer(BindingKind::ReadWrite, size)?;
        let mut bound: Vec<_> = self.bound.iter().map(|(name, id)| (name.as_str(), *id)).collect();
        bound.extend([("pairs", inputs), ("scattered", results)]);
        self.cores.dispatch(self.kernel, &bound, pairs.len() as u32)?;
        let read = self.cores.read(results, size)?;
        self.cores.free(inputs);
        self.cores.free(results);
        let (f, exhausted) = (layout.at("f"), layout.at("exhausted"));
        let value = |row: usize| {
            let at = row * layout.stride;
            if read.word(at + exhausted) != 0 {
                return Err(endless_loop(&self.brdf.plugin.id, "while a sampler was fitted to it"));
            }
            let squares = [0, 4, 8].map(|offset| read.float(at + f + offset).powi(2));
            let value = (squares.iter().sum::<f64>() / 3.0).sqrt();
            Ok(if value.is_finite() { value } else { 0.0 })
        };
        (0..pairs.len()).map(value).collect()
    }

    /// Whether values change as both directions turn about the normal: by their mean relative change, to which what
    /// rounding does at a lobe's edge adds little.
    fn turns(&mut self) -> Result<bool> {
        let (mut change, mut seen) = (0.0, 0);
        lobes::tables_by(PROBES, |pairs| {
            let before = self.at(pairs)?;
            for turn in TURNS {
                let [cos, sin] = [turn.cos(), turn.sin()];
                let turned = |[x, y, z]: Vec3| [cos * x - sin * y, sin * x + cos * y, z];
                let pairs: Vec<_> = pairs.iter().map(|pair| pair.map(turned)).collect();
                for (one, other) in before.iter().zip(self.at(&pairs)?) {
                    if one + other > 0.0 {
                        change += (one - other).abs() / (one + other);
                        seen += 1;
                    }
                }
            }
            Ok::<_, Problem>(vec![0.0; pairs.len()])
        })?;
        Ok(change > LEAST_CHANGE * f64::from(seen))
    }
}
