//! Where a BRDF's samples come from: the author's functions, or the host's where the author gives none.

use brdf_sdk::Result;

use super::declarations::Cut;
use crate::plugin::Configured;

/// Where a program's BRDF samples come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// The author's `sample` and `pdf`.
    Own,
    /// The host's cosine sampling: the author gives none, or only one of the two.
    Cosine,
    /// Tables that the host fits to the BRDF's values, where the user wants it instead of the cosine.
    Fitted,
}

impl Sampling {
    /// Whose draws they are, in words, where they are the host's.
    pub fn by_host(self) -> Option<&'static str> {
        match self {
            Self::Own => None,
            Self::Cosine => Some("the host's cosine"),
            Self::Fitted => Some("the host's fitted sampler"),
        }
    }
}

/// Where draws of a BRDF come from.
///
/// # Errors
/// Where the text cannot be taken apart.
pub fn sampling(brdf: &Configured) -> Result<Sampling> {
    let cut = Cut::new(&brdf.plugin.wgsl_file, &brdf.plugin.source)?;
    Ok(sampling_of(brdf, &cut, &mut Vec::new()))
}

/// The same of a text that is cut already; notes say where the host's are taken, and why.
pub(super) fn sampling_of(brdf: &Configured, cut: &Cut, notes: &mut Vec<String>) -> Sampling {
    let missing = match (cut.declares("sample"), cut.declares("pdf")) {
        (true, true) => {
            if brdf.fit_sampler {
                let id = &brdf.plugin.id;
                notes.push(format!("{id} has its own `sample` and `pdf`: nothing is fitted"));
            }
            return Sampling::Own;
        }
        (true, false) => "`sample` but no `pdf`",
        (false, true) => "`pdf` but no `sample`",
        (false, false) => "neither `sample` nor `pdf`",
    };
    let (sampling, by) = match brdf.fit_sampler {
        true => (Sampling::Fitted, "what is fitted to its values"),
        false => (Sampling::Cosine, "the cosine"),
    };
    notes.push(format!("{} has {missing}: sampled by {by}", brdf.plugin.id));
    sampling
}
