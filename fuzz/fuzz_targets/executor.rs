//! Numbers that decide what program is made: integer programs of up to five functions, on the CPU executor in every
//! vector set, for values and for errors, against their meaning one invocation at a time. The generator and the
//! meaning are those of wgsl-cpu's own tests, which draw the numbers by chance; here coverage leads them.
#![no_main]

#[path = "../../brdf-sdk/wgsl-cpu/tests/common/mod.rs"]
mod common;

use common::generate::{Tape, program};
use common::language::KNOBS;
use common::{binding, parse, words};
use libfuzzer_sys::fuzz_target;
use wgsl_cpu::{Precision, Program, Resource, Run, Storage, VectorSet};

/// Several batches, the last one not full.
const LANES: u32 = 200;

fuzz_target!(|data: &[u8]| {
    let numbers: Vec<u16> =
        data.as_chunks().0.iter().map(|bytes| u16::from_le_bytes(*bytes)).collect();
    let source = program(&mut Tape::new(&numbers));
    let text = source.text();
    let input: Vec<u32> = (0..LANES).map(|lane| lane * lane % 401).collect();
    let wanted: Option<Vec<u32>> = input.iter().map(|input| source.value(*input)).collect();
    // One that takes too long for a meaning has none here.
    let Some(wanted) = wanted else { return };
    let (module, info) = parse(&text);
    let values = Program::new(&module, &info).unwrap_or_else(|refusal| panic!("{refusal}\n{text}"));
    let errors =
        Program::for_errors(&module, &info).unwrap_or_else(|refusal| panic!("{refusal}\n{text}"));
    let runs = VectorSet::all().into_iter().map(|set| (&values, set, 64));
    for (program, set, lanes) in
        runs.chain([(&values, VectorSet::best(), 128), (&errors, VectorSet::best(), 64)])
    {
        let storage = Storage::new(input.len(), false);
        let resources = [
            (binding(0), Resource::Words(&input)),
            (binding(1), Resource::Storage(&storage)),
            (binding(2), Resource::Words(&KNOBS)),
        ];
        let groups = [LANES.div_ceil(64), 1, 1];
        let run = Run {
            resources: &resources,
            groups,
            fuel: 1 << 32,
            set: Some(set),
            lanes: Some(lanes),
        };
        program.run(Precision::F32, &run).unwrap_or_else(|failure| panic!("{failure}\n{text}"));
        assert_eq!(words(&storage), wanted, "{set:?}, {lanes} lanes\n{text}");
    }
});
