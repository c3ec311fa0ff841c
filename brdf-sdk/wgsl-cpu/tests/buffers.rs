//! Words that all invocations share, and buffers of structs as WGSL lays them out.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

mod common;

use common::{How, binding, lower, run_with, ways, words};
use wgsl_cpu::{Precision, Program, Resource, Run, Storage};

const LANES: u32 = 1000;

fn kernel(ty: &str, body: &str) -> String {
    format!(
        "@group(0) @binding(0) var<storage, read> input: array<{ty}>;
         @group(0) @binding(1) var<storage, read_write> output: array<atomic<{ty}>>;
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             if id.x >= {LANES}u {{ return; }}
             let x = input[id.x];
             {body}
         }}"
    )
}

/// Whatever the order of the invocations, each of these has one result.
#[test]
fn atomics_meet_in_one_word() {
    let body = "if id.x % 7u == 3u { return; }
        atomicAdd(&output[0], x); atomicSub(&output[1], x); atomicXor(&output[2], x);
        atomicOr(&output[3], x & 0xff00); atomicMin(&output[4], x); atomicMax(&output[5], x);
        atomicAnd(&output[6], x | 0xf0f0f); atomicMax(&output[id.x + 99999u], x);
        atomicStore(&output[7], atomicLoad(&output[8]) + 5);";
    let input: Vec<u32> = (0..LANES).map(|i| i.wrapping_mul(2_654_435_761) ^ 77).collect();
    let here = |index: &u32| index % 7 != 3;
    let mine = || (0..LANES).filter(here).map(|index| input[index as usize]);
    let sum = mine().fold(0, u32::wrapping_add);
    for ty in ["u32", "i32"] {
        let program = lower(&kernel(ty, body)).unwrap();
        let signed = mine().map(|x| x as i32).chain([0]);
        let [least, most] = match ty {
            "i32" => [signed.clone().min().unwrap() as u32, signed.max().unwrap() as u32],
            _ => [0, mine().max().unwrap()],
        };
        let wanted = [
            sum,
            sum.wrapping_neg(),
            mine().fold(0, |a, b| a ^ b),
            mine().fold(0, |a, b| a | b & 0xff00),
            least,
            most,
            0,
            5,
            0,
            most,
        ];
        for how in ways(Precision::F32).into_iter().chain(ways(Precision::F64)) {
            let groups = LANES.div_ceil(64);
            let output = run_with(&program, &input, wanted.len(), groups, how).unwrap();
            assert_eq!(words(&output), wanted, "{ty}, {how:?}");
        }
    }
}

/// Each invocation gets a number of its own.
#[test]
fn an_atomic_gives_what_was_there_before() {
    let body = "let mine = atomicAdd(&output[0], 1u);
        atomicAdd(&output[1u + mine], x + 1u);
        let before = atomicExchange(&output[2000], id.x + 1u);
        atomicAdd(&output[1001], before);";
    let program = lower(&kernel("u32", body)).unwrap();
    let input: Vec<u32> = (0..LANES).map(|i| i * 3).collect();
    for how in ways(Precision::F32) {
        let output = words(&run_with(&program, &input, 2001, LANES.div_ceil(64), how).unwrap());
        assert_eq!(output[0], LANES);
        let mut taken = output[1..=LANES as usize].to_vec();
        taken.sort_unstable();
        assert!(taken.iter().eq((0..LANES).map(|i| i * 3 + 1).collect::<Vec<_>>().iter()));
        // Every number but the last one was there before another.
        assert_eq!(output[1001] + output[2000], LANES * (LANES + 1) / 2, "{how:?}");
    }
}

