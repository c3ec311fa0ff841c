//! What follows from a cell's steps: how fast its error falls, and when it is low enough.

use super::Step;

/// A number, where it is one.
pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Least squares over the logarithms of the last six steps; of fewer than three none is told.
pub(super) fn slope(steps: &[Step]) -> Option<f64> {
    let last = &steps[steps.len().saturating_sub(6)..];
    let points: Vec<[f64; 2]> = last
        .iter()
        .filter(|step| step.spp > 0 && step.errors.relmse > 0.0)
        .map(|step| [(step.spp as f64).ln(), step.errors.relmse.ln()])
        .collect();
    if points.len() < 3 {
        return None;
    }
    let n = points.len() as f64;
    let [mx, my] = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / n);
    let above: f64 = points.iter().map(|[x, y]| (x - mx) * (y - my)).sum();
    let below: f64 = points.iter().map(|[x, _]| (x - mx).powi(2)).sum();
    finite(above / below)
}

/// The time at which the relMSE first falls to a target.
pub(super) fn seconds_to(steps: &[Step], target: f64) -> Option<f64> {
    let mut before: Option<&Step> = None;
    for step in steps {
        let now = step.errors.relmse;
        if now <= target {
            let seconds = step.seconds.median;
            let Some(before) = before.filter(|before| before.errors.relmse > 0.0 && now > 0.0)
            else {
                return Some(seconds);
            };
            let was = before.errors.relmse;
            let part = (was / target).ln() / (was / now).ln();
            return finite(before.seconds.median * (seconds / before.seconds.median).powf(part));
        }
        before = Some(step);
    }
    None
}
