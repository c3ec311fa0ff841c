//! What a reference was held against: in the picture's header, in its report, and where it is refused.

use serde::Serialize;

use crate::measure::agreement::{Agreement, Comparison, FLOOR, Finding};
use crate::render::{Film, estimate};
use crate::session::Session;

/// A reference beside samples, by the names of their integrators.
#[derive(Debug, Clone, Serialize)]
pub(in crate::cli) struct Check {
    by: String,
    against: String,
    spp: u64,
    seed: u32,
    /// The reference's own estimated error, as a part of the picture's sum.
    quadrature_error: f64,
    #[serde(flatten)]
    pub agreement: Agreement,
}

impl Check {
    /// What was compared, of the sessions and films of the reference and of the samples.
    ///
    /// Whatever the numbers say, a reference with terms that are not finite, or of too large an error of its
    /// own, is none; and samples that are not finite count as zero, so that they decide nothing.
    pub(super) fn new(
        [made, against]: [&Session; 2],
        [reference, samples]: [&Film; 2],
        mut agreement: Agreement,
    ) -> Self {
        let id = |session: &Session| session.integrator.configured.plugin.id.clone();
        let quadrature_error = estimate(reference).quadrature.unwrap_or_default();
        let bad = [reference, samples].map(Film::nonfinite);
        let mut judge = |finding: Finding, doubt: String| {
            agreement.finding = finding;
            agreement.doubt = Some(doubt);
        };
        if bad[0] > 0 {
            judge(Finding::Disagrees, format!("{} terms of {} are not finite", bad[0], id(made)));
        } else if quadrature_error > FLOOR {
            let told = format!("{} estimates its own error as {quadrature_error:.1e}", id(made));
            judge(Finding::Disagrees, told);
        } else if bad[1] > 0 {
            let told = format!("{} samples of {} are not finite", bad[1], id(against));
            judge(Finding::Undecided, told);
        }
        Self {
            by: id(made),
            against: id(against),
            spp: samples.samples(),
            seed: against.effort.seed,
            quadrature_error,
            agreement,
        }
    }

    /// One sentence for the header.
    pub(in crate::cli) fn sentence(&self) -> String {
        let Self { against, spp, agreement, .. } = self;
        let opening = match &agreement.doubt {
            Some(doubt) => format!("unchecked, {doubt}: beside {against}"),
            None => format!("checked against {against}"),
        };
        let off = |c: &Comparison| format!("{:.1e} of it (z {})", c.off(), shown(c.z()));
        format!(
            "{opening}, {spp} spp: its mean is off by {}, that of the worst of {} tiles by {}; z may be {:.2}",
            off(agreement.worst_channel()),
            agreement.tiles,
            off(&agreement.worst_tile),
            agreement.quantile,
        )
    }

    /// Why no picture was written, with both numbers.
    pub(super) fn refusal(&self) -> String {
        let Self { by, against, spp, agreement, .. } = self;
        let doubt = agreement.doubt.as_deref();
        let (why, cure) = match agreement.finding {
            Finding::Undecided => (
                format!("undecided, {}", doubt.unwrap_or_default()),
                "; give the check more time, or write it with --undecided",
            ),
            _ => match doubt {
                Some(doubt) => (format!("{by} and {against} disagree, and {doubt}"), ""),
                None => (format!("{by} and {against} disagree"), ""),
            },
        };
        let mut text = format!("REFUSED: {why}\n");
        for (opening, c) in agreement
            .picture
            .iter()
            .map(|c| ("", c))
            .chain([("worst tile, ", &agreement.worst_tile)])
        {
            text += &format!(
                "  {opening}{c}: {by} {:.5e}, {against} {:.5e} +- {:.1e}: off by {:.1e} of it, z {}\n",
                c.reference,
                c.found,
                c.std_error,
                c.off(),
                shown(c.z()),
            );
        }
        text + &format!(
            "  {by}'s own error is about {:.1e} of the picture; {against} took {spp} spp, \
             and its standard error is below 1 % in {} of {} tiles\n  \
             z may be {:.2}, and {FLOOR:.0e} of it is always allowed\n  no file was written{cure}\n",
            self.quadrature_error, agreement.sharp_tiles, agreement.tiles, agreement.quantile,
        )
    }

    pub(super) fn json(&self) -> String {
        // Numbers and texts only; if it could not be written, the fault shows here.
        let told = serde_json::to_string(self);
        told.unwrap_or_else(|error| format!("{{\"error\": \"{error}\"}}")) + "\n"
    }
}

/// A number of standard errors; beyond some thousands its digits say nothing.
fn shown(z: f64) -> String {
    if z.abs() < 1e4 { format!("{z:.2}") } else { format!("{z:.0e}") }
}
