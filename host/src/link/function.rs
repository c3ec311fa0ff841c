//! The functions of a BRDF, one by one.

use brdf_sdk::{Param, Result};
use serde::Serialize;

use super::declarations::Cut;
use super::sampling::{Sampling, sampling_of};
use super::tokens::TokenKind;
use crate::plugin::{Configured, Plugin};

/// One of the functions that an author of a BRDF writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Function {
    /// f_r [1/sr].
    Eval,
    /// Density of `sample` [1/sr].
    Pdf,
    /// A direction.
    Sample,
    /// f cos / pdf.
    Weight,
}

impl Function {
    /// All of them.
    pub const ALL: [Function; 4] =
        [Function::Eval, Function::Pdf, Function::Sample, Function::Weight];

    /// Its name in WGSL.
    pub fn name(self) -> &'static str {
        match self {
            Function::Eval => "eval",
            Function::Pdf => "pdf",
            Function::Sample => "sample",
            Function::Weight => "weight",
        }
    }

    /// The constants by which `views/numerics.wgsl` calls it.
    pub(super) fn choice(self) -> String {
        let names = Self::ALL.iter().enumerate();
        let mut text: String = names
            .map(|(index, f)| {
                format!("const FUNCTION_{}: u32 = {index}u;\n", f.name().to_uppercase())
            })
            .collect();
        text.push_str(&format!("const FUNCTION: u32 = FUNCTION_{};\n", self.name().to_uppercase()));
        text
    }
}

/// The functions that the author gave and the host calls; notes say where it samples by the cosine.
///
/// # Errors
/// Where the text cannot be taken apart; all else is found while linking.
pub fn functions(brdf: &Configured) -> Result<(Vec<Function>, Vec<String>)> {
    let cut = Cut::new(&brdf.plugin.wgsl_file, &brdf.plugin.source)?;
    let mut notes = Vec::new();
    let own = sampling_of(brdf, &cut, &mut notes) == Sampling::Own;
    let called = |function: &Function| match function {
        Function::Eval => true,
        Function::Pdf | Function::Sample => own,
        Function::Weight => own && cut.declares("weight"),
    };
    Ok((Function::ALL.into_iter().filter(called).collect(), notes))
}

/// The parameters that the author's text never names.
///
/// # Errors
/// Where the text cannot be taken apart.
pub fn unused_parameters(plugin: &Plugin) -> Result<Vec<String>> {
    let cut = Cut::new(&plugin.wgsl_file, &plugin.source)?;
    let words: Vec<(&str, bool)> = cut
        .tokens
        .iter()
        .enumerate()
        .filter(|(_, token)| token.kind == TokenKind::Word)
        .map(|(index, token)| (token.text(&plugin.source), cut.is_member(index)))
        .collect();
    let is_read = |param: &&Param| match param.constant_names().first() {
        Some(constant) => words.contains(&(constant.as_str(), false)),
        None => words.contains(&(param.key.as_str(), true)),
    };
    // What a native library is handed is read there.
    let handed = |param: &&Param| plugin.manifest.load.contains(&param.key);
    let params = plugin.manifest.params.iter().filter(|param| !handed(param));
    Ok(params.filter(|param| !is_read(param)).map(|param| param.key.clone()).collect())
}
