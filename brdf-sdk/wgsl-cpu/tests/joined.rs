//! Instructions that become one: what they give is what they gave apart.

#![allow(clippy::unwrap_used, reason = "a test expects by unwrapping")]

mod common;

use common::{How, lower, parse, run_with, ways, words};
use wgsl_cpu::{Precision, Program};

const COUNT: u32 = 300;

/// A product in a sum, on either side, with uniform operands and without; a number in a word beside others, at every
/// end of it, as a word and as a float; a word that is turned, that is only shifted twice, and that is read again.
#[test]
fn joined_instructions_give_the_same_bits() {
    let text = format!(
        "@group(0) @binding(0) var<storage, read> input: array<u32>;
         @group(0) @binding(1) var<storage, read_write> output: array<u32>;
         fn as_float(n: u32) -> f32 {{ return f32(n & 0xffffu) * 0.01 - 300.0; }}
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             if id.x >= {COUNT}u {{ return; }}
             let n = input[id.x];
             let k = input[0];
             let x = as_float(n);
             let y = as_float(n * 7u + 3u);
             let z = as_float(n * 31u + 11u);
             let u = as_float(k);
             // The same in all lanes, and new in each round.
             var w = y;
             for (var i = 0u; i < 3u; i++) {{ w = f32(i) * f32(i) + w; }}
             var found = array<u32, 19>(
                 bitcast<u32>(x * y + z), bitcast<u32>(z + x * y), bitcast<u32>(x * y - z), bitcast<u32>(z - x * y),
                 bitcast<u32>(x * 0.7 + z), bitcast<u32>(0.7 * x - 0.3), bitcast<u32>(0.3 - x * y), bitcast<u32>(u * x + u),
                 bitcast<u32>(u * u + x), (n >> 9u) & 511u, bitcast<u32>(f32((n >> 18u) & 511u)), bitcast<u32>(f32(n & 7u)),
                 bitcast<u32>(f32(n >> 29u)), (n << 1u) | (n >> 31u), (n >> 20u) | (n << 12u), (n << 3u) | (n >> 30u),
                 bitcast<u32>(f32((n >> (k & 3u)) & 15u)), (0xff00u & (n >> 3u)) + ((n >> 3u) & 0xffu),
                 bitcast<u32>(w),
             );
             for (var i = 0u; i < 19u; i++) {{ output[id.x * 19u + i] = found[i]; }}
         }}"
    );
    let input: Vec<u32> = (0..COUNT).map(|i| i.wrapping_mul(2_654_435_769) ^ 5).collect();
    let number = |n: u32| (n & 0xffff) as f32 * 0.01 - 300.0;
    let wanted: Vec<u32> = input
        .iter()
        .flat_map(|n| {
            let (n, k) = (*n, input[0]);
            let [x, y, z, u] =
                [n, n.wrapping_mul(7).wrapping_add(3), n.wrapping_mul(31).wrapping_add(11), k]
                    .map(number);
            let floats = [
                x * y + z,
                z + x * y,
                x * y - z,
                z - x * y,
                x * 0.7 + z,
                0.7 * x - 0.3,
                0.3 - x * y,
            ];
            let more = [u * x + u, u * u + x].map(f32::to_bits);
            let fields = [
                n >> 9 & 511,
                ((n >> 18 & 511) as f32).to_bits(),
                ((n & 7) as f32).to_bits(),
                ((n >> 29) as f32).to_bits(),
                n.rotate_left(1),
                n.rotate_left(12),
                n << 3 | n >> 30,
                ((n >> (k & 3) & 15) as f32).to_bits(),
                (0xff00 & n >> 3) + (n >> 3 & 0xff),
                (2.0 * 2.0 + (1.0 + y)).to_bits(),
            ];
            floats.map(f32::to_bits).into_iter().chain(more).chain(fields).collect::<Vec<_>>()
        })
        .collect();
    let joined = lower(&text).unwrap();
    let (module, info) = parse(&text);
    let apart = Program::for_errors(&module, &info).unwrap();
    let all = ways(Precision::F32).into_iter().map(|how| (&joined, how));
    for (program, how) in all.chain([(&apart, How::default())]) {
        let storage = run_with(program, &input, wanted.len(), COUNT.div_ceil(64), how).unwrap();
        let found = words(&storage);
        let at = found.iter().zip(&wanted).position(|(a, b)| a != b);
        assert_eq!(at.map(|at| (at / 19, at % 19)), None, "{how:?}");
    }
}
