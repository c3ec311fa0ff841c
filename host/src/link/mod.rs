//! Plugins and the host's shaders become one WGSL program, or one problem in the author's own file.
//!
//! `link` is a pure function: no files, no devices, no clock. It concatenates text, prefixes each
//! plugin's own names, parses and validates with naga, decides branches on constants, bounds the
//! plugins' loops and drops what nothing reaches. Both executors run the module that comes out.
//!
//! It may depend on brdf-sdk and naga; it knows nothing of how a program is run.

mod arrays;
mod budget;
mod constants;
mod declarations;
mod fold;
mod form;
mod function;
mod generated;
mod layout;
mod left_out;
mod messages;
mod purity;
mod shader;
mod signatures;
mod source_map;
mod tokens;
mod view;

use std::fmt;

use brdf_sdk::manifest::Array;
use brdf_sdk::{Kind, Place, Problem, Result};
use naga::compact::{KeepUnused, compact};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

use declarations::Cut;
pub use form::{Form, Sampler, Sum};
pub use function::{Function, functions, sampling, unused_parameters};
pub use layout::{Binding, BindingKind, StructLayout};
use source_map::SourceMap;
pub use view::View;

use crate::plugin::{Configured, Plugin};

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

/// A linked, validated, folded program with one entry point, `main`.
#[derive(Debug)]
pub struct Program {
    /// The module that executors run.
    pub module: naga::Module,
    /// The resources that it reaches, and no more.
    pub bindings: Vec<Binding>,
    /// Where BRDF samples come from.
    pub sampling: Sampling,
    /// The arrays that its BRDF's text and its sampler read, if they do.
    pub arrays: Vec<Array>,
    /// How it adds up terms over the environment's texels; `None` where it averages samples.
    pub sum: Option<Sum>,
    /// Whether its plugins have loops, which may use up their budget.
    pub has_loops: bool,
    /// Whether its integrator wants a compensated importance table.
    pub compensated: bool,
    /// What is worth telling the user once.
    pub notes: Vec<String>,
    /// The program as text, and what was left out of it.
    pub reached: left_out::Reached,
    /// Where each part of the text comes from.
    map: SourceMap,
}

impl Program {
    /// The layout of the struct that a variable holds or is an array of; `None` where the program
    /// does not reach the variable.
    pub fn layout(&self, variable: &str) -> Option<StructLayout> {
        layout::struct_layout(&self.module, variable)
    }

    /// The layout of a variable that every program of this view reaches.
    ///
    /// # Panics
    /// Where it does not: then the host's Rust and WGSL disagree.
    pub fn required_layout(&self, variable: &str) -> StructLayout {
        match self.layout(variable) {
            Some(layout) => layout,
            None => panic!("the host's shaders have no struct variable `{variable}`"),
        }
    }

    /// A problem at a place of the module, shown in the file that it comes from.
    pub fn problem(&self, span: naga::Span, reason: &str, cure: &str) -> Problem {
        match span.to_range() {
            Some(range) => self.map.problem(range, reason, cure),
            None => Problem::new("the linked program", reason, cure),
        }
    }

    /// naga's types of the module's expressions, which executors of the module ask for.
    ///
    /// # Errors
    /// None that linking has let through.
    pub fn types(&self) -> Result<ModuleInfo> {
        validate(&self.module, &self.map)
    }

    /// A construct that an executor does not run, at its place.
    pub fn refused(&self, refusal: &impl fmt::Display, span: naga::Span) -> Problem {
        self.problem(span, &refusal.to_string(), "write it another way")
    }

    /// Whether the program looks at the densities of the environment's texels.
    pub fn reads_densities(&self) -> bool {
        let mut names = self.module.functions.iter().filter_map(|(_, f)| f.name.as_deref());
        self.binds("env_ends") || names.any(|name| name == "env_light")
    }

    /// Whether the program binds a variable.
    pub fn binds(&self, variable: &str) -> bool {
        self.bindings.iter().any(|binding| binding.name == variable)
    }

    /// The bytes of a plugin's uniform; `None` where the program reaches none of its numbers.
    pub fn parameter_bytes(&self, configured: &Configured) -> Option<(String, Vec<u8>)> {
        use brdf_sdk::ParamValue;
        let name = generated::uniform_name(configured.plugin.manifest.kind);
        let layout = self.layout(name)?;
        let mut bytes = vec![0; layout.stride];
        for (key, value) in configured.values.iter() {
            match value {
                ParamValue::Float(number) => layout.write(&mut bytes, 0, key, &[*number as f32]),
                ParamValue::Int(number) => layout.write(&mut bytes, 0, key, &[*number as i32]),
                ParamValue::Color(rgb) => layout.write(&mut bytes, 0, key, &rgb.map(|c| c as f32)),
                ParamValue::Bool(_) | ParamValue::Choice(_) | ParamValue::File(_) => {}
            }
        }
        Some((name.to_owned(), bytes))
    }

