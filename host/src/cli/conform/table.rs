//! Verdicts as a table for people.

use std::fmt::Write as _;

use crate::conformance::{Outcome, Report, Verdict};
use crate::session::shell_quoted;

/// The verdicts of one BRDF; `reference` is how the user named it.
pub fn table(reference: &str, report: &Report) -> String {
    let mut text = format!("{} on {}\n", heading(reference, report), report.device);
    for verdict in &report.verdicts {
        let Verdict { law, outcome, said, seconds, .. } = verdict;
        let _ = writeln!(
            text,
            "  {:<6} {:<11} {:>16} {seconds:>5.1} s  {said}",
            mark(*outcome),
            law.word(),
            numbers(verdict)
        );
        if let Some(reproduce) = &verdict.reproduce {
            let _ = writeln!(text, "{:>19} {}", "see", shown(reproduce, reference));
        }
        for note in &verdict.notes {
            let _ = writeln!(text, "{:>20} {note}", "note:");
        }
    }
    text.push('\n');
    text
}

/// The BRDF's name, with how the user named it where that was by a folder or a file.
pub fn heading(reference: &str, report: &Report) -> String {
    match reference == report.brdf {
        true => report.name.clone(),
        false => format!("{} ({reference})", report.name),
    }
}

/// A command with the BRDF as the user named it, in quotes where a shell would read it otherwise.
pub fn shown(reproduce: &str, reference: &str) -> String {
    reproduce.replace("BRDF", &shell_quoted(reference))
}

/// The word for what became of a law.
pub fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "ok",
        Outcome::Failed => "FAILED",
        Outcome::Skipped => "-",
        Outcome::Reported => "note",
    }
}

/// The number that decided beside its threshold.
pub fn numbers(verdict: &Verdict) -> String {
    let short = |value: f64| match value {
        0.0 => "0".to_owned(),
        value if (1e-2..1e4).contains(&value.abs()) => format!("{value:.4}"),
        value => format!("{value:.1e}"),
    };
    match (verdict.number, verdict.threshold) {
        (Some(number), Some(threshold)) => format!("{} / {}", short(number), short(threshold)),
        _ => String::new(),
    }
}

/// One line on all of them.
pub fn closing(reports: &[&Report]) -> String {
    let verdicts = || reports.iter().flat_map(|report| &report.verdicts);
    let count = |outcome| verdicts().filter(|verdict| verdict.outcome == outcome).count();
    let seconds: f64 = verdicts().map(|verdict| verdict.seconds).sum();
    format!(
        "{} BRDF{}: {} laws hold, {} fail, {} only tell, {} do not apply; {seconds:.0} s\n",
        reports.len(),
        if reports.len() == 1 { "" } else { "s" },
        count(Outcome::Passed),
        count(Outcome::Failed),
        count(Outcome::Reported),
        count(Outcome::Skipped)
    )
}
