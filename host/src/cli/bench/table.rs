//! Figures as a table for people.

use std::fmt::Write as _;

use crate::bench::{CellReport, Change, Report, Step};

/// A block for each scene on each device, the best integrator first.
pub(super) fn text(report: &Report) -> String {
    let mut text = String::new();
    for device in &report.devices {
        let _ = writeln!(
            text,
            "on {}: calibration {:.1} M samples/s ({:.1} to {:.1})",
            device.name, device.calibration.median, device.calibration.low, device.calibration.high
        );
        if device.disturbed {
            text +=
                "  THE MACHINE WAS DISTURBED: its figures of speed spread by more than a quarter\n";
        }
        for case in &report.cases {
            let _ = writeln!(
                text,
                "\n{}: {} pixels\n  reference {}",
                case.name, case.covered_pixels, case.reference_said
            );
            for note in &case.notes {
                let _ = writeln!(text, "  note: {note}");
            }
            let _ = writeln!(
                text,
                "  {:<16} {:>8} {:>8} {:>8} {:>7} {:>9} {:>9} {:>8} {:>6} {:>6} {:>9} {:>8} {:>7}",
                "integrator",
                "spp",
                "time s",
                "device s",
                "M/s",
                "relMSE",
                "its own",
                "bias/se",
                "FLIP",
                "slope",
                format!("s to {:.0e}", report.limits.target),
                "x plain",
                "of best"
            );
            for cell in report.ranked(&device.name, &case.name) {
                text += &row(cell);
            }
        }
    }
    text
}

fn row(cell: &CellReport) -> String {
    if let Some(problem) = &cell.problem {
        return format!("  {:<16} {problem}\n", cell.integrator);
    }
    let Some(last) = cell.last() else {
        return format!("  {:<16} nothing was measured\n", cell.integrator);
    };
    let or_dash = |number: Option<String>| number.unwrap_or_else(|| "-".to_owned());
    let errors = &last.errors;
    let done = done(cell, last);
    let bias = errors.bias_std_error.filter(|error| *error > 0.0);
    let mut text = format!(
        "  {:<16} {done:>8} {:>8.3} {:>8} {:>7.2} {:>9.2e} {:>9} {:>8} {:>6.4} {:>6} {:>9} {:>8} {:>7}\n",
        cell.integrator,
        last.seconds.median,
        or_dash(last.device_seconds.map(|spread| seconds(spread.median))),
        cell.rate.map_or(0.0, |rate| rate.median),
        errors.relmse,
        or_dash(errors.estimate.map(|own| format!("{own:.2e}"))),
        or_dash(bias.map(|error| format!("{:.1}", errors.bias / error))),
        errors.flip,
        or_dash(cell.slope.map(|slope| format!("{slope:.2}"))),
        or_dash(cell.seconds_to_target.map(seconds)),
        or_dash(cell.over_plain.map(times)),
        or_dash(cell.of_best.map(|part| format!("{part:.2}"))),
    );
    if errors.nonfinite > 0 {
        let _ = writeln!(text, "  {:<16} {} samples were Inf or NaN", "", errors.nonfinite);
    }
    text
}

/// Samples of a pixel; of a sum, which part of the texels.
pub(super) fn done(cell: &CellReport, last: &Step) -> String {
    match cell.texels {
        Some([done, of]) if done < of => format!("{:.0}%", 100.0 * f64::from(done) / f64::from(of)),
        Some(_) => "all".to_owned(),
        None => last.spp.to_string(),
    }
}

/// A time as a table has room for it.
pub(super) fn seconds(time: f64) -> String {
    if time >= 0.0995 { format!("{time:.2}") } else { format!("{time:.4}") }
}

/// A multiple as a table has room for it.
pub(super) fn times(factor: f64) -> String {
    match factor {
        f if f >= 1e5 => format!("{f:.0e}"),
        f if f >= 99.5 => format!("{f:.0}"),
        f if f >= 9.95 => format!("{f:.1}"),
        f => format!("{f:.2}"),
    }
}

/// What changed since an older report.
pub(super) fn changes(found: &[Change]) -> String {
    if found.is_empty() {
        return "nothing became slower or less accurate beyond noise\n".to_owned();
    }
    let mut text = String::new();
    for Change { cell, what, factor, worse } in found {
        let word = if *worse { "WORSE " } else { "better" };
        let _ = writeln!(text, "{word} {cell}: {what} is {} of what it was", times(*factor));
    }
    text
}