    /// The file and the place that a part of the module comes from.
    pub fn origin(&self, span: naga::Span) -> Option<Origin> {
        let (file, range) = self.map.original(span.to_range()?)?;
        let place = Place::locate(&file.text, range);
        Some(Origin { file: file.label.clone(), place, is_author: file.prefix.is_some() })
    }
}

/// Where a part of a program comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The file's name in messages.
    pub file: String,
    /// Where in the file.
    pub place: Place,
    /// Whether it is a plugin's own file.
    pub is_author: bool,
}

/// Links one program.
///
/// # Errors
/// The first problem, in the author's file where an author can mend it.
pub fn link(view: &View) -> Result<Program> {
    // naga recurses along expressions; its stack is sized for the longest text that is let in.
    const STACK: usize = 512 << 20;
    std::thread::scope(|scope| {
        let linking =
            std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, || link_here(view));
        match linking.map(|thread| thread.join()) {
            Ok(Ok(linked)) => linked,
            Ok(Err(_)) => Err(Problem::new(
                "the linker",
                "the shader compiler failed on this program",
                "simplify the plugin's last change, and report the text that causes this",
            )),
            Err(error) => {
                Err(Problem::new("the linker", error.to_string(), "free memory and try again"))
            }
        }
    })
}

fn link_here(view: &View) -> Result<Program> {
    let mut map = SourceMap::default();
    let mut prefixes = Vec::new();
    let mut sampling = Sampling::Own;
    let mut arrays = Vec::new();
    let mut notes = Vec::new();
    let (mut sum, mut compensated) = (None, false);
    push_host(&mut map, &[shader::PRELUDE, shader::COSINE]);
    match view {
        View::Film { brdf, integrator, form } => {
            let cut = checked(brdf, Kind::Brdf)?;
            sampling = sampling_of(brdf, &cut, &mut notes);
            arrays = push_brdf(&mut map, brdf, &cut, sampling)?;
            push_host(&mut map, &[shader::SCATTER]);
            form.push(&mut map);
            let cut = checked(integrator, Kind::Integrator)?;
            push_plugin(&mut map, integrator, &cut, Sampling::Own)?;
            map.push(
                "the host's call of the integrator",
                &generated::integrator_adapter(integrator, &cut),
            );
            sum = cut.declares("term").then(|| Sum::of(integrator));
            compensated = integrator.plugin.manifest.compensated;
            push_host(&mut map, &[if sum.is_some() { shader::TERMS } else { shader::FILM }]);
            prefixes.extend([generated::prefix(brdf), generated::prefix(integrator)]);
        }
        View::Eval { brdf } => {
            let cut = checked(brdf, Kind::Brdf)?;
            sampling = sampling_of(brdf, &cut, &mut notes);
            arrays = push_brdf(&mut map, brdf, &cut, sampling)?;
            push_host(&mut map, &[shader::SCATTER, shader::LOOPS, shader::EVAL]);
            prefixes.push(generated::prefix(brdf));
        }
        View::Draws { brdf } => {
            let cut = checked(brdf, Kind::Brdf)?;
            sampling = sampling_of(brdf, &cut, &mut notes);
            arrays = push_brdf(&mut map, brdf, &cut, sampling)?;
            push_host(&mut map, &[shader::SCATTER, shader::LOOPS, shader::NUMBERS]);
            push_host(&mut map, &[shader::INDEPENDENT, shader::SETS, shader::DRAWS]);
            prefixes.push(generated::prefix(brdf));
        }
        View::Cells { brdf } => {
            let cut = checked(brdf, Kind::Brdf)?;
            sampling = sampling_of(brdf, &cut, &mut notes);
            arrays = push_brdf(&mut map, brdf, &cut, sampling)?;
            push_host(&mut map, &[shader::SCATTER, shader::CELLS_OF_LAWS]);
        }
        View::Numerics { brdf, function } => {
            let cut = checked(brdf, Kind::Brdf)?;
            sampling = sampling_of(brdf, &cut, &mut notes);
            arrays = push_brdf(&mut map, brdf, &cut, sampling)?;
            map.push("the host's choice of the function", &function.choice());
            push_host(&mut map, &[shader::SCATTER, shader::NUMERICS]);
        }
        View::Table { brdf, table } => {
            let cut = checked(brdf, Kind::Brdf)?;
            push_plugin(&mut map, brdf, &cut, Sampling::Own)?;
            map.push("the host's call of the fill", &generated::fill_adapter(brdf, *table));
            push_host(&mut map, &[shader::TABLE_FILL]);
        }
        View::LightDraws { form, compensated: of_table } => {
            compensated = *of_table;
            push_host(&mut map, &[shader::NUMBERS, shader::INDEPENDENT]);
            form.push_map(&mut map);
            push_host(&mut map, &[shader::TABLE, shader::LIGHT_DRAWS]);
        }
        View::LightDensities { form, compensated: of_table } => {
            compensated = *of_table;
            form.push_map(&mut map);
            push_host(&mut map, &[shader::TABLE, shader::LIGHT_DENSITIES]);
        }
        View::Background { form } => {
            form.push_map(&mut map);
            push_host(&mut map, &[shader::BACKGROUND]);
        }
    }
    let mut module = parse_and_validate(&map)?;
    fold::fold_constant_branches(&mut module);
    let has_loops = budget::bound_loops(&mut module, &prefixes);
    compact(&mut module, KeepUnused::No);
    validate(&module, &map)?;
    let cut = Cut::unbounded("the linked program", &map.text)?;
    Ok(Program {
        bindings: layout::bindings(&module),
        reached: left_out::reached(&map.text, &cut, &module),
        module,
        sampling,
        arrays,
        sum,
        compensated,
        has_loops,
        notes,
        map,
    })
}