/// Offsets and strides are the host's too: vec3 aligns to 16 bytes, columns of three as well.
#[test]
fn structs_lie_where_the_language_says() {
    let text = "struct Inner { a: vec3f, b: f32, c: vec2u }
        struct Item { first: u32, inner: array<Inner, 2>, m: mat2x3f, last: i32 }
        @group(0) @binding(0) var<storage, read> input: array<Item>;
        @group(0) @binding(1) var<storage, read_write> output: array<Item>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            if id.x >= arrayLength(&output) { return; }
            var item = input[id.x];
            item.inner[item.first % 2u].c.y += 1u;
            item.m[1].z = -item.m[1].z;
            output[id.x] = item;
            output[id.x].last = item.last * 2;
        }";
    // Words: first 0; inner 4..20 of 8 each: a 0..3, b 3, c 4..6; m 20..28; last 28; 32 in all.
    let (size, count) = (32, 70);
    let used = [0..1, 4..10, 12..18, 20..23, 24..27, 28..29].into_iter().flatten();
    let used: Vec<usize> = used.collect();
    let input: Vec<u32> = (0..size * count).map(|i| (i as f32 * 1.5).to_bits()).collect();
    let program = lower(text).unwrap();
    let output = run_with(&program, &input, size * count, 2, How::default()).unwrap();
    let output = words(&output);
    for (item, (before, after)) in input.chunks(size).zip(output.chunks(size)).enumerate() {
        let mut wanted = vec![0; size];
        for word in &used {
            wanted[*word] = before[*word];
        }
        wanted[if before[0] % 2 == 0 { 9 } else { 17 }] += 1;
        wanted[26] ^= 0x8000_0000;
        wanted[28] = before[28].wrapping_mul(2);
        assert_eq!(after, wanted, "item {item}");
    }
}

/// A program in which each invocation has a number `n`, may look into `image`, and stores something to `output[id.x]`.
fn with_image(ty: &str, count: u32, body: &str) -> Program {
    let text = format!(
        "@group(0) @binding(0) var<storage, read> input: array<u32>;
         @group(0) @binding(1) var<storage, read_write> output: array<{ty}>;
         @group(0) @binding(2) var image: texture_2d<{ty}>;
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             if id.x >= {count}u {{ return; }}
             let n = input[id.x];
             {body}
         }}"
    );
    lower(&text).unwrap()
}

/// The words that it stores, an invocation for each number.
fn stored(
    program: &Program,
    size: [u32; 2],
    texels: &[[f32; 4]],
    input: &[u32],
    how: &How,
) -> Vec<u32> {
    let output = Storage::new(input.len(), how.precision == Precision::F64);
    let resources = [
        (binding(0), Resource::Words(input)),
        (binding(1), Resource::Storage(&output)),
        (binding(2), Resource::Texture { size, texels }),
    ];
    let (groups, fuel) = ([input.len().div_ceil(64) as u32, 1, 1], 1 << 30);
    let run = Run { resources: &resources, groups, fuel, set: how.set, lanes: how.lanes };
    program.run(how.precision, &run).unwrap();
    words(&output)
}

/// A texel comes by its place, and by its number in rows of four, in textures of that width and of others; places beyond
/// the sides are the nearest ones inside. All components, some or one; a batch with a number too large, and without.
#[test]
fn texels_come_by_their_place_and_by_their_number() {
    const COUNT: u32 = 700;
    let weights = [1.0f32, 100.0, 10_000.0, 1_000_000.0];
    let uses: [(&str, &[usize]); 4] = [
        ("dot(texel, vec4f(1.0, 100.0, 10000.0, 1000000.0))", &[0, 1, 2, 3]),
        ("texel.y * 100.0 + texel.w * 1000000.0", &[1, 3]),
        ("texel.x", &[0]),
        ("texel.w * 1000000.0", &[3]),
    ];
    for (width, height) in [(4u32, 7u32), (3, 7), (5, 2), (4, 1)] {
        let texel = |at: u32| [0, 1, 2, 3].map(|c| ((at * 7 + c) % 23) as f32);
        let texels: Vec<[f32; 4]> = (0..width * height).map(texel).collect();
        let small: Vec<u32> = (0..COUNT).map(|i| i * 5 % (width * height)).collect();
        let mut large = small.clone();
        (large[3], large[300], large[699]) = (28, 1000, u32::MAX);
        for (place, numbered) in
            [("vec2u(n & 3u, n >> 2u)", true), ("vec2u(n % 4u, n / 4u)", false)]
        {
            for (value, components) in uses {
                let body =
                    format!("let texel = textureLoad(image, {place}, 0);\noutput[id.x] = {value};");
                let program = with_image("f32", COUNT, &body);
                for input in [&small, &large] {
                    let wanted: Vec<f32> = input
                        .iter()
                        .map(|n| {
                            let at = (n / 4).min(height - 1) * width + (n % 4).min(width - 1);
                            components.iter().map(|c| weights[*c] * texel(at)[*c]).sum()
                        })
                        .collect();
                    for how in ways(Precision::F32).into_iter().chain(ways(Precision::F64)) {
                        let found = stored(&program, [width, height], &texels, input, &how);
                        let found: Vec<f32> = found.into_iter().map(f32::from_bits).collect();
                        let what = format!("{width}x{height}, {numbered}, {value}, {how:?}");
                        assert_eq!(found, wanted, "{what}");
                    }
                }
            }
        }
    }
}

