//! What a picture's makers are told: on the terminal, as JSON, and in the picture's own header.

use serde::Serialize;

use super::reference::Check;
use crate::link::Sampling;
use crate::render::DOUBTFUL_SHARE;

/// Everything that is said of one rendered picture.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Report {
    pub brdf: String,
    /// What a person calls it: of measured data the file, too.
    #[serde(skip)]
    pub title: String,
    pub brdf_params: serde_json::Map<String, serde_json::Value>,
    pub integrator: String,
    pub integrator_params: serde_json::Map<String, serde_json::Value>,
    /// `own`, or where the BRDF brings no sampling `cosine` or `fitted`.
    pub sampling: &'static str,
    pub environment: String,
    pub shape: String,
    pub device: String,
    pub resolution: [u32; 2],
    pub covered_pixels: usize,
    /// Pixels whose interpolated normal turned the view below the horizon.
    pub bent_normals: usize,
    pub samples: u32,
    pub passes: Option<u32>,
    /// Samples a pixel that were done; 0 for a sum over texels.
    pub spp: u64,
    pub replicates: u32,
    pub sampler: String,
    pub filter: String,
    /// Where the picture is a sum over texels.
    pub sum: Option<SumReport>,
    /// What ended it: `passes`, `time`, `error` or `interrupted`.
    pub stopped: &'static str,
    /// Whether less was done than was asked for.
    pub unfinished: bool,
    /// Whether what is missing was estimated in a way that is not unbiased.
    pub biased: bool,
    pub seed: u32,
    pub seconds: Seconds,
    pub msamples_per_s: f64,
    pub mean: [f64; 3],
    pub mean_std_error: Option<[f64; 3]>,
    pub std_error: Option<f64>,
    pub relmse_estimate: Option<f64>,
    /// The part of that relMSE that one replicate holds.
    pub largest_replicate_share: Option<f64>,
    pub nonfinite: u64,
    pub nonfinite_pixels: u64,
    pub notes: Vec<String>,
    /// Of a reference: what it was checked against, in words and in numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<Check>,
    pub exr: String,
    pub png: String,
}

/// What was spent on a sum over texels, and what it reached.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct SumReport {
    pub texels: u32,
    pub of: u32,
    pub evaluations: u64,
    /// Estimated quadrature error as a part of the picture's sum.
    pub error: Option<f64>,
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Seconds {
    pub setup: f64,
    pub compile: f64,
    pub render: f64,
}

pub(super) fn sampling_word(sampling: Sampling) -> &'static str {
    match sampling {
        Sampling::Own => "own",
        Sampling::Cosine => "cosine",
        Sampling::Fitted => "fitted",
    }
}

impl Report {
    pub(super) fn json(&self) -> String {
        // A report holds numbers and texts only; if it could not be written, the fault shows here.
        serde_json::to_string(self).unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}"))
    }

    /// Name and value of every fact, for the picture's header.
    pub(super) fn facts(&self) -> Vec<(String, String)> {
        let Ok(serde_json::Value::Object(facts)) = serde_json::to_value(self) else {
            return Vec::new();
        };
        let text = |value: serde_json::Value| match value {
            serde_json::Value::String(text) => text,
            other => other.to_string(),
        };
        // Where the picture lies is no fact about it.
        let told = facts.into_iter().filter(|(key, _)| key != "exr" && key != "png");
        told.map(|(key, value)| (format!("brdf.{key}"), text(value))).collect()
    }

    pub(super) fn text(&self) -> String {
        let Seconds { setup, compile, render } = self.seconds;
        let [width, height] = self.resolution;
        let fallback = match self.sampling {
            "cosine" => ", sampled by the cosine",
            "fitted" => ", sampled by what is fitted to its values",
            _ => "",
        };
        let [r, g, b] = self.mean;
        let error = match (self.mean_std_error, self.std_error, self.relmse_estimate) {
            (Some([er, eg, eb]), Some(pixel), Some(relmse)) => format!(
                "  mean {r:.5} {g:.5} {b:.5}, standard error {er:.1e} {eg:.1e} {eb:.1e}\n  \
                 a pixel's standard error (RMS) {pixel:.3e}, estimated relMSE {relmse:.3e}, \
                 of which one replicate holds {:.0} %\n",
                self.largest_replicate_share.unwrap_or_default() * 100.0
            ),
            _ => match &self.sum {
                Some(sum) => format!(
                    "  mean {r:.5} {g:.5} {b:.5}, estimated quadrature error {:.1e} of it\n  \
                     {:.2} evaluations a texel and pixel\n",
                    sum.error.unwrap_or_default(),
                    sum.evaluations as f64
                        / (f64::from(sum.texels.max(1)) * self.covered_pixels.max(1) as f64)
                ),
                None => format!(
                    "  mean {r:.5} {g:.5} {b:.5}; one replicate says nothing of its error: take at least 2\n"
                ),
            },
        };
        let doubtful = self.largest_replicate_share.is_some_and(|share| share > DOUBTFUL_SHARE)
            || self.std_error.is_some_and(|pixel| pixel > (r + g + b) / 3.0);
        let error = match doubtful {
            true => format!(
                "{error}  WARNING: this estimate cannot be trusted: a few bright samples hold most of the error, \
                 and others like them may have been missed\n"
            ),
            false => error,
        };
        let unfinished = match (self.unfinished, self.biased) {
            (true, true) => {
                "  UNFINISHED: the texels that are left were estimated on a coarse grid; the picture is biased\n"
            }
            (true, false) => "  UNFINISHED: stopped before its last sample\n",
            _ => "",
        };
        let work = match &self.sum {
            Some(sum) => format!("{} of {} texels", sum.texels, sum.of),
            None => format!("{} spp in {} replicates", self.spp, self.replicates),
        };
        let unit = if self.sum.is_some() { "texels" } else { "samples" };
        let bent = match self.bent_normals {
            0 => String::new(),
            n => format!(
                "  {n} pixels took the geometric normal: theirs turned the view below the horizon\n"
            ),
        };
        let nonfinite = match self.nonfinite {
            0 => "  no non-finite samples\n".to_owned(),
            n => format!(
                "  WARNING: {n} non-finite samples in {} pixels, counted as zero\n",
                self.nonfinite_pixels
            ),
        };
        let reference = self.reference.as_ref().map_or_else(String::new, |r| format!("  {r}\n"));
        format!(
            "{} with {}{fallback} under {}, {}\n  on {}\n  {width}x{height}, {} covered pixels, {work}\n  \
             set-up {setup:.3} s, compile {compile:.3} s, render {render:.3} s: {:.1} million {unit} per second\n\
             {error}{unfinished}{bent}{nonfinite}{reference}  wrote {} and {}\n",
            self.title,
            self.integrator,
            self.environment,
            self.shape,
            self.device,
            self.covered_pixels,
            self.msamples_per_s,
            self.exr,
            self.png,
        )
    }
}
