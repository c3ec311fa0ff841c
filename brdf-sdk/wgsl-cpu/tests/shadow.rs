//! f32 beside f64: both values are right, and the place where digits are lost is found.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

mod common;

use common::{binding, parse, with_errors};
use wgsl_cpu::{Precision, Program, Resource, Run, Site, Storage};

fn kernel(body: &str) -> String {
    format!(
        "@group(0) @binding(0) var<storage, read> input: array<f32>;
         @group(0) @binding(1) var<storage, read_write> output: array<f32>;
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             if id.x >= arrayLength(&output) {{ return; }}
             let x = input[id.x];
             {body}
         }}"
    )
}

/// Sites, and what was stored, for one invocation each.
fn errors(text: &str, input: &[f32]) -> (Vec<Site>, Storage) {
    with_errors(text, input, |program, run, _| program.errors(run).unwrap())
}

/// The site of an invocation's largest error: its text, the error, the bits that cancelled.
fn worst<'a>(text: &'a str, sites: &[Site], lane: usize) -> (&'a str, f32, f32) {
    let site = sites.iter().max_by(|a, b| a.errors[lane].total_cmp(&b.errors[lane])).unwrap();
    (&text[site.span.to_range().unwrap()], site.errors[lane], site.cancelled[lane])
}

/// Both values of each invocation, against the same program in f32 and f64.
fn check(storage: &Storage, input: &[f32], low: impl Fn(f32) -> f32, high: impl Fn(f64) -> f64) {
    for (index, x) in input.iter().enumerate() {
        let word = f32::from_bits(storage.word(index).unwrap());
        let wide = storage.float(index).unwrap();
        assert_eq!(word.to_bits(), low(*x).to_bits(), "f32 of {x:e}: {word:e}");
        let wanted = high(f64::from(*x));
        assert!((wide - wanted).abs() <= 1e-15 * wanted.abs(), "{x:e}: {wide:e}, not {wanted:e}");
    }
}

/// Several batches of numbers just below 1, nearer and nearer.
fn near_one() -> Vec<f32> {
    (0..150).map(|index| 1.0 - 0.4 * 0.9f32.powi(index)).collect()
}

#[test]
fn one_minus_a_square() {
    let text = kernel("output[id.x] = 1.0 - x * x;");
    let input = near_one();
    let (sites, storage) = errors(&text, &input);
    check(&storage, &input, |x| 1.0 - x * x, |x| 1.0 - x * x);
    let difference =
        sites.iter().find(|site| &text[site.span.to_range().unwrap()] == "1.0 - x * x");
    let difference = difference.unwrap();
    for (lane, x) in input.iter().enumerate() {
        let x = f64::from(*x);
        let wanted = 1.0 - x * x;
        if difference.errors[lane] > 0.0 {
            let (got, bits) = (f64::from(difference.cancelled[lane]), -wanted.log2());
            assert!((got - bits.max(0.0)).abs() < 1e-3, "{x}: {got} bits, not {bits}");
        }
        if wanted > 0.2 || wanted == 0.0 {
            continue;
        }
        let (site, error, _) = worst(&text, &sites, lane);
        let square = f64::from((x * x) as f32);
        let exact = ((1.0 - square) - wanted).abs() / wanted;
        // Where the square happens to be a number of f32, nothing is lost.
        if exact > 1e-6 {
            assert_eq!(site, "1.0 - x * x");
            assert!((f64::from(error) / exact - 1.0).abs() < 1e-3, "{x}: {error:e}, not {exact:e}");
        }
    }
}

#[test]
fn a_sum_that_absorbs() {
    let text = kernel("let sum = 16777216.0 + x; output[id.x] = sum - 16777216.0;");
    let input: Vec<f32> = (0..200).map(|index| index as f32 * 0.013 + 0.1).collect();
    let (sites, storage) = errors(&text, &input);
    let big = 16_777_216.0f32;
    check(&storage, &input, |x| (big + x) - big, |x| (f64::from(big) + x) - f64::from(big));
    for (lane, x) in input.iter().enumerate() {
        let (site, error, cancelled) = worst(&text, &sites, lane);
        assert_eq!(site, "sum - 16777216.0", "{x}");
        let lost = (f64::from(big + x - big) / f64::from(*x) - 1.0).abs();
        assert!((f64::from(error) - lost).abs() < 1e-3 * lost + 1e-6, "{x}: {error}, not {lost}");
        let bits = 24.0 - x.log2();
        assert!((cancelled - bits).abs() < 0.1, "{x}: {cancelled} bits, not {bits}");
    }
}

