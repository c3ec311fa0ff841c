//! What a law says of a BRDF.

use serde::Serialize;

/// The probability that a BRDF that is right is taken for wrong, over all tests of a law together.
pub const LEVEL: f64 = 0.01;

/// A law that every BRDF is held to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// The author's part of the contract: unit directions, a density, no mirror, parameters that are used
    Contract,
    /// Values are finite and not negative
    Finite,
    /// f(wo, wi) = f(wi, wo)
    Reciprocity,
    /// No more light leaves than comes
    Energy,
    /// Draws follow their density: chi-square and z-tests
    Sampling,
    /// The mean of the weights is the albedo
    Mean,
    /// The closed form of the weight is f cos / pdf
    Weight,
    /// Every integrator shows the albedo in a white furnace
    Furnace,
    /// Values are those of the literature or of another program
    References,
    /// f32 keeps the digits of f64
    Stability,
    /// Sampling pays, against the cosine
    Variance,
}

impl Law {
    /// All of them, in the order in which they are judged.
    pub const ALL: [Law; 11] = [
        Law::Contract,
        Law::Finite,
        Law::Reciprocity,
        Law::Energy,
        Law::Sampling,
        Law::Mean,
        Law::Weight,
        Law::Furnace,
        Law::References,
        Law::Stability,
        Law::Variance,
    ];

    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Law::Contract => "contract",
            Law::Finite => "finite",
            Law::Reciprocity => "reciprocity",
            Law::Energy => "energy",
            Law::Sampling => "sampling",
            Law::Mean => "mean",
            Law::Weight => "weight",
            Law::Furnace => "furnace",
            Law::References => "references",
            Law::Stability => "stability",
            Law::Variance => "variance",
        }
    }

    /// The time that it may take of two cores for one BRDF [seconds], where nobody wants it deep. `mean` and
    /// `variance` judge what `sampling` drew.
    pub fn budget(self) -> f64 {
        match self {
            Law::Contract | Law::Finite | Law::Reciprocity | Law::Weight | Law::References => 1.0,
            Law::Mean | Law::Variance => 1.0,
            Law::Stability => 3.0,
            Law::Energy => 4.0,
            Law::Furnace => 6.0,
            Law::Sampling => 12.0,
        }
    }
}

/// What became of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// It holds.
    Passed,
    /// It does not.
    Failed,
    /// It has nothing to judge here.
    Skipped,
    /// It only tells.
    Reported,
}

/// A law's verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The law.
    pub law: Law,
    /// What became of it.
    pub outcome: Outcome,
    /// The number that decided, and what it is.
    pub number: Option<f64>,
    /// What the number may be at the most, or for a probability at the least.
    pub threshold: Option<f64>,
    /// One sentence.
    pub said: String,
    /// The input that shows the failure, as a command or as numbers.
    pub reproduce: Option<String>,
    /// Cases looked at.
    pub cases: usize,
    /// What is worth knowing beside.
    pub notes: Vec<String>,
    /// Time that it took [seconds].
    pub seconds: f64,
}

impl Verdict {
    /// A verdict without numbers.
    pub fn new(law: Law, outcome: Outcome, said: impl Into<String>) -> Self {
        Self {
            law,
            outcome,
            number: None,
            threshold: None,
            said: said.into(),
            reproduce: None,
            cases: 0,
            notes: Vec::new(),
            seconds: 0.0,
        }
    }

    /// With the number that decided and its threshold.
    pub fn with(self, number: f64, threshold: f64, cases: usize) -> Self {
        Self { number: Some(number), threshold: Some(threshold), cases, ..self }
    }

    /// With the input that shows it.
    pub fn shown_by(self, reproduce: impl Into<String>) -> Self {
        Self { reproduce: Some(reproduce.into()), ..self }
    }
}

/// Passed or failed.
pub fn outcome(holds: bool) -> Outcome {
    if holds { Outcome::Passed } else { Outcome::Failed }
}
