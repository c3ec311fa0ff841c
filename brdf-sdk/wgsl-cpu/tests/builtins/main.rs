//! Every operator and builtin function against Rust's own: in f32, in f64, and in all ways to run.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

#[path = "../common/mod.rs"]
mod common;
mod floats;
mod words;

use common::{How, lower, run_with, ways};
use wgsl_cpu::{Precision, Program, Storage};

const LANES: usize = 1200;

const FLOATS: [f32; 30] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1.5,
    2.5,
    -2.5,
    3.0,
    1e-45,
    -1e-45,
    1e-39,
    1e-20,
    88.7,
    1e5,
    -1e9,
    12345.678,
    2147483600.0,
    2147483648.0,
    -2147483648.0,
    3e9,
    4294967296.0,
    1e30,
    f32::MIN_POSITIVE,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];
const INTEGERS: [u32; 18] = [
    0,
    1,
    2,
    3,
    7,
    8,
    31,
    32,
    33,
    127,
    128,
    255,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0x8000_0001,
    0xffff_ff80,
    0xffff_ffff,
];

/// What a case should give, from its arguments as numbers or as words.
enum Want {
    Float(fn(&[f64]) -> Vec<f64>),
    /// Beside the values the size of the largest number on the way to them.
    Scaled(fn(&[f64]) -> (Vec<f64>, f64)),
    Word(fn(&[u32]) -> Vec<u32>),
}

/// Text `let v = ... => outputs` on arguments a, b, c, ... whose kinds the letters of `args` name:
/// e any float, m one of moderate size, k a small multiple of 1/256, i, u integers.
struct Case {
    args: &'static str,
    text: &'static str,
    /// Units in the last place in f32 and f64; 0 asks for the sign of zero too.
    ulps: [f64; 2],
    want: Want,
}

fn exact(args: &'static str, text: &'static str, want: fn(&[f64]) -> Vec<f64>) -> Case {
    Case { args, text, ulps: [0.0; 2], want: Want::Float(want) }
}

/// Rounded once, but zero may have either sign.
fn rounded(args: &'static str, text: &'static str, want: fn(&[f64]) -> Vec<f64>) -> Case {
    Case { args, text, ulps: [0.51, 0.01], want: Want::Float(want) }
}

/// A transcendental function.
fn close(args: &'static str, text: &'static str, want: fn(&[f64]) -> Vec<f64>) -> Case {
    Case { args, text, ulps: [0.6, 4.0], want: Want::Float(want) }
}

fn scaled(args: &'static str, text: &'static str, want: fn(&[f64]) -> (Vec<f64>, f64)) -> Case {
    Case { args, text, ulps: [4.0, 4.0], want: Want::Scaled(want) }
}

fn word(args: &'static str, text: &'static str, want: fn(&[u32]) -> Vec<u32>) -> Case {
    Case { args, text, ulps: [0.0; 2], want: Want::Word(want) }
}

fn f(word: u32) -> f32 {
    f32::from_bits(word)
}

fn table() -> Vec<Case> {
    let mut all = floats::floats();
    all.extend(floats::vectors());
    all.extend(words::words());
    all
}

/// The arguments of all lanes.
fn input(args: &str) -> Vec<u32> {
    let mut seed = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 32) as u32
    };
    let mut one = |kind: u8| {
        let (choice, bits) = (random() % 4, random());
        let moderate = (bits as i32 as f32 / i32::MAX as f32 * 4.0).to_bits();
        match kind {
            b'e' if choice < 2 => FLOATS[bits as usize % FLOATS.len()].to_bits(),
            b'e' if choice == 2 => bits,
            b'e' | b'm' => moderate,
            b'k' => (((bits % 769) as f32 - 384.0) / 256.0).to_bits(),
            _ if choice < 2 => INTEGERS[bits as usize % INTEGERS.len()],
            _ if choice == 2 => bits,
            _ => bits % 40,
        }
    };
    (0..LANES).flat_map(|_| args.bytes().collect::<Vec<_>>()).map(&mut one).collect()
}

/// A kernel that evaluates a case for each lane, or (uniform) one lane for all of them in a loop.
fn kernel(case: &Case, uniform: bool) -> (String, usize) {
    let (prelude, outputs) = case.text.split_once(" => ").unwrap_or(("", case.text));
    let outputs: Vec<&str> = outputs.split("; ").collect();
    let (n, m) = (case.args.len(), outputs.len());
    let to_words = matches!(case.want, Want::Word(_));
    let mut body = String::new();
    for (index, kind) in case.args.bytes().enumerate() {
        let name = char::from(b'a' + index as u8);
        let ty = match kind {
            b'i' => "i32",
            b'u' => "u32",
            _ => "f32",
        };
        body += &format!("let {name} = bitcast<{ty}>(input[at * {n}u + {index}u]);\n");
    }
    body += &format!("{prelude};\n");
    for (index, output) in outputs.iter().enumerate() {
        let cast = if to_words { "bitcast<u32>" } else { "" };
        body += &format!("output[at * {m}u + {index}u] = {cast}({output});\n");
    }
    let ty = if to_words { "u32" } else { "f32" };
    let head = "@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {";
    let around = if uniform {
        format!("for (var at = 0u; at < {LANES}u; at++) {{ {body} }}")
    } else {
        format!("let at = id.x; if at >= {LANES}u {{ return; }} {body}")
    };
    let text = format!(
        "@group(0) @binding(0) var<storage, read> input: array<u32>;
         @group(0) @binding(1) var<storage, read_write> output: array<{ty}>;
         {head} {around} }}"
    );
    (text, m)
}

