//! What programs are linked for beside their plugins: the map's layout and filter, the sampler, the sum.

use super::shader;
use super::source_map::SourceMap;
use crate::plugin::Configured;

/// What the host's own shaders are linked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Form {
    /// The map is a cube's six faces, not lat-long.
    pub cube: bool,
    /// Radiance is read bilinearly between texel centres, not constant in each texel.
    pub linear: bool,
    /// Where the samples' points come from.
    pub sampler: Sampler,
}

/// Where the samples' points come from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Sampler {
    /// Owen-scrambled Sobol points
    #[default]
    OwenSobol,
    /// Independent random numbers (PCG)
    Independent,
}

impl Form {
    /// The constants by which `environment/map.wgsl` is decided.
    fn constants(self) -> String {
        format!(
            "const ENV_CUBE: bool = {};\nconst ENV_LINEAR: bool = {};\n",
            self.cube, self.linear
        )
    }

    /// Pushes what integrators call.
    pub(super) fn push(self, map: &mut SourceMap) {
        let sampler = match self.sampler {
            Sampler::OwenSobol => shader::OWEN_SOBOL,
            Sampler::Independent => shader::INDEPENDENT,
        };
        map.push_all(&[shader::LOOPS, shader::NUMBERS, sampler, shader::SETS]);
        self.push_map(map);
        map.push_all(&[shader::TABLE, shader::HIT, shader::CELLS]);
    }

    pub(super) fn push_map(self, map: &mut SourceMap) {
        map.push("the host's choice of layout and filter", &self.constants());
        map.push_all(&[shader::MAP]);
    }
}

/// What the settings of an integrator with `term` say to the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sum {
    /// Its choice `order` is `luminance`: the brightest texels come first.
    pub by_luminance: bool,
    /// Its number `texels`: how many make a pass; 0 leaves it to the time they take.
    pub per_pass: u32,
}

impl Sum {
    pub(super) fn of(integrator: &Configured) -> Self {
        use brdf_sdk::ParamValue;
        let value = |key| integrator.values.get(key);
        Self {
            by_luminance: matches!(value("order"), Some(ParamValue::Choice(o)) if o == "luminance"),
            per_pass: match value("texels") {
                Some(ParamValue::Int(texels)) => u32::try_from(*texels).unwrap_or(0),
                _ => 0,
            },
        }
    }
}
