//! The page: a table of all BRDFs, and a section on each.

use brdf_sdk::manifest::{Exception, Preset};
use brdf_sdk::{Param, ParamType, ParamValue};

use super::escape::{code, markdown, url};
use super::folder::PICTURES;
use super::lobe::{END, VIEWS};
use super::{Entry, INTEGRATOR, RECIPE, sphere};
use crate::link::Function;

/// The page of these entries.
pub fn page(entries: &[Entry]) -> String {
    let mut page = format!("{}\n{}", head(), overview(entries));
    page.extend(entries.iter().map(section));
    page
}

fn head() -> String {
    let [a, b, c] = VIEWS;
    let (spp, stops) = (sphere::SPP, sphere::STOPS);
    format!(
        "# Catalogue of BRDFs\n\n\
         The BRDFs as their plugin folders describe them. This page and its pictures are written by \
         `brdf docs`: change a text in the BRDF's `plugin.toml`, then write them again. `brdf docs --check` \
         tells what is out of date. `brdf render NAME --preset PRESET` renders any of these, \
         `brdf conform NAME` proves it.\n\n\
         **Spheres** have the default parameters and lie under the recipe `{RECIPE}` as in `brdf render`, at \
         {stops} stops, by `{INTEGRATOR}` with {spp} samples a pixel.\n\n\
         **Lobes** are the luminance of f, without the cosine, in the plane of normal and tangent, for \
         viewers at {a}, {b} and {c} degrees on the left. Each curve is drawn against its own peak, which is \
         written beside it, and its radius is the cube root of f / peak, so that narrow and wide lobes can \
         both be seen: rings stand at 1, 1/10, 1/100 and 1/1000 of the peak. Circles are the viewers, dashed \
         lines their mirror directions. Curves end at {END} degrees.\n"
    )
}

fn overview(entries: &[Entry]) -> String {
    let column = |title: &'static str, cell: &dyn Fn(&Entry) -> String| {
        (title, entries.iter().map(cell).collect::<Vec<_>>())
    };
    // The picture shares its cell with the name, whose words keep the column wide enough for it.
    table(&[
        column("BRDF", &|entry| {
            let (anchor, picture) = (url(&entry.plugin.id), picture(entry, "png"));
            let name = markdown(&entry.plugin.manifest.name);
            format!(
                "<a href=\"#{anchor}\"><img src=\"{picture}\" width=\"64\" alt=\"\"></a><br>[{name}](#{anchor})"
            )
        }),
        column("Name", &|entry| code(&entry.plugin.id, true)),
        column("What it is", &|entry| markdown(first_sentence(&entry.plugin.manifest.about))),
        column("Sampling", &|entry| {
            if brings_sampling(entry) { "its own" } else { "cosine" }.to_owned()
        }),
        column("Exceptions", &|entry| {
            let laws = &entry.plugin.manifest.laws;
            let reciprocity = laws.not_reciprocal.iter().map(|_| "not reciprocal".to_owned());
            let energy = laws.energy.iter().map(|energy| format!("albedo up to {}", energy.bound));
            let steps = laws.not_continuous.iter().map(|_| "not continuous".to_owned());
            let negative = laws.negative.iter().map(|_| "negative where asked for".to_owned());
            reciprocity.chain(energy).chain(steps).chain(negative).collect::<Vec<_>>().join(", ")
        }),
    ])
}

/// Up to the first full stop; a colon or a semicolon does not end a sentence.
fn first_sentence(text: &str) -> &str {
    text.find(". ").map_or(text, |end| &text[..=end])
}

fn section(entry: &Entry) -> String {
    let manifest = &entry.plugin.manifest;
    let (id, name) = (&entry.plugin.id, markdown(&manifest.name));
    let mut section = format!(
        "\n## <a id=\"{}\"></a>{name} ({})\n\n{}\n\n",
        url(id),
        code(id, false),
        markdown(&manifest.about)
    );
    if let Some(formula) = &manifest.formula {
        section.push_str(&format!("{}\n\n", code(formula, false)));
    }
    section.push_str(&format!(
        "![{name} on a sphere]({}) ![Lobes of {name}]({})\n\n",
        picture(entry, "png"),
        picture(entry, "svg")
    ));
    if entry.left_out > 0 {
        section.push_str(&format!(
            "The curves leave out {} directions in which f is negative or not finite.\n\n",
            entry.left_out
        ));
    }
    section.push_str(&parameters(&manifest.params));
    section.push_str(&presets(&manifest.presets));
    section.push_str(&declared(entry));
    if !manifest.sources.is_empty() {
        section.push_str("\nSources:\n\n");
        section.extend(manifest.sources.iter().map(|source| format!("- {}\n", markdown(source))));
    }
    section
}

