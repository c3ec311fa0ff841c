//! The shadow run: where errors arise, and what each instruction contributes to the result.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

mod common;

use common::{with_errors, words};
use wgsl_cpu::{Program, Run, Storage};

/// `d` cancels where x is near 1; the cosine of a right angle is nothing but error, and reaches the
/// result by a factor of 1e-20.
const TEXT: &str = "@group(0) @binding(0) var<storage, read> input: array<f32>;
@group(0) @binding(1) var<storage, read_write> output: array<f32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let x = input[id.x] * input[id.x];
    let right = cos(1.5707964 + 1e-9 * x);
    let d = x - 0.99;
    output[id.x] = d + 1e-20 * right;
}";

/// The text of each site with its largest local error and its largest contribution to the result.
fn found(text: &str, input: &[f32]) -> Vec<(String, f32, f64)> {
    let look = |program: &Program, run: &Run<'_>, output: &Storage| {
        let sites = program.errors(run).unwrap();
        let values = || (0..input.len()).map(|i| output.float(i).unwrap()).collect::<Vec<_>>();
        let exact = values();
        let low = words(output);
        let mut found = Vec::new();
        for site in &sites {
            program.errors_of(site.span, run).unwrap();
            let mixed = values();
            let contribution = mixed.iter().zip(&exact).map(|(a, b)| (a - b).abs() / b.abs());
            assert_eq!(low, words(output), "the f32 does not depend on whose errors are asked for");
            let local = site.errors.iter().copied().fold(0.0, f32::max);
            let place = text[site.span.to_range().unwrap()].to_owned();
            found.push((place, local, contribution.fold(0.0, f64::max)));
        }
        found
    };
    with_errors(text, input, look).0
}

#[test]
fn a_cancellation_arises_and_contributes_where_it_stands() {
    let input: Vec<f32> = (0..100).map(|i| 0.99 + 0.0001 * (i as f32 + 0.3)).collect();
    let found = found(TEXT, &input);
    let of = |text: &str| found.iter().find(|(place, ..)| place == text).unwrap().clone();
    let (_, local, contribution) = of("x - 0.99");
    assert!(local > 1e-4 && contribution > 1e-4, "{found:?}");
    // Rounding before it is no error of its own, but the difference makes it large in the result.
    let (_, local, contribution) = of("input[id.x] * input[id.x]");
    assert!(local < 2e-7 && contribution > 1e-4, "{found:?}");
    // An error that never reaches the result contributes nothing.
    let (_, local, contribution) = of("cos");
    assert!(local > 1e-3 && contribution < 1e-9, "{found:?}");
}

/// The difference is 2e-8 in f32 and -3e-8 in f64: the maximum keeps both from going below 0.
#[test]
fn a_maximum_bounds_both_precisions() {
    let text =
        TEXT.replace("d = x - 0.99", "d = 1.0 + sqrt(max((1.0 + 7e-8 * x - 1.0) - 1e-7, 0.0))");
    for (place, local, contribution) in found(&text, &[1.0]) {
        assert!(local.is_finite() && contribution < 1e-3, "{place}: {local} {contribution}");
    }
}

#[test]
fn what_is_exact_has_no_sites() {
    let text = TEXT.replace("let x = input[id.x] * input[id.x];", "let x = input[id.x] + 1.0;");
    let text = text.replace("let right = cos(1.5707964 + 1e-9 * x);", "let right = x;");
    let text = text.replace("d = x - 0.99", "d = x * 2.0");
    let text = text.replace("1e-20 * right", "right");
    assert_eq!(found(&text, &[1.0, 2.0, 3.0]), []);
}
