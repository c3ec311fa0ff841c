//! The text of a program: what each view is made of, one part after the other, and what its plugins say to the host.
//!
//! It puts texts together and checks each plugin alone; the whole is parsed by the caller.

use brdf_sdk::manifest::Array;
use brdf_sdk::{Kind, Result};

use super::alone::checked;
use super::declarations::Cut;
use super::sampling::{Sampling, sampling_of};
use super::source_map::SourceMap;
use super::{Sum, View, arrays, generated, shader};
use crate::plugin::Configured;

/// A text, and what is known of it.
pub struct Text {
    /// The text, and where each part of it comes from.
    pub map: SourceMap,
    /// Prefixes of its plugins, whose loops are bounded where shaders/loops.wgsl is in the text.
    pub prefixes: Vec<String>,
    /// Where BRDF samples come from.
    pub sampling: Sampling,
    /// The arrays that its BRDF's text and its sampler read.
    pub arrays: Vec<Array>,
    /// How it adds up terms.
    pub sum: Option<Sum>,
    /// Whether a compensated importance table is wanted.
    pub compensated: bool,
    /// What is worth telling the user once.
    pub notes: Vec<String>,
}

impl Text {
    /// The text of a view.
    pub fn of(view: &View) -> Result<Self> {
        let mut text = Self {
            map: SourceMap::default(),
            prefixes: Vec::new(),
            sampling: Sampling::Own,
            arrays: Vec::new(),
            sum: None,
            compensated: false,
            notes: Vec::new(),
        };
        text.host(&[shader::PRELUDE, shader::COSINE]);
        match view {
            View::Film { brdf, integrator, form } => {
                text.brdf(brdf)?;
                text.host(&[shader::SCATTER]);
                form.push(&mut text.map);
                text.integrator(integrator)?;
            }
            View::Eval { brdf } => {
                text.brdf(brdf)?;
                text.host(&[shader::SCATTER, shader::LOOPS, shader::EVAL]);
            }
            View::Draws { brdf } => {
                text.brdf(brdf)?;
                text.host(&[shader::SCATTER, shader::LOOPS, shader::NUMBERS]);
                text.host(&[shader::INDEPENDENT, shader::SETS, shader::DRAWS]);
            }
            View::Cells { brdf } => {
                text.brdf(brdf)?;
                text.host(&[shader::SCATTER, shader::CELLS_OF_LAWS]);
            }
            View::Numerics { brdf, function } => {
                text.brdf(brdf)?;
                text.map.push("the host's choice of the function", &function.choice());
                text.host(&[shader::SCATTER, shader::NUMERICS]);
            }
            View::Table { brdf, table } => {
                let cut = checked(brdf, Kind::Brdf)?;
                push_plugin(&mut text.map, brdf, &cut, Sampling::Own)?;
                let fill = generated::fill_adapter(brdf, *table);
                text.map.push("the host's call of the fill", &fill);
                text.host(&[shader::TABLE_FILL]);
            }
            View::LightDraws { form, compensated } => {
                text.compensated = *compensated;
                text.host(&[shader::NUMBERS, shader::INDEPENDENT]);
                form.push_map(&mut text.map);
                text.host(&[shader::TABLE, shader::LIGHT_DRAWS]);
            }
            View::LightDensities { form, compensated } => {
                text.compensated = *compensated;
                form.push_map(&mut text.map);
                text.host(&[shader::TABLE, shader::LIGHT_DENSITIES]);
            }
            View::Background { form } => {
                form.push_map(&mut text.map);
                text.host(&[shader::BACKGROUND]);
            }
        }
        Ok(text)
    }

    fn host(&mut self, shaders: &[(&str, &str)]) {
        self.map.push_all(shaders);
    }

    /// A BRDF, its sampler, and the adapter that `scatter.wgsl` calls.
    fn brdf(&mut self, brdf: &Configured) -> Result<()> {
        let cut = checked(brdf, Kind::Brdf)?;
        self.sampling = sampling_of(brdf, &cut, &mut self.notes);
        self.arrays = push_plugin(&mut self.map, brdf, &cut, self.sampling)?;
        let adapter = generated::brdf_adapter(brdf, &cut, self.sampling);
        self.map.push("the host's call of the BRDF", &adapter);
        self.prefixes.push(generated::prefix(brdf));
        Ok(())
    }

    /// An integrator, and the kernel for its kind: samples, or terms.
    fn integrator(&mut self, integrator: &Configured) -> Result<()> {
        let cut = checked(integrator, Kind::Integrator)?;
        push_plugin(&mut self.map, integrator, &cut, Sampling::Own)?;
        let adapter = generated::integrator_adapter(integrator, &cut);
        self.map.push("the host's call of the integrator", &adapter);
        self.prefixes.push(generated::prefix(integrator));
        self.sum = cut.declares("term").then(|| Sum::of(integrator));
        self.compensated = integrator.plugin.manifest.compensated;
        self.host(&[if self.sum.is_some() { shader::TERMS } else { shader::FILM }]);
        Ok(())
    }
}

/// A plugin's text with its names prefixed, behind what its manifest declares; returns the arrays that it reads.
pub fn push_plugin(
    map: &mut SourceMap,
    configured: &Configured,
    cut: &Cut,
    sampling: Sampling,
) -> Result<Vec<Array>> {
    let plugin = &configured.plugin;
    let prefix = generated::prefix(configured);
    let names = generated::parameter_names(configured);
    let parameters = generated::parameters(configured);
    if let Some(accessors) = generated::table_accessors(configured) {
        map.push("the tables of plugin.toml", &accessors);
    }
    // Where a library gives tables to sample by, they are not made again.
    let fitted = sampling == Sampling::Fitted && plugin.manifest.lobes.is_none();
    let arrays = match fitted {
        true => arrays::with_lobes(plugin)?,
        false => plugin.manifest.arrays.clone(),
    };
    if let Some(accessors) = arrays::accessors(&arrays) {
        map.push("the arrays of plugin.toml", &accessors);
    }
    if fitted || plugin.manifest.lobes.is_some() {
        map.push("the lobes of plugin.toml", &generated::lobes(plugin.manifest.lobes));
        map.push_all(&[shader::LOBES]);
    }
    if let Ok(own) = Cut::new("plugin.toml", &parameters) {
        map.push_renamed("the parameters of plugin.toml", &parameters, &own, &prefix, &[]);
    }
    map.push_renamed(&plugin.wgsl_file, &plugin.source, cut, &prefix, &names);
    Ok(arrays)
}