/// Checks a plugin alone, with what is in its scope and nothing else.
fn checked(configured: &Configured, kind: Kind) -> Result<Cut> {
    let plugin = &configured.plugin;
    if plugin.manifest.kind != kind {
        return Err(Problem::new(
            &plugin.id,
            format!("this is a plugin of kind `{}`", plugin.manifest.kind.word()),
            format!("name one of kind `{}`", kind.word()),
        ));
    }
    let cut = Cut::new(&plugin.wgsl_file, &plugin.source)?;
    cut.check_plugin(&plugin.wgsl_file, &plugin.source)?;
    let generated = generated::parameter_names(configured);
    if let Some(taken) = cut.declarations.iter().find(|d| generated.contains(&d.name)) {
        return Err(Problem::at(
            &plugin.wgsl_file,
            &plugin.source,
            taken.name_span.clone(),
            format!("`{}` is already declared, from plugin.toml", taken.name),
            "rename it",
        ));
    }
    signatures::check_presence(plugin, &cut)?;
    constants::check_size(&plugin.wgsl_file, &plugin.source, &cut)?;

    let mut map = SourceMap::default();
    push_host(&mut map, &[shader::PRELUDE, shader::COSINE]);
    if kind == Kind::Integrator {
        map.push("the stand-in for a BRDF", generated::BRDF_STAND_IN);
        push_host(&mut map, &[shader::SCATTER]);
        Form::default().push(&mut map);
    }
    push_plugin(&mut map, configured, &cut, Sampling::Own)?;
    let module = parse_and_validate(&map).map_err(|problem| advised(problem, plugin, &cut))?;
    let prefix = generated::prefix(configured);
    purity::check(&module, &map, &prefix).map_err(|problem| named(problem, plugin))?;
    signatures::check_types(plugin, &cut, &module, &prefix)?;
    Ok(cut)
}

/// Problems without a place are the plugin's all the same.
fn named(problem: Problem, plugin: &Plugin) -> Problem {
    if problem.place.is_some() {
        return problem;
    }
    let cure = if problem.cure.is_empty() {
        "simplify the plugin's last change".to_owned()
    } else {
        problem.cure
    };
    Problem { thing: plugin.wgsl_file.clone(), cure, ..problem }
}

fn advised(problem: Problem, plugin: &Plugin, cut: &Cut) -> Problem {
    let problem = named(problem, plugin);
    let host: Vec<Cut> = shader::OF_INTEGRATORS
        .iter()
        .chain([&shader::SCATTER, &shader::FILM])
        .filter_map(|(label, text)| Cut::new(label, text).ok())
        .collect();
    match Cut::new(shader::PRELUDE.0, shader::PRELUDE.1) {
        Ok(prelude) => messages::with_cure(problem, plugin, cut, &prelude, &host),
        Err(_) => problem,
    }
}

fn sampling_of(brdf: &Configured, cut: &Cut, notes: &mut Vec<String>) -> Sampling {
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

/// The arrays that the BRDF's text reads, and its sampler.
fn push_brdf(
    map: &mut SourceMap,
    brdf: &Configured,
    cut: &Cut,
    sampling: Sampling,
) -> Result<Vec<Array>> {
    let arrays = push_plugin(map, brdf, cut, sampling)?;
    map.push("the host's call of the BRDF", &generated::brdf_adapter(brdf, cut, sampling));
    Ok(arrays)
}

fn push_plugin(
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
        push_host(map, &[shader::LOBES]);
    }
    if let Ok(own) = Cut::new("plugin.toml", &parameters) {
        map.push_renamed("the parameters of plugin.toml", &parameters, &own, &prefix, &[]);
    }
    map.push_renamed(&plugin.wgsl_file, &plugin.source, cut, &prefix, &names);
    Ok(arrays)
}

fn push_host(map: &mut SourceMap, shaders: &[(&str, &str)]) {
    for (label, text) in shaders {
        map.push(label, text);
    }
}

fn parse_and_validate(map: &SourceMap) -> Result<naga::Module> {
    let module = naga::front::wgsl::parse_str(&map.text)
        .map_err(|error| messages::parse_problem(map, &error))?;
    validate(&module, map)?;
    Ok(module)
}

fn validate(module: &naga::Module, map: &SourceMap) -> Result<ModuleInfo> {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .map_err(|error| messages::validation_problem(map, &error))
}
