//! What the tests of this crate share: WGSL text in, words out.

#![allow(dead_code, reason = "each test target uses its own part of this")]

pub mod generate;
pub mod language;
pub mod meaning;

use naga::ResourceBinding;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgsl_cpu::{Failure, Precision, Program, Refusal, Resource, Run, Storage, VectorSet};

pub fn parse(text: &str) -> (naga::Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(text)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(text)));
    (module, info)
}

pub fn lower(text: &str) -> Result<Program, Refusal> {
    let (module, info) = parse(text);
    Program::new(&module, &info)
}

pub fn binding(binding: u32) -> ResourceBinding {
    ResourceBinding { group: 0, binding }
}

/// How to run: everything that must not change the results.
#[derive(Debug, Clone, Copy)]
pub struct How {
    pub precision: Precision,
    pub set: Option<VectorSet>,
    pub lanes: Option<usize>,
    pub fuel: u64,
}

impl Default for How {
    fn default() -> Self {
        Self { precision: Precision::F32, set: None, lanes: None, fuel: 1 << 40 }
    }
}

/// Runs `groups` workgroups; binding 0 is `input` (read), binding 1 `output` words (written), binding 2 the knobs of the
/// small language's programs, which no other has.
pub fn run_with(
    program: &Program,
    input: &[u32],
    output: usize,
    groups: u32,
    how: How,
) -> Result<Storage, Failure> {
    let storage = Storage::new(output, how.precision == Precision::F64);
    let resources = [
        (binding(0), Resource::Words(input)),
        (binding(1), Resource::Storage(&storage)),
        (binding(2), Resource::Words(&language::KNOBS)),
    ];
    let groups = [groups, 1, 1];
    let run = Run { resources: &resources, groups, fuel: how.fuel, set: how.set, lanes: how.lanes };
    program.run(how.precision, &run)?;
    Ok(storage)
}

/// Runs a program that knows its errors, as the test has it run; binding 0 is `input` (read), binding 1 a number for
/// each invocation (written).
pub fn with_errors<T>(
    text: &str,
    input: &[f32],
    run: impl FnOnce(&Program, &Run<'_>, &Storage) -> T,
) -> (T, Storage) {
    let (module, info) = parse(text);
    let program = Program::for_errors(&module, &info).unwrap();
    let words: Vec<u32> = input.iter().map(|value| value.to_bits()).collect();
    let storage = Storage::new(input.len(), true);
    let resources =
        [(binding(0), Resource::Words(&words)), (binding(1), Resource::Storage(&storage))];
    let groups = [input.len().div_ceil(64) as u32, 1, 1];
    let how = Run { resources: &resources, groups, fuel: 1 << 30, set: None, lanes: None };
    let found = run(&program, &how, &storage);
    (found, storage)
}

pub fn words(storage: &Storage) -> Vec<u32> {
    (0..storage.len()).map(|index| storage.word(index).unwrap()).collect()
}

/// All the ways to run that must agree bit for bit.
pub fn ways(precision: Precision) -> Vec<How> {
    let sets = VectorSet::all().into_iter().map(Some);
    sets.flat_map(|set| {
        [64, 128, 256, 512].map(|lanes| How {
            precision,
            set,
            lanes: Some(lanes),
            ..How::default()
        })
    })
    .collect()
}
