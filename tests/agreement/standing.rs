//! Cells of the matrix that nobody can decide with the samples of a test, fixed in advance.
//!
//! A cell that turns out undecided without standing here fails, and so does one that stands here and
//! decides: a change that makes an integrator better, or worse, is seen.

/// Cells that stand as undecided, and why.
pub struct Standing {
    /// Integrator, material, map, layout with filter; `*` for all of them.
    pub cell: [&'static str; 4],
    pub reason: &'static str,
}

const LOBE: &str = "directions are not drawn for the lobe, and hardly one meets it";
const LIGHT: &str = "directions are not drawn for the sun, and few meet it";
const BOTH: &str = "directions are drawn neither for the lobe nor for the few bright texels";

pub const STANDING: &[Standing] = &[
    Standing { cell: ["cosine", "ggx-0.01", "*", "*"], reason: LOBE },
    Standing { cell: ["cosine", "ggx-0.1", "studio_small_03", "lat-long nearest"], reason: BOTH },
    Standing { cell: ["cosine", "ggx-0.1", "kloppenheim_05", "lat-long nearest"], reason: BOTH },
    Standing { cell: ["cosine", "ggx-0.1", "kloppenheim_05", "lat-long linear"], reason: BOTH },
    Standing {
        cell: ["cosine", "modified-phong", "kloppenheim_05", "lat-long nearest"],
        reason: BOTH,
    },
    Standing {
        cell: ["cosine", "modified-phong", "kloppenheim_05", "lat-long linear"],
        reason: BOTH,
    },
    Standing { cell: ["env-is", "ggx-0.01", "furnace", "*"], reason: LOBE },
    Standing { cell: ["env-is", "ggx-0.01", "single-texel", "lat-long linear"], reason: LOBE },
    Standing { cell: ["env-is", "ggx-0.01", "single-texel", "cube linear"], reason: LOBE },
    Standing { cell: ["env-is", "ggx-0.01", "structured", "*"], reason: LOBE },
    Standing { cell: ["env-is", "ggx-0.01", "studio_small_03", "*"], reason: LOBE },
    Standing { cell: ["env-is", "ggx-0.01", "kloppenheim_05", "*"], reason: LOBE },
    Standing { cell: ["env-is", "ggx-0.01", "st_peters_square_night", "*"], reason: LOBE },
    Standing { cell: ["uniform", "ggx-0.01", "*", "*"], reason: LOBE },
    Standing { cell: ["uniform", "ggx-0.1", "single-texel", "lat-long nearest"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.1", "single-texel", "cube nearest"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.1", "structured", "lat-long nearest"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.1", "structured", "cube nearest"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.1", "studio_small_03", "lat-long nearest"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.1", "kloppenheim_05", "lat-long nearest"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.1", "kloppenheim_05", "lat-long linear"], reason: BOTH },
    Standing { cell: ["uniform", "ggx-0.5", "kloppenheim_05", "lat-long nearest"], reason: LIGHT },
    Standing {
        cell: ["uniform", "modified-phong", "single-texel", "lat-long nearest"],
        reason: BOTH,
    },
    Standing { cell: ["uniform", "modified-phong", "single-texel", "cube nearest"], reason: BOTH },
    Standing {
        cell: ["uniform", "modified-phong", "kloppenheim_05", "lat-long nearest"],
        reason: BOTH,
    },
    Standing {
        cell: ["uniform", "modified-phong", "kloppenheim_05", "lat-long linear"],
        reason: BOTH,
    },
];

impl Standing {
    /// Whether this is about the cell.
    pub fn covers(&self, cell: [&str; 4]) -> bool {
        self.cell.iter().zip(cell).all(|(pattern, name)| *pattern == "*" || *pattern == name)
    }
}