fn parameters(params: &[Param]) -> String {
    if params.is_empty() {
        return "It has no parameters.\n".to_owned();
    }
    let column = |title: &'static str, cell: &dyn Fn(&Param) -> String| {
        (title, params.iter().map(cell).collect::<Vec<_>>())
    };
    table(&[
        column("Parameter", &|param| code(&param.key, true)),
        column("Label", &|param| param.label.as_deref().map(markdown).unwrap_or_default()),
        column("Type", &|param| param.ty.word().to_owned()),
        column("Range", &limits),
        column("Default", &|param| value(&ParamValue::default_of(param))),
        column("Unit", &|param| param.unit.as_deref().map(markdown).unwrap_or_default()),
        column("Meaning", &|param| markdown(&param.about)),
    ])
}

fn limits(param: &Param) -> String {
    match &param.ty {
        ParamType::Float { range: [min, max], .. } | ParamType::Color { range: [min, max], .. } => {
            format!("{min} to {max}")
        }
        ParamType::Int { range: [min, max], .. } => format!("{min} to {max}"),
        ParamType::Bool { .. } => "true or false".to_owned(),
        ParamType::Choice { options, .. } => {
            options.iter().map(|option| code(option, true)).collect::<Vec<_>>().join(", ")
        }
        ParamType::File { extensions, .. } => markdown(&extensions.join(", ")),
    }
}

fn value(value: &ParamValue) -> String {
    match value {
        ParamValue::Color([r, g, b]) => format!("{r}, {g}, {b}"),
        ParamValue::Choice(text) | ParamValue::File(text) => code(text, true),
        number => number.to_string(),
    }
}

fn presets(presets: &[Preset]) -> String {
    if presets.is_empty() {
        return String::new();
    }
    let column = |title: &'static str, cell: &dyn Fn(&Preset) -> String| {
        (title, presets.iter().map(cell).collect::<Vec<_>>())
    };
    let values = |preset: &Preset| {
        let set = preset.values.iter().map(|(key, value)| code(&format!("{key}={value}"), true));
        set.collect::<Vec<_>>().join(" ")
    };
    let table = table(&[
        column("Preset", &|preset| code(&preset.name, true)),
        column("What it shows", &|preset| {
            preset.about.as_deref().map(markdown).unwrap_or_default()
        }),
        column("Values", &values),
    ]);
    format!("\n{table}")
}

/// How it is sampled, and what it declares about the laws.
fn declared(entry: &Entry) -> String {
    let laws = &entry.plugin.manifest.laws;
    let mut list = vec![match brings_sampling(entry) {
        true => {
            let own = entry.functions.iter().filter(|f| **f != Function::Eval);
            // In the order of the contract, which is not that of the alphabet.
            let order = [Function::Sample, Function::Pdf, Function::Weight];
            let mut own: Vec<_> = own.collect();
            own.sort_by_key(|function| order.iter().position(|f| f == *function));
            let names: Vec<_> = own.iter().map(|f| format!("`{}`", f.name())).collect();
            format!("Sampling: it brings {}.", listed(&names))
        }
        false => "Sampling: it brings none, and the host draws from the cosine.".to_owned(),
    }];
    if let Some(reason) = &laws.not_reciprocal {
        list.push(format!("Not reciprocal: {}", markdown(reason)));
    }
    if let Some(energy) = &laws.energy {
        list.push(format!("Albedo up to {}: {}", energy.bound, markdown(&energy.reason)));
    }
    for (what, exception) in [("Not continuous", &laws.not_continuous), ("Below 0", &laws.negative)]
    {
        if let Some(Exception { values, reason }) = exception {
            let set: Vec<_> =
                values.iter().map(|(key, value)| code(&format!("{key}={value}"), true)).collect();
            list.push(format!("{what} with {}: {}", listed(&set), markdown(reason)));
        }
    }
    if list.len() == 1 {
        list.push("Laws: it declares no exception.".to_owned());
    }
    if let Some(white) = &laws.white {
        list.push(format!("The preset with the largest albedo is {}.", code(white, false)));
    }
    list.iter().fold(String::from("\n"), |text, line| format!("{text}- {line}\n"))
}

fn brings_sampling(entry: &Entry) -> bool {
    entry.functions.contains(&Function::Sample)
}

fn listed(names: &[String]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}

fn picture(entry: &Entry, ending: &str) -> String {
    format!("{PICTURES}/{}.{ending}", url(&entry.plugin.id))
}

/// A table by its columns; one without any word in its cells is left out.
fn table(columns: &[(&str, Vec<String>)]) -> String {
    let columns: Vec<_> =
        columns.iter().filter(|(_, cells)| cells.iter().any(|cell| !cell.is_empty())).collect();
    let row = |cells: &mut dyn Iterator<Item = &str>| {
        cells.fold(String::from("|"), |line, cell| format!("{line} {cell} |")) + "\n"
    };
    let rows = columns.first().map_or(0, |(_, cells)| cells.len());
    let mut text = row(&mut columns.iter().map(|(title, _)| *title));
    text.push_str(&row(&mut columns.iter().map(|_| "---")));
    for index in 0..rows {
        text.push_str(&row(&mut columns.iter().map(|(_, cells)| cells[index].as_str())));
    }
    text
}