/// Words of a texture of u32 are the bits that lie there, also where floats of them are no numbers, or are too small to
/// be kept; alone and all four at once, in either precision.
#[test]
fn words_of_texels_keep_their_bits() {
    const COUNT: u32 = 300;
    let nasty =
        [0u32, 1, 0x007f_ffff, 0x7f80_0001, 0x7fc0_0000, 0xff80_0001, 0x8000_0000, u32::MAX];
    let word = |at: u32, c: u32| nasty[((at * 3 + c) % 8) as usize] ^ (at << 9);
    let texels: Vec<[f32; 4]> =
        (0..28).map(|at| [0, 1, 2, 3].map(|c| f32::from_bits(word(at, c)))).collect();
    let input: Vec<u32> = (0..COUNT).map(|i| i * 5 % 28).collect();
    for (value, wanted) in [
        ("texel.y", &(|at: u32| word(at, 1)) as &dyn Fn(u32) -> u32),
        ("(texel.x ^ texel.y) + (texel.z >> 1u) * texel.w", &|at| {
            let [x, y, z, w] = [0, 1, 2, 3].map(|c| word(at, c));
            (x ^ y).wrapping_add((z >> 1).wrapping_mul(w))
        }),
    ] {
        let body = format!(
            "let texel = textureLoad(image, vec2u(n & 3u, n >> 2u), 0);\noutput[id.x] = {value};"
        );
        let program = with_image("u32", COUNT, &body);
        let wanted: Vec<u32> = input.iter().map(|at| wanted(*at)).collect();
        for how in ways(Precision::F32).into_iter().chain(ways(Precision::F64)) {
            let found = stored(&program, [4, 7], &texels, &input, &how);
            assert_eq!(found, wanted, "{value}, {how:?}");
        }
    }
}

/// Two branches that look up the same components: short ones run always, side by side, and each has its own.
#[test]
fn branches_that_fetch_the_same_each_have_it() {
    const COUNT: u32 = 300;
    let program = with_image(
        "f32",
        COUNT,
        "var sum = 0.0;
         if n % 2u == 0u { sum += textureLoad(image, vec2u(n & 3u, n >> 2u), 0).x; }
         if n % 3u == 0u { sum += 100.0 * textureLoad(image, vec2u(n & 3u, n >> 2u), 0).x; }
         output[id.x] = sum + 10000.0 * textureLoad(image, vec2u(n & 3u, n >> 2u), 0).y;",
    );
    let texels: Vec<[f32; 4]> =
        (0..28).map(|at| [1.0 + at as f32, 2.0 * at as f32, 0.0, 0.0]).collect();
    let input: Vec<u32> = (0..COUNT).map(|i| i * 5 % 28).collect();
    let wanted = input.iter().map(|n| {
        let [x, y, ..] = texels[*n as usize];
        let parts = f32::from(n % 2 == 0) + 100.0 * f32::from(n % 3 == 0);
        x * parts + 10_000.0 * y
    });
    let wanted: Vec<f32> = wanted.collect();
    for how in ways(Precision::F32) {
        let found = stored(&program, [4, 7], &texels, &input, &how);
        let found: Vec<f32> = found.into_iter().map(f32::from_bits).collect();
        assert_eq!(found, wanted, "{how:?}");
    }
}