/// Whether `got` is near enough, in units in the last place of `scale` or of `want` itself.
fn near(got: f64, want: f64, scale: f64, ulps: f64, precision: Precision) -> bool {
    let single = precision == Precision::F32;
    let rounded = if single { f64::from(want as f32) } else { want };
    if got.is_nan() || rounded.is_nan() {
        return got.is_nan() == rounded.is_nan() || scale == f64::INFINITY;
    }
    if got == rounded {
        return ulps != 0.0 || got.is_sign_negative() == want.is_sign_negative();
    }
    let (digits, least) = if single { (23, -149) } else { (52, -1074) };
    let exponent = (scale.max(want.abs()).log2().floor() as i32 - digits).max(least);
    (got - want).abs() <= ulps * 2f64.powi(exponent)
}

fn run(program: &Program, case: &Case, input: &[u32], outputs: usize, how: How) -> Storage {
    let groups = LANES.div_ceil(64) as u32;
    run_with(program, input, LANES * outputs, groups, how).unwrap_or_else(|failure| {
        panic!("{}: {failure:?}", case.text);
    })
}

/// The results' bits, NaN made one.
fn results(storage: &Storage, case: &Case) -> Vec<u64> {
    let float = |index: usize| {
        let value = storage.float(index).unwrap();
        if value.is_nan() { u64::MAX } else { value.to_bits() }
    };
    match case.want {
        Want::Word(_) => common::words(storage).into_iter().map(u64::from).collect(),
        _ => (0..storage.len()).map(float).collect(),
    }
}

fn compare(case: &Case, input: &[u32], got: &[u64], outputs: usize, precision: Precision) {
    let count = case.args.len();
    for (words, got) in input.chunks(count).zip(got.chunks(outputs)) {
        let number = |(word, kind): (&u32, u8)| match kind {
            b'i' => f64::from(*word as i32),
            b'u' => f64::from(*word),
            _ => f64::from(f(*word)),
        };
        let numbers: Vec<f64> = words.iter().zip(case.args.bytes()).map(number).collect();
        let (want, scale) = match case.want {
            Want::Float(want) => (want(&numbers), 0.0),
            Want::Scaled(want) => want(&numbers),
            Want::Word(want) => {
                let want: Vec<u64> = want(words).into_iter().map(u64::from).collect();
                assert_eq!(got, want, "{} of {words:x?}, {precision:?}", case.text);
                continue;
            }
        };
        assert_eq!(want.len(), outputs, "{}", case.text);
        let ulps = case.ulps[usize::from(precision == Precision::F64)];
        for (got, want) in got.iter().zip(want) {
            let got = if *got == u64::MAX { f64::NAN } else { f64::from_bits(*got) };
            let good = near(got, want, scale, ulps, precision);
            assert!(good, "{} of {numbers:?}: {got:e}, not {want:e} ({precision:?})", case.text);
        }
    }
}

#[test]
fn every_builtin_and_operator_in_every_way() {
    for case in table() {
        let input = input(case.args);
        let (text, outputs) = kernel(&case, false);
        let program = lower(&text).unwrap();
        let (text, _) = kernel(&case, true);
        let in_a_loop = lower(&text).unwrap();
        for precision in [Precision::F32, Precision::F64] {
            let how = How { precision, ..How::default() };
            let first = results(&run(&program, &case, &input, outputs, how), &case);
            compare(&case, &input, &first, outputs, precision);
            let again = results(&run(&in_a_loop, &case, &input, outputs, how), &case);
            assert_eq!(first, again, "{} with uniform operands, {precision:?}", case.text);
            for how in ways(precision) {
                let again = results(&run(&program, &case, &input, outputs, how), &case);
                assert!(first == again, "{} differs, {how:?}", case.text);
            }
        }
    }
}

#[test]
fn the_table_has_every_builtin_function() {
    let names = "abs min max clamp saturate cos cosh sin sinh tan tanh acos acosh asin asinh atan \
        atanh atan2 radians degrees ceil floor round fract trunc modf frexp ldexp exp exp2 log log2 \
        pow dot dot4I8Packed dot4U8Packed cross distance length normalize faceForward reflect \
        refract sign fma mix step smoothstep sqrt inverseSqrt transpose determinant quantizeToF16 \
        countTrailingZeros countLeadingZeros countOneBits reverseBits extractBits insertBits \
        firstTrailingBit firstLeadingBit pack4x8snorm pack4x8unorm pack2x16snorm pack2x16unorm \
        pack2x16float pack4xI8 pack4xU8 pack4xI8Clamp pack4xU8Clamp unpack4x8snorm unpack4x8unorm \
        unpack2x16snorm unpack2x16unorm unpack2x16float unpack4xI8 unpack4xU8 select all any \
        arrayLength";
    let table = table();
    for name in names.split_whitespace() {
        let called = |case: &Case| {
            let call = format!("{name}(");
            let mut found = case.text.match_indices(&call);
            found.any(|(at, _)| !case.text[..at].ends_with(char::is_alphanumeric))
        };
        assert!(table.iter().any(called), "{name} is in no case");
    }
}