#[test]
fn the_sine_from_the_cosine() {
    let text = kernel(
        "let square = x * x; let rest = 1.0 - square; output[id.x] = sqrt(rest) * 3.0 + 1.0;",
    );
    let input = near_one();
    let (sites, storage) = errors(&text, &input);
    check(
        &storage,
        &input,
        |x| (1.0 - x * x).sqrt() * 3.0 + 1.0,
        |x| (1.0 - x * x).sqrt() * 3.0 + 1.0,
    );
    for site in &sites {
        // An error that was handed over is not this operation's own.
        let own = &text[site.span.to_range().unwrap()] == "1.0 - square";
        assert!(own || site.errors.iter().all(|error| *error < 2e-7), "{:?}", site.span);
    }
    let found = (0..input.len()).filter(|lane| {
        let (site, error, _) = worst(&text, &sites, *lane);
        // Where nothing cancels the worst site is one of rounding: its own, and that of an operand
        // handed on, each 2^-24.
        let rounding = 2.0 * 2f32.powi(-24) + 1e-12;
        assert!(error <= rounding || site == "1.0 - square", "{site}: {error:e}");
        error > 1e-6
    });
    assert!(found.count() > 60);
}

#[test]
fn a_chain_of_products_is_clean() {
    let text = kernel("output[id.x] = (x * 1.1) * (x + 2.0) / (x * x + 0.5);");
    let input: Vec<f32> = (1..300).map(|index| index as f32 * 0.037).collect();
    let (sites, storage) = errors(&text, &input);
    let (a, b) = (1.1f32, f64::from(1.1f32));
    check(
        &storage,
        &input,
        |x| (x * a) * (x + 2.0) / (x * x + 0.5),
        |x| (x * b) * (x + 2.0) / (x * x + 0.5),
    );
    assert!(!sites.is_empty());
    for site in &sites {
        for (error, cancelled) in site.errors.iter().zip(&site.cancelled) {
            // Two operands and the result are rounded: one and a half units at most.
            assert!(*error < 2e-7 && *cancelled <= 1.0, "{error:e}, {cancelled} bits");
        }
    }
}

#[test]
fn what_a_lane_does_not_execute_is_no_error_of_it() {
    let text = kernel(
        "var r = x;
         if x > 0.5 { r = 1.0 - x * x; } else { r = x * 0.3; }
         for (var i = 0u; i < 2u; i++) {
             if x < 0.25 { continue; }
             r = (r + 1000.0) - 1000.0;
         }
         output[id.x] = r;",
    );
    let input: Vec<f32> = (0..130).map(|index| index as f32 / 130.0 + 0.001).collect();
    let (sites, storage) = errors(&text, &input);
    let low = |x: f32| {
        let r = if x > 0.5 { 1.0 - x * x } else { x * 0.3 };
        let again = |r: f32| (r + 1000.0) - 1000.0;
        if x < 0.25 { r } else { again(again(r)) }
    };
    for (index, x) in input.iter().enumerate() {
        let word = f32::from_bits(storage.word(index).unwrap());
        assert_eq!(word.to_bits(), low(*x).to_bits(), "f32 of {x}");
    }
    for (span, executes) in [
        ("1.0 - x * x", (|x| x > 0.5) as fn(f32) -> bool),
        ("x * 0.3", |x| x <= 0.5),
        ("(r + 1000.0) - 1000.0", |x| x >= 0.25),
    ] {
        let of_span = |site: &&Site| &text[site.span.to_range().unwrap()] == span;
        let found: Vec<&Site> = sites.iter().filter(of_span).collect();
        assert!(!found.is_empty(), "{span}");
        for (lane, x) in input.iter().enumerate() {
            let error = found.iter().map(|site| site.errors[lane]).fold(0.0, f32::max);
            assert!(executes(*x) || error == 0.0, "{span} of {x}: {error:e}");
        }
        let hits = (0..input.len()).filter(|lane| found.iter().any(|s| s.errors[*lane] > 0.0));
        assert!(hits.count() > 20, "{span}");
    }
}

#[test]
fn a_shadow_run_stores_what_the_plain_ones_do() {
    let text = kernel("output[id.x] = sin(x * 3.0) + exp(-x) * pow(x, 1.7) - atan2(x, 0.3);");
    let input: Vec<f32> = (0..300).map(|index| index as f32 * 0.017).collect();
    let (_, both) = errors(&text, &input);
    let (module, info) = parse(&text);
    let program = Program::new(&module, &info).unwrap();
    let words: Vec<u32> = input.iter().map(|x| x.to_bits()).collect();
    for precision in [Precision::F32, Precision::F64] {
        let wide = precision == Precision::F64;
        let storage = Storage::new(input.len(), wide);
        let resources =
            [(binding(0), Resource::Words(&words)), (binding(1), Resource::Storage(&storage))];
        let run = Run { resources: &resources, groups: [5, 1, 1], fuel: 1, set: None, lanes: None };
        program.run(precision, &run).unwrap();
        for (index, x) in input.iter().enumerate() {
            if wide {
                assert_eq!(storage.float(index), both.float(index), "{x}");
            } else {
                assert_eq!(storage.word(index), both.word(index), "{x}");
            }
        }
    }
}
