//! What a comparison found, on the terminal and as JSON.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Arguments, Bias, Figure, Metric, Pair, ZScores};

/// Everything that is said of two pictures; what is not finite becomes null.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    a: String,
    b: String,
    metric: &'static str,
    figure: f64,
    /// Pixels that the figure is the mean of.
    pixels: usize,
    /// Pixels that are not finite in one of the pictures: they enter nothing.
    nonfinite_pixels: usize,
    mean_difference: [f64; 3],
    mean_difference_std_error: Option<[f64; 3]>,
    /// Pixels that mean difference and z are over.
    mean_difference_pixels: usize,
    z: Option<Z>,
    fail: Option<f64>,
    pub(super) passed: bool,
    map: Option<String>,
    notes: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
struct Z {
    rms: f64,
    beyond_3: f64,
    values: usize,
    equal_without_error: usize,
    different_without_error: usize,
    unknown: usize,
}

impl Report {
    pub(super) fn new(
        arguments: &Arguments,
        pair: &Pair,
        Figure { value: figure, pixels }: Figure,
        bias: Bias,
        scores: Option<&ZScores>,
    ) -> Self {
        let count = |counted: &[bool]| counted.iter().filter(|counted| **counted).count();
        let nonfinite_pixels = pair.finite.len() - count(&pair.finite);
        let within = |limit: f64| figure <= limit && nonfinite_pixels == 0;
        let mut notes = Vec::new();
        if pair.a.for_display != pair.b.for_display && arguments.metric != Metric::Flip {
            notes.push(
                "one picture is a PNG: radiance is compared with light that a display curve has bent",
            );
        }
        if scores.is_some() && (pair.a.std_error.is_none() || pair.b.std_error.is_none()) {
            notes.push("one picture has no standard errors: it counts as exact");
        }
        Self {
            a: arguments.a.display().to_string(),
            b: arguments.b.display().to_string(),
            metric: arguments.metric.name(),
            figure,
            pixels,
            nonfinite_pixels,
            mean_difference: bias.mean,
            mean_difference_std_error: bias.std_error,
            mean_difference_pixels: count(&pair.covered),
            z: scores.map(|scores| Z {
                rms: scores.rms,
                beyond_3: scores.beyond_3,
                values: scores.values,
                equal_without_error: scores.equal_without_error,
                different_without_error: scores.different_without_error,
                unknown: scores.unknown,
            }),
            fail: arguments.fail,
            passed: arguments.fail.is_none_or(within),
            map: arguments.output.as_ref().map(|path| path.display().to_string()),
            notes,
        }
    }

    pub(super) fn json(&self) -> String {
        // Numbers and texts only; if it could not be written, the fault shows here.
        let text = serde_json::to_string(self)
            .unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"));
        text + "\n"
    }

    pub(super) fn text(&self) -> String {
        let Self { a, b, metric, figure, pixels, mean_difference_pixels, .. } = self;
        let mut text = format!("A {a}\nB {b}\n{metric} {figure:.6e} over {pixels} pixels\n");
        let [r, g, blue] = self.mean_difference.map(|mean| format!("{mean:+.4e}"));
        let _ = write!(text, "mean of A - B {r} {g} {blue} over {mean_difference_pixels} pixels");
        if let Some([er, eg, eb]) = self.mean_difference_std_error {
            let _ = write!(text, ", standard error {er:.1e} {eg:.1e} {eb:.1e}");
        }
        text.push('\n');
        if let Some(z) = &self.z {
            let _ = writeln!(
                text,
                "z: RMS {:.4}, {:.2} % beyond 3, over {} values (right standard errors give 1 and 0.27 %)",
                z.rms,
                100.0 * z.beyond_3,
                z.values
            );
            for (count, what) in [
                (z.equal_without_error, "are equal and have no error"),
                (z.different_without_error, "DIFFER where the standard error is 0"),
                (z.unknown, "have a standard error that is no number"),
            ] {
                if count > 0 {
                    let _ = writeln!(text, "  left out: {count} values {what}");
                }
            }
        }
        if self.nonfinite_pixels > 0 {
            let _ = writeln!(
                text,
                "WARNING: {} pixels are not finite and enter no figure",
                self.nonfinite_pixels
            );
        }
        self.notes.iter().for_each(|note| {
            let _ = writeln!(text, "note: {note}");
        });
        if let Some(map) = &self.map {
            let _ = writeln!(text, "wrote {map}");
        }
        if let Some(limit) = self.fail {
            let word = if self.passed { "passed" } else { "FAILED" };
            let _ = writeln!(text, "{word}: --fail {limit}");
        }
        text
    }
}
