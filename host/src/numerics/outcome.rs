//! How far a result in f32 is from the one in f64.

use crate::link::Function;

/// What a call gave: the same text in f32 and, beside it, in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// In f32.
    pub low: [f32; 3],
    /// In f64.
    pub high: [f64; 3],
}

/// What is to be said of an outcome.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// Both are finite: the error, relative, or for directions an angle [radians].
    Error(f64),
    /// Inf or NaN in f64 too: the formula, and not the precision.
    NotFiniteInF64,
    /// A finite value that no f32 can hold.
    BeyondF32,
    /// Inf or NaN, though f64 gives a value that f32 can hold.
    NotFinite,
}

impl Outcome {
    /// Judges the outcome of a function.
    pub fn verdict(&self, function: Function) -> Verdict {
        let channels = || self.low.iter().zip(&self.high);
        let lost = |(low, high): (&f32, &f64)| {
            !low.is_finite() && high.is_finite() && (*high as f32).is_finite()
        };
        if channels().any(lost) {
            return Verdict::NotFinite;
        }
        if !self.high.iter().all(|high| high.is_finite()) {
            return Verdict::NotFiniteInF64;
        }
        if !self.low.iter().all(|low| low.is_finite()) {
            return Verdict::BeyondF32;
        }
        Verdict::Error(error(function, self.low.map(f64::from), self.high))
    }
}

/// The error of a function's result; infinite where the result is not finite.
///
/// Colours and densities are measured against the largest component of the exact result, and below
/// the smallest normal f32 against that; directions against 1, which gives an angle [radians].
pub fn error(function: Function, result: [f64; 3], exact: [f64; 3]) -> f64 {
    if !result.iter().all(|channel| channel.is_finite()) {
        return f64::INFINITY;
    }
    let difference = [0, 1, 2].map(|i| result[i] - exact[i]);
    match function {
        Function::Sample => difference.map(|d| d * d).iter().sum::<f64>().sqrt(),
        Function::Eval | Function::Pdf | Function::Weight => {
            let smallest = f64::from(f32::MIN_POSITIVE);
            let scale = exact.iter().fold(smallest, |scale, channel| scale.max(channel.abs()));
            difference.iter().fold(0.0, |largest: f64, d| largest.max(d.abs())) / scale
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(low: f32, high: f64) -> Verdict {
        Outcome { low: [low; 3], high: [high; 3] }.verdict(Function::Pdf)
    }

    #[test]
    fn what_is_not_finite_is_told_apart_by_whose_fault_it_is() {
        assert_eq!(verdict(f32::NAN, 1.0), Verdict::NotFinite);
        assert_eq!(verdict(f32::INFINITY, 1e38), Verdict::NotFinite);
        assert_eq!(verdict(f32::INFINITY, 1e39), Verdict::BeyondF32);
        assert_eq!(verdict(f32::NAN, f64::NAN), Verdict::NotFiniteInF64);
        assert_eq!(verdict(1.0, f64::INFINITY), Verdict::NotFiniteInF64);
    }

    #[test]
    fn errors_are_relative_and_directions_have_the_length_one() {
        assert_eq!(verdict(3.0, 2.0), Verdict::Error(0.5));
        assert_eq!(verdict(0.0, 0.0), Verdict::Error(0.0));
        // Below the smallest normal number f32 has fewer digits by design.
        assert!(matches!(verdict(0.0, 1e-46), Verdict::Error(e) if e < 1e-7));
        let tilted = Outcome { low: [0.003, 0.0, 1.0], high: [0.0, 0.004, 1.0] };
        let Verdict::Error(angle) = tilted.verdict(Function::Sample) else { panic!() };
        assert!((angle - 0.005).abs() < 1e-9);
        // One dark channel does not weigh more than its share of the colour.
        let colour = Outcome { low: [10.0, 0.002, 0.0], high: [10.0, 0.001, 0.0] };
        let Verdict::Error(error) = colour.verdict(Function::Eval) else { panic!() };
        assert!((error - 1e-4).abs() < 1e-8);
    }
}
