//! `plugin.toml`, format 1: parsed once into typed data, with the author's place in every refusal.
//!
//! The manifest is all that the host knows of a plugin before it reads a line of its WGSL. Parsing
//! is pure: text in, [`Manifest`] or [`Problem`](crate::Problem) out; no file is opened here.

mod declared;
mod laws;
mod library;
mod param;
mod values;

pub use declared::{Filled, Preset, StateField};
pub use laws::{EnergyBound, Exception, Laws};
pub use library::{Array, Element, Lobes};
pub use param::{Param, ParamType, Scale};
pub use values::{ParamValue, ParamValues};

use crate::problem::Result;
use crate::reserved::RESERVED_WORDS;
use crate::table::{Document, Entry, Table, Value, suggestion};

/// The manifest format that this crate reads.
pub const FORMAT: i64 = 1;

/// The name of the manifest in a plugin's folder.
pub const MANIFEST_FILE: &str = "plugin.toml";

/// What a plugin provides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A reflectance function: `eval`, and `sample` with `pdf` where the model has structure.
    Brdf,
    /// An estimator of the outgoing radiance: `estimate`.
    Integrator,
}

/// A parsed `plugin.toml`.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// What the plugin provides.
    pub kind: Kind,
    /// Its name for people.
    pub name: String,
    /// One sentence on what it is.
    pub about: String,
    /// The formula in words, for the manual page.
    pub formula: Option<String>,
    /// Where the model comes from: author, year, title, equation.
    pub sources: Vec<String>,
    /// The WGSL file, relative to the plugin's folder.
    pub wgsl: String,
    /// The native library that fills the arrays: its name without prefix and ending, perhaps with the folder
    /// inside the plugin's that it lies in (`target/release/speckle`).
    pub library: Option<String>,
    /// What the library is asked for, where it serves several plugins: the folder's name, unless the manifest
    /// gives another.
    pub entry: String,
    /// The parameters whose values the library is handed.
    pub load: Vec<String>,
    /// The parameters, in the order of the file.
    pub params: Vec<Param>,
    /// Named sets of parameter values.
    pub presets: Vec<Preset>,
    /// What the plugin declares about the laws that every BRDF is held to.
    pub laws: Laws,
    /// Arrays that a native library fills and the WGSL reads.
    pub arrays: Vec<Array>,
    /// Which tables of `native::lobes` the library also gives, by which `lobe_sample` and `lobe_pdf` work.
    pub lobes: Option<Lobes>,
    /// Tables that the host fills by the author's own functions.
    pub tables: Vec<Filled>,
    /// Memory of an integrator that learns: one for each pixel and replicate.
    pub state: Vec<StateField>,
    /// Whether an integrator wants the environment's table without what another of its techniques samples
    /// well anyway (MIS compensation, Karlik et al. 2019).
    pub compensated: bool,
}

impl Kind {
    /// The word for it in manifests and folder names.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Brdf => "brdf",
            Kind::Integrator => "integrator",
        }
    }

    /// All kinds.
    pub const ALL: [Kind; 2] = [Kind::Brdf, Kind::Integrator];
}

impl Manifest {
    /// Parses the text of `plugin.toml`.
    ///
    /// `file` is its name in messages; `folder` the name of the plugin's folder, which names the
    /// WGSL file where the manifest does not.
    pub fn parse(file: &str, source: &str, folder: &str) -> Result<Self> {
        Document { file, source }.read(|table| Self::from_table(table, folder))
    }

    /// The parameters that name data files.
    pub fn files(&self) -> impl Iterator<Item = &Param> {
        self.params.iter().filter(|param| matches!(param.ty, ParamType::File { .. }))
    }

    /// The parameter of that key.
    pub fn param(&self, key: &str) -> Option<&Param> {
        self.params.iter().find(|param| param.key == key)
    }

