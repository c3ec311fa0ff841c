//! What programs compute: a variant for each kernel that the host links. `text` puts their texts together.

use super::{Form, Function};
use crate::plugin::Configured;

/// What a program computes.
#[derive(Debug, Clone)]
pub enum View {
    /// The picture: a BRDF seen through an integrator.
    Film {
        /// The BRDF.
        brdf: Configured,
        /// The integrator.
        integrator: Configured,
        /// How the map lies and is read, and where samples come from.
        form: Form,
    },
    /// The BRDF's values for a list of direction pairs.
    Eval {
        /// The BRDF.
        brdf: Configured,
    },
    /// One of the author's functions alone, for a list of cases. Its loops are not bounded: whoever
    /// runs it counts instructions.
    Numerics {
        /// The BRDF.
        brdf: Configured,
        /// One of those that [`functions`] finds.
        function: Function,
    },
    /// Draws of the BRDF by independent numbers, for the laws of sampling.
    Draws {
        /// The BRDF.
        brdf: Configured,
    },
    /// Integrals of the BRDF and its density over cells of directions.
    Cells {
        /// The BRDF.
        brdf: Configured,
    },
    /// One of the BRDF's tables, filled by the author's function.
    Table {
        /// The BRDF.
        brdf: Configured,
        /// Which of the manifest's tables.
        table: usize,
    },
    /// Draws of the environment by independent numbers, for the law of sampling.
    LightDraws {
        /// How the map lies and is read.
        form: Form,
        /// Whether the table is a compensated one.
        compensated: bool,
    },
    /// The density of those draws for a list of directions.
    LightDensities {
        /// How the map lies and is read.
        form: Form,
        /// Whether the table is a compensated one.
        compensated: bool,
    },
    /// The environment's radiance for a list of directions.
    Background {
        /// How the map lies and is read.
        form: Form,
    },
}
