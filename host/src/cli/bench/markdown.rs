//! What is wrong with whom, scene by scene: a page of Markdown with a picture of each scene beside it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};

use super::table::seconds;
use crate::bench::{Pictured, Report};

/// The page; `path` is where it is written.
///
/// # Errors
/// Where the path has no name.
pub(super) fn page(report: &Report, path: &Path) -> Result<String> {
    let folder = folder(path)?;
    let folder = folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let folder = folder.unwrap_or_default();
    let mut text = String::new();
    for device in &report.devices {
        let _ = writeln!(
            text,
            "On {}, {} s a cell, seed {}.\n",
            device.name, report.limits.time, report.limits.seed
        );
        for case in &report.cases {
            let slug = slug(&case.name);
            let _ = writeln!(text, "### {}\n", case.name);
            if !case.about.is_empty() {
                let _ = writeln!(text, "{}\n", case.about);
            }
            let _ = writeln!(text, "![{}]({folder}/{slug}.png)\n", case.name);
            let _ = writeln!(
                text,
                "{}, {}; {} pixels; reference {}.\n",
                case.brdf, case.map, case.covered_pixels, case.reference_said
            );
            text += "| integrator | spp | time [s] | relMSE | its own estimate | bias / its error | what is wrong |\n|---|---|---|---|---|---|---|\n";
            for cell in report.ranked(&device.name, &case.name) {
                let faults = match cell.faults(case.reference_relmse) {
                    faults if faults.is_empty() => "–".to_owned(),
                    faults => format!("**{}**", faults.join("; ")),
                };
                let Some(last) = cell.last() else {
                    let _ = writeln!(text, "| `{}` | | | | | | {faults} |", cell.integrator);
                    continue;
                };
                let errors = &last.errors;
                let own = errors.estimate.map(|own| format!("{own:.1e}")).unwrap_or_default();
                let bias = errors.bias_std_error.filter(|error| *error > 0.0);
                let bias = bias.map(|error| format!("{:.1}", errors.bias / error));
                let _ = writeln!(
                    text,
                    "| `{}` | {} | {} | {:.1e} | {own} | {} | {faults} |",
                    cell.integrator,
                    last.spp,
                    seconds(last.seconds.median),
                    errors.relmse,
                    bias.unwrap_or_default(),
                );
            }
            text.push('\n');
        }
    }
    Ok(text)
}

/// Writes the references' pictures beside the page.
///
/// # Errors
/// Where the folder cannot be made or written.
pub(super) fn write_pictures(path: &Path, pictures: &[Pictured]) -> Result<()> {
    let folder = folder(path)?;
    std::fs::create_dir_all(&folder).map_err(|error| {
        Problem::new(
            folder.display().to_string(),
            format!("it cannot be made ({})", error.kind()),
            "name another place with --md",
        )
    })?;
    for one in pictures.iter().filter(|one| one.integrator.is_none()) {
        one.picture.stage(&folder.join(format!("{}.png", slug(&one.case))))?.keep()?;
    }
    Ok(())
}

/// Where the pictures of a page lie: `a` for `a.md`.
fn folder(path: &Path) -> Result<PathBuf> {
    let folder = path.with_extension("");
    match folder.file_name() {
        Some(_) => Ok(folder),
        None => Err(Problem::new(path.display().to_string(), "it has no name", "name a file")),
    }
}

/// A name that is good for files and links.
fn slug(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
    name.chars().map(plain).collect()
}