    fn from_table(table: &Table<'_>, folder: &str) -> Result<Self> {
        check_format(table)?;
        let kind =
            kind_of(&table.require("kind", "`kind = \"brdf\"` or `kind = \"integrator\"`")?)?;
        let params = match table.get("params") {
            Some(value) => param::read_params(&value.table()?)?,
            None => Vec::new(),
        };
        let presets = match table.get("presets") {
            Some(value) => declared::read_presets(&value.table()?, &params)?,
            None => Vec::new(),
        };
        let library = table.get("library").map(|value| library_name(&value, kind)).transpose()?;
        let lobes = library::read_lobes(table, library.is_some())?;
        if library.is_none()
            && let Some(param) = params.iter().find(|p| matches!(p.ty, ParamType::File { .. }))
        {
            return Err(table.problem(
                table.get("params").map_or(0..0, |value| value.span()),
                format!(
                    "the file `{}` is read by a native library, and the manifest names none",
                    param.key
                ),
                "add `library = \"...\"` or remove the parameter",
            ));
        }
        Ok(Self {
            kind,
            name: non_empty(
                &table.require("name", "`name = \"...\"`, the plugin's name for people")?,
            )?,
            about: non_empty(&table.require("about", "`about = \"...\"`, one sentence")?)?,
            formula: table.get("formula").map(|value| value.string()).transpose()?,
            sources: match table.get("sources") {
                Some(value) => value.strings()?,
                None => Vec::new(),
            },
            wgsl: match table.get("wgsl") {
                Some(value) => wgsl_path(&value)?,
                None => format!("{folder}.wgsl"),
            },
            laws: laws::read_laws(table, kind, &params, &presets)?,
            entry: library::read_entry(table, library.is_some(), folder)?,
            load: library::read_load(table, library.is_some(), &params)?,
            arrays: library::read_arrays(table, library.is_some(), lobes)?,
            lobes,
            tables: declared::read_tables(table, kind)?,
            state: declared::read_state(table, kind)?,
            compensated: declared::read_compensated(table, kind)?,
            library,
            params,
            presets,
        })
    }
}

/// Refuses formats that this program does not know; a file without the key has format 1.
pub fn check_format(table: &Table<'_>) -> Result<()> {
    match table.get("format") {
        Some(value) if value.integer()? != FORMAT => Err(value.problem(
            "this format is not known to this version",
            format!("write `format = {FORMAT}`, or use a newer version of the program"),
        )),
        _ => Ok(()),
    }
}

fn kind_of(value: &Value<'_>) -> Result<Kind> {
    let word = value.string()?;
    Kind::ALL.into_iter().find(|kind| kind.word() == word).ok_or_else(|| {
        value.problem(
            format!("there is no plugin kind `{word}`"),
            suggestion(&word, Kind::ALL.iter().map(|kind| kind.word())),
        )
    })
}

fn non_empty(value: &Value<'_>) -> Result<String> {
    let text = value.string()?;
    if text.trim().is_empty() {
        return Err(value.problem("this text is empty", "write what a reader needs to know"));
    }
    Ok(text)
}

/// A path inside the plugin's folder: relative, with `/`, and without `..`.
fn inner_path(value: &Value<'_>) -> Result<String> {
    let path = value.string()?;
    let inside = !path.is_empty()
        && !path.contains(['\\', ':'])
        && path.split('/').all(|part| !matches!(part, "" | "." | ".."));
    if !inside {
        return Err(value.problem(
            format!("the path `{path}` leaves the plugin's folder"),
            "name a file inside it, such as \"model.wgsl\"",
        ));
    }
    Ok(path)
}

/// The name of a library, as cargo's `[lib] name` has it: systems add their own prefix and ending.
fn library_name(value: &Value<'_>, kind: Kind) -> Result<String> {
    if kind != Kind::Brdf {
        return Err(value.problem("only a BRDF has a native library", "remove `library`"));
    }
    let path = inner_path(value)?;
    let name = path.rsplit('/').next().unwrap_or_default();
    if !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
        return Err(value.problem(
            format!("`{path}` is no name of a library"),
            "write the name alone, such as \"target/release/speckle\" for libspeckle.so",
        ));
    }
    Ok(path)
}

fn wgsl_path(value: &Value<'_>) -> Result<String> {
    let path = inner_path(value)?;
    if !path.ends_with(".wgsl") {
        return Err(value.problem(
            format!("`{path}` is no WGSL file by its name"),
            "name a file that ends in .wgsl",
        ));
    }
    Ok(path)
}

/// The entries of a table whose keys become names in WGSL: lower case, digits and `_`, and no word of the language.
fn named_in_wgsl<'a>(table: &Table<'a>) -> Result<Vec<Entry<'a>>> {
    let entries = table.entries();
    for Entry { key, key_span, .. } in &entries {
        let well_formed = key.starts_with(|c: char| c.is_ascii_lowercase())
            && key.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        if !well_formed {
            return Err(table.problem(
                key_span.clone(),
                format!("`{key}` cannot be a name in WGSL"),
                "use lower-case letters, digits and `_`, beginning with a letter",
            ));
        }
        if RESERVED_WORDS.contains(&key.as_str()) {
            return Err(table.problem(
                key_span.clone(),
                format!("`{key}` is a reserved word of WGSL"),
                "choose another name",
            ));
        }
    }
    Ok(entries)
}
