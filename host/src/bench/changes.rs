//! What became slower or less accurate since an older report, beyond noise.

use super::{CellReport, Report};

/// Speeds may differ by this part of them on machines that do other things too, beside what both reports saw themselves.
const NOISE_OF_TIME: f64 = 0.15;

/// From other seeds errors of the same samples differ by this factor; from the same one by what roundings make of it.
const OTHER_SEED: f64 = 1.5;
const SAME_SEED: f64 = 1.02;

/// A cell that differs.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Scene and integrator.
    pub cell: String,
    /// What differs: `time a sample`, `relMSE`, or `figures` where there are none any more.
    pub what: &'static str,
    /// The new value as a multiple of the old one.
    pub factor: f64,
    /// Whether it is worse.
    pub worse: bool,
}

/// Whether times say something: neither report saw its machine disturbed.
pub fn times_are_compared(old: &Report, new: &Report) -> bool {
    [old, new].iter().all(|report| report.devices.iter().all(|device| !device.disturbed))
}

/// Cells of `new` that differ from those of the same scene and integrator in `old`; times are taken relative to both
/// calibrations, and not at all where a machine was disturbed. Cells that have no counterpart are passed over.
pub fn changes(old: &Report, new: &Report) -> Vec<Change> {
    let mut found = Vec::new();
    let timed = times_are_compared(old, new);
    for cell in &new.cells {
        let counterpart = |other: &&CellReport| {
            other.case == cell.case
                && other.integrator == cell.integrator
                && (other.device == cell.device || old.devices.len() == 1)
        };
        let Some(before) = old.cells.iter().find(counterpart) else { continue };
        let name = format!("{}, {}", cell.case, cell.integrator);
        let mut tell = |what, factor: f64, noise: f64| {
            if factor > noise || factor < 1.0 / noise {
                found.push(Change { cell: name.clone(), what, factor, worse: factor > 1.0 });
            }
        };
        if timed
            && let (Some(a), Some(b), Some(spread_a), Some(spread_b)) =
                (before.relative_rate, cell.relative_rate, before.rate, cell.rate)
        {
            let noise = 1.0 + NOISE_OF_TIME + spread_a.relative() + spread_b.relative();
            tell("time a sample", a / b, noise);
        }
        let same_seed = old.limits.seed == new.limits.seed;
        let noise = if same_seed { SAME_SEED } else { OTHER_SEED };
        // The last step that both have.
        let both = cell.steps.iter().rev().find_map(|step| {
            let other = before.steps.iter().find(|other| other.spp == step.spp)?;
            Some((other.errors.relmse, step.errors.relmse))
        });
        if let Some((a, b)) = both.filter(|(a, b)| *a > 0.0 || *b > 0.0) {
            tell("relMSE", b / a, noise);
        }
        if let (None, Some(_)) = (&before.problem, &cell.problem) {
            tell("figures", f64::INFINITY, 1.0);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::{DeviceReport, Errors, Limits, Spread, Step};
    use super::*;

    fn spread(median: f64) -> Spread {
        Spread { median, low: 0.98 * median, high: 1.02 * median }
    }

    fn report(device: &str, calibration: f64, rate: f64, relmse: f64, seed: u32) -> Report {
        let mut report = Report::new(&Limits { seed, ..Limits::default() });
        let calibration = spread(calibration);
        let name = device.to_owned();
        report.devices.push(DeviceReport { name, calibration, disturbed: false });
        let errors = Errors {
            mse: relmse,
            relmse,
            bias: 0.0,
            bias_std_error: None,
            flip: 0.0,
            estimate: None,
            nonfinite: 0,
        };
        let mut cell = CellReport::new(device, "a case", "uniform");
        cell.steps.push(Step { spp: 16, seconds: spread(1.0), device_seconds: None, errors });
        cell.rate = Some(spread(rate));
        cell.relative_rate = Some(rate / calibration.median);
        report.cells.push(cell);
        report
    }

    #[test]
    fn a_slower_machine_is_no_slower_program() {
        let old = report("one", 100.0, 10.0, 1e-3, 0);
        assert_eq!(changes(&old, &report("other", 50.0, 5.0, 1e-3, 0)), []);
        let slower = changes(&old, &report("other", 50.0, 2.5, 1e-3, 0));
        let [Change { what: "time a sample", factor, worse: true, .. }] = slower[..] else {
            panic!("{slower:?}")
        };
        assert!((factor - 2.0).abs() < 1e-9);
    }

    #[test]
    fn times_of_a_disturbed_machine_say_nothing() {
        let old = report("one", 100.0, 10.0, 1e-3, 0);
        let mut new = report("one", 100.0, 5.0, 1e-3, 0);
        assert_eq!(changes(&old, &new).len(), 1);
        new.devices[0].disturbed = true;
        assert_eq!(changes(&old, &new), []);
        assert_eq!(changes(&new, &old), []);
    }

    #[test]
    fn errors_of_one_seed_are_the_same_and_those_of_others_differ() {
        let old = report("one", 100.0, 10.0, 1e-3, 0);
        assert_eq!(changes(&old, &report("one", 100.0, 10.0, 1.01e-3, 0)), []);
        assert!(changes(&old, &report("one", 100.0, 10.0, 1.1e-3, 0))[0].worse);
        assert_eq!(changes(&old, &report("one", 100.0, 10.0, 1.3e-3, 1)), []);
        assert!(changes(&old, &report("one", 100.0, 10.0, 2e-3, 1))[0].worse);
        assert!(!changes(&old, &report("one", 100.0, 10.0, 1e-4, 1))[0].worse);
    }
}
