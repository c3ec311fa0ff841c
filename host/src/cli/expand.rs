//! `brdf expand`: the linked program as text.

use brdf_sdk::{Kind, Result};

use super::parameters::Parameters;
use super::print;
use crate::link::{Form, View, link};
use crate::registry::Registry;
use crate::session::Chosen;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A BRDF's name or folder
    brdf: String,
    /// An integrator's name or folder
    #[arg(default_value = "brdf-is")]
    integrator: String,
    #[command(flatten)]
    parameters: Parameters,
    /// Set a parameter of the integrator
    #[arg(long, value_name = "KEY=VALUE", allow_hyphen_values = true)]
    iset: Vec<String>,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<()> {
    let mut brdf = Chosen::find(registry, Kind::Brdf, &arguments.brdf)?.configured;
    let mut integrator =
        Chosen::find(registry, Kind::Integrator, &arguments.integrator)?.configured;
    arguments.parameters.apply(&mut brdf)?;
    integrator.assign(&arguments.iset)?;
    let program = link(&View::Film { brdf, integrator, form: Form::default() })?;
    let bound: Vec<_> = program
        .bindings
        .iter()
        .map(|binding| format!("{} {}", binding.index, binding.name))
        .collect();
    let mut text = program.reached.text.clone();
    let mut list = |title: &str, names: &[String]| {
        if !names.is_empty() {
            text.push_str(&format!("\n// {title}:\n"));
            names.iter().for_each(|name| text.push_str(&format!("//   {name}\n")));
        }
    };
    list("Bound", &bound);
    list("Left out, since nothing reaches it", &program.reached.left_out);
    list(
        "Above, but only behind branches that constants decide: not in the program",
        &program.reached.folded_away,
    );
    for note in &program.notes {
        text.push_str(&format!("// note: {note}\n"));
    }
    print(&text)
}
