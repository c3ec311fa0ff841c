//! Which integrator, how fast and how wrong, scene by scene: a page of Markdown with a picture of each scene beside it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};
use image::{RgbImage, imageops};

use super::table::{done, seconds, times};
use crate::bench::{CaseReport, CellReport, Limits, PLAIN, Pictured, Report};
use crate::picture::{Raster, make_folder};

/// The page; `path` is where it is written.
///
/// # Errors
/// Where the path has no name.
pub(super) fn page(report: &Report, path: &Path) -> Result<String> {
    let folder = folder(path)?;
    let folder = folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let folder = folder.unwrap_or_default();
    let mut text = format!(
        "# Speed against error\n\nMade by `brdf bench` {}; docs/bench.md says what is measured and how.\n\n",
        report.version
    );
    for device in &report.devices {
        let Limits { time, seed, .. } = report.limits;
        let _ = writeln!(
            text,
            "On {}: {time} s a cell, seed {seed}; the kernel that is the same everywhere makes {:.1} million samples a second ({:.1} to {:.1}).{}\n",
            device.name,
            device.calibration.median,
            device.calibration.low,
            device.calibration.high,
            if device.disturbed { " **The machine was disturbed.**" } else { "" }
        );
        text += &winners(report, &device.name);
        for case in &report.cases {
            text += &scene(report, &device.name, case, &folder);
        }
    }
    Ok(text)
}

/// Which integrator for which scene, in one look.
fn winners(report: &Report, device: &str) -> String {
    let target = report.limits.target;
    let mut text = format!(
        "| scene | to use | 1 / (MSE s) over `{PLAIN}` | relMSE | s to {target:.0e} | what is wrong with it |\n\
         |---|---|---|---|---|---|\n"
    );
    for case in &report.cases {
        let ranked = report.ranked(device, &case.name);
        let Some((best, last)) = ranked.first().and_then(|best| Some((best, best.last()?))) else {
            let _ = writeln!(text, "| {} | none | | | | |", case.name);
            continue;
        };
        let _ = writeln!(
            text,
            "| [{}](#{}) | `{}` | {} | {:.1e} | {} | {} |",
            case.name,
            anchor(&heading(report, device, case)),
            best.integrator,
            best.over_plain.map(times).unwrap_or_default(),
            last.errors.relmse,
            best.seconds_to_target.map(seconds).unwrap_or_default(),
            faults(best, case),
        );
    }
    text + "\n"
}

/// No two headings of a page are the same.
fn heading(report: &Report, device: &str, case: &CaseReport) -> String {
    match report.devices.len() {
        1 => case.name.clone(),
        _ => format!("{} on {device}", case.name),
    }
}

fn faults(cell: &CellReport, case: &CaseReport) -> String {
    match cell.faults(case.reference_relmse) {
        faults if faults.is_empty() => "–".to_owned(),
        faults => format!("**{}**", faults.join("; ")),
    }
}

/// A scene with its picture, and all that was measured of it.
fn scene(report: &Report, device: &str, case: &CaseReport, folder: &str) -> String {
    let mut text = format!("### {}\n\n", heading(report, device, case));
    if !case.about.is_empty() {
        let _ = writeln!(text, "{}\n", case.about);
    }
    let _ = writeln!(text, "![{}]({folder}/{})\n", case.name, picture(case));
    let _ = writeln!(
        text,
        "{}, {}; {} pixels; reference {}.\n",
        case.brdf, case.map, case.covered_pixels, case.reference_said
    );
    let _ = writeln!(
        text,
        "| integrator | spp | time [s] | M samples/s | relMSE | its own estimate | bias / its error | s to {:.0e} | × `{PLAIN}` | what is wrong |\n\
         |---|---|---|---|---|---|---|---|---|---|",
        report.limits.target
    );
    for cell in report.ranked(device, &case.name) {
        let faults = faults(cell, case);
        let Some(last) = cell.last() else {
            let _ = writeln!(text, "| `{}` | | | | | | | | | {faults} |", cell.integrator);
            continue;
        };
        let errors = &last.errors;
        let own = errors.estimate.map(|own| format!("{own:.1e}")).unwrap_or_default();
        let bias = errors.bias_std_error.filter(|error| *error > 0.0);
        let bias = bias.map(|error| format!("{:.1}", errors.bias / error));
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {:.1e} | {own} | {} | {} | {} | {faults} |",
            cell.integrator,
            done(cell, last),
            seconds(last.seconds.median),
            cell.rate.map(|rate| format!("{:.1}", rate.median)).unwrap_or_default(),
            errors.relmse,
            bias.unwrap_or_default(),
            cell.seconds_to_target.map(seconds).unwrap_or_default(),
            cell.over_plain.map(times).unwrap_or_default(),
        );
    }
    text.push('\n');
    text
}

/// Writes the references' pictures beside the page.
///
/// # Errors
/// Where the folder cannot be made or written.
pub(super) fn write_pictures(report: &Report, pictures: &[Pictured], path: &Path) -> Result<()> {
    let folder = folder(path)?;
    make_folder(&folder, "name another place with --md")?;
    for case in &report.cases {
        let of = |one: &&Pictured| one.integrator.is_none() && one.case == case.name;
        if let Some(one) = pictures.iter().find(of) {
            thumbnail(&one.picture).stage(&folder.join(picture(case)))?.keep()?;
        }
    }
    Ok(())
}

/// Points that a picture is wide at the most.
const SIDE: u32 = 192;

/// A picture, smaller where it is wider than that.
fn thumbnail(picture: &Raster) -> Raster {
    let [width, height] = picture.resolution;
    let factor = width.div_ceil(SIDE);
    let Some(whole) = RgbImage::from_raw(width, height, picture.rgb.as_flattened().to_vec()) else {
        return picture.clone();
    };
    let resolution = [width, height].map(|side| (side / factor).max(1));
    let small = imageops::thumbnail(&whole, resolution[0], resolution[1]);
    Raster { resolution, rgb: small.pixels().map(|pixel| pixel.0).collect() }
}

/// The file of a scene's picture: scenes with the same reference share it.
fn picture(case: &CaseReport) -> String {
    let hash: String = case.reference.chars().take(8).collect();
    format!("{hash}.png")
}

/// Where the pictures of a page lie: `a` for `a.md`.
fn folder(path: &Path) -> Result<PathBuf> {
    let folder = path.with_extension("");
    match folder.file_name() {
        Some(_) => Ok(folder),
        None => Err(Problem::new(path.display().to_string(), "it has no name", "name a file")),
    }
}

/// What a heading is called in links, as the usual readers of Markdown make it.
fn anchor(name: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let plain = |c: char| if c == ' ' { '-' } else { c.to_ascii_lowercase() };
    name.chars().filter(kept).map(plain).collect()
}
