//! A linked BRDF on the CPU executor, in all the ways that must give the same bits.

use std::f32::consts::TAU;

use brdf_host::link::Program;
use brdf_host::plugin::Configured;
use naga::ResourceBinding;
use wgsl_cpu::{Failure, Precision, Resource, Run, Storage, VectorSet};

/// Instructions that a batch may take in loops: more than any honest one, and a fraction of a second.
const FUEL: u64 = 1 << 21;
/// Rows: more than one batch, and the last one not full.
const ROWS: usize = 150;

/// Unit directions to the viewer and to the light, from the normal to grazing ones.
fn pairs() -> Vec<[[f32; 3]; 2]> {
    let direction = |index: usize| {
        let z = [1.0, 0.9, 0.5, 0.1, 1e-3, 1e-6][index % 6];
        let (sin, cos) = (TAU * (index as f32 * 0.618).fract()).sin_cos();
        let radius = (1.0_f32 - z * z).sqrt();
        [radius * cos, radius * sin, z]
    };
    (0..ROWS).map(|index| [direction(index), direction(index / 6 + index % 5)]).collect()
}

/// What stands behind the bindings of a program of `View::Eval`.
struct Bound {
    read: Vec<(u32, Vec<u32>)>,
    written: u32,
    words: usize,
}

/// None where it reads tables, which other programs fill.
fn bound(program: &Program, brdf: &Configured) -> Option<Bound> {
    let parameters = program.parameter_bytes(brdf);
    let layout = program.required_layout("pairs");
    let mut pairs = vec![0; layout.stride * ROWS];
    for (row, [wo, wi]) in self::pairs().into_iter().enumerate() {
        layout.write(&mut pairs, row * layout.stride, "wo", &wo);
        layout.write(&mut pairs, row * layout.stride, "wi", &wi);
    }
    let words =
        |bytes: &[u8]| bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let mut bound = Bound {
        read: Vec::new(),
        written: 0,
        words: program.required_layout("scattered").stride * ROWS / 4,
    };
    for binding in &program.bindings {
        match (binding.name.as_str(), &parameters) {
            ("scattered", _) => bound.written = binding.index,
            ("pairs", _) => bound.read.push((binding.index, words(&pairs))),
            (name, Some((known, bytes))) if name == known => {
                bound.read.push((binding.index, words(bytes)));
            }
            _ => return None,
        }
    }
    Some(bound)
}

impl Bound {
    /// The bits of all that is written; all NaN are one. None where a loop was stopped.
    fn run(
        &self,
        wide: bool,
        (set, lanes): (VectorSet, usize),
        how: impl Fn(&Run<'_>) -> Result<(), Failure>,
    ) -> Option<Vec<u64>> {
        let storage = Storage::new(self.words, wide);
        let binding = |binding: u32| ResourceBinding { group: 0, binding };
        let read = self.read.iter().map(|(index, words)| (binding(*index), Resource::Words(words)));
        let written = (binding(self.written), Resource::Storage(&storage));
        let resources: Vec<_> = read.chain([written]).collect();
        let groups = [(ROWS as u32).div_ceil(64), 1, 1];
        let run =
            Run { resources: &resources, groups, fuel: FUEL, set: Some(set), lanes: Some(lanes) };
        match how(&run) {
            Ok(()) => {}
            Err(Failure::Stopped(_)) => return None,
            Err(failure) => panic!("{failure}"),
        }
        let bits = |value: f64| if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() };
        Some(storage.floats(self.words).into_iter().map(bits).collect())
    }
}

/// Runs a program of `View::Eval` in each precision with every vector set and in batches of two sizes, and in f32 with
/// f64 at its side.
///
/// # Panics
/// Two of them differ, or the executor fails where it must not.
pub fn agree(program: &Program, brdf: &Configured) {
    let Some(bound) = bound(program, brdf) else { return };
    let types = program.types().unwrap_or_else(|problem| panic!("{problem}"));
    let lowered = wgsl_cpu::Program::new(&program.module, &types)
        .and_then(|values| Ok((values, wgsl_cpu::Program::for_errors(&program.module, &types)?)));
    let (values, errors) = match lowered {
        Ok(both) => both,
        Err(refusal) => return crate::refused(&program.refused(&refusal, refusal.span)),
    };
    let best = VectorSet::best();
    let ways =
        || VectorSet::all().into_iter().map(|set| (set, 64)).chain([(best, 128), (best, 256)]);
    for precision in [Precision::F32, Precision::F64] {
        let wide = precision == Precision::F64;
        let found: Vec<_> = ways()
            .filter_map(|way| Some((way, bound.run(wide, way, |run| values.run(precision, run))?)))
            .collect();
        for pair in found.windows(2) {
            differ(
                &format!("{precision:?} in {:?} and {:?}", pair[0].0, pair[1].0),
                &pair[0].1,
                &pair[1].1,
            );
        }
        if !wide
            && let Some((way, f32s)) = found.first()
            && let Some(shadowed) = bound.run(false, *way, |run| errors.errors(run).map(|_| ()))
        {
            differ("f32 alone and with f64 at its side", f32s, &shadowed);
        }
    }
}

fn differ(what: &str, a: &[u64], b: &[u64]) {
    if let Some(at) = a.iter().zip(b).position(|(a, b)| a != b) {
        let [a, b] = [a[at], b[at]].map(f64::from_bits);
        panic!("{what}: row {}, word {}: {a:e} and {b:e}", at / 8, at % 8);
    }
}
