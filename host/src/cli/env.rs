//! `brdf env`: what there is to know about an environment map, and the map in another layout or format.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use brdf_sdk::{Problem, Result};
use serde_json::json;

use super::conform::mark;
use super::{Verdict as Exit, print};
use crate::conformance::{Outcome, Verdict, light};
use crate::environment::orientation::world_from_map;
use crate::environment::{Environment, Facts, Form, Purpose, face_paths, pack};
use crate::exec::{self, Precision};
use crate::layout::{Arrangement, Layout, Reading, word};
use crate::open;
use crate::picture::{self, MapFormat};
use crate::registry::Registry;
use crate::session::Light;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A map: .hdr, .exr, .ptx or .toml, six files with a % (probe_%.hdr), or a recipe's name
    file: String,
    /// Write the map here, as .exr (32-bit floats) or .hdr; a % writes six files, px to nz
    #[arg(short, long, value_name = "PATH")]
    output: Option<PathBuf>,
    /// The layout that is written: lat-long, cube (the same as strip-col), cross-h, cross-v, strip-row, strip-col
    /// [default: as it is]
    #[arg(long, value_name = "LAYOUT", hide_possible_values = true)]
    layout: Option<Arrangement>,
    /// The side of a cube's faces in texels [default: its own, or a quarter of the width]
    #[arg(long, value_name = "N")]
    face: Option<u32>,
    /// The width of a lat-long map in texels [default: its own, or four faces]
    #[arg(long, value_name = "N")]
    width: Option<u32>,
    /// How the file is to be read: auto, lat-long, cross-h, cross-v, strip-row, strip-col, openexr-lat-long,
    /// openexr-cube [default: by its content and shape]
    #[arg(long, value_name = "LAYOUT")]
    env_layout: Option<Reading>,
    /// Replace NaN and negative texels by 0, infinite ones by the map's largest value
    #[arg(long)]
    replace_bad_texels: bool,
    /// Hold the sampler to the map's density, for both filters and both tables: the law of sampling
    #[arg(long)]
    conform: bool,
    /// With --conform: the device that is judged, by its index or a part of its name; `cpu` for the cores
    #[arg(long, value_name = "DEVICE", requires = "conform")]
    device: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(registry: &Registry, arguments: &Arguments) -> Result<Exit> {
    let outputs = outputs(arguments)?;
    let map = open(registry, arguments)?;
    let facts = map.facts();
    let mut wrote = Vec::new();
    if let (Some(path), false) = (&arguments.output, outputs.is_empty()) {
        let arrangement = written(arguments, map.layout);
        wrote.push(format!(
            "{} ({}, {})",
            path.display(),
            if outputs.len() == 6 { "six files".to_owned() } else { word(&arrangement) },
            size_of(&map)
        ));
        write(&map, arrangement, &outputs)?;
    }
    let map = Arc::new(map);
    let (verdicts, judged) = match arguments.conform {
        true => proved(&map, arguments.device.as_deref())?,
        false => Default::default(),
    };
    match arguments.json {
        true => {
            let mut object = serde_json::to_value(&facts).unwrap_or_default();
            object["name"] = map.name.clone().into();
            object["notes"] = map.notes.clone().into();
            let paths: Vec<_> = outputs.iter().map(|path| path.display().to_string()).collect();
            object["wrote"] = json!(paths);
            if arguments.conform {
                let rows = verdicts.iter().map(
                    |(purpose, verdict)| json!({ "table": table(purpose), "verdict": verdict }),
                );
                object["sampling"] = json!({ "device": judged, "laws": rows.collect::<Vec<_>>() });
            }
            print(&format!("{object}\n"))?;
        }
        false => {
            print(&text(&map, &facts, &wrote))?;
            if arguments.conform {
                print(&proof(&verdicts, &judged))?;
            }
        }
    }
    let fails = |(_, verdict): &(Purpose, Verdict)| verdict.outcome == Outcome::Failed;
    Ok(if verdicts.iter().any(fails) { Exit::Failed } else { Exit::Passed })
}

/// What the law of sampling says of the map, and the device that it was said of.
fn proved(
    map: &Arc<Environment>,
    device: Option<&str>,
) -> Result<(Vec<(Purpose, Verdict)>, String)> {
    let opened = exec::open(device, Precision::F32)?;
    opened.note.iter().for_each(|note| eprintln!("note: {note}"));
    let mut executor = opened.executor;
    // Turned by odd angles, so that nothing lies along an axis.
    let world_from_map = world_from_map(33.0, 17.0);
    let verdicts = light(executor.as_mut(), map, world_from_map)?;
    executor.take_notes().iter().for_each(|note| eprintln!("note: {note}"));
    Ok((verdicts, executor.name().to_owned()))
}

/// The filter that a table is for, and whether it is compensated.
fn table(purpose: &Purpose) -> String {
    let compensated = if purpose.compensated { ", compensated" } else { "" };
    format!("{}{compensated}", word(&purpose.filter))
}

fn proof(verdicts: &[(Purpose, Verdict)], device: &str) -> String {
    let mut text = format!("  sampling on {device}\n");
    for (purpose, verdict) in verdicts {
        let (mark, said) = (mark(verdict.outcome), &verdict.said);
        text.push_str(&format!("    {mark:<6} {:<20} {said}\n", table(purpose)));
        for line in verdict.reproduce.iter().chain(&verdict.notes) {
            text.push_str(&format!("           {line}\n"));
        }
    }
    text
}

/// The map in the layout and size that were asked for.
fn open(registry: &Registry, arguments: &Arguments) -> Result<Environment> {
    let path = Path::new(&arguments.file);
    let is_recipe = match path.exists() {
        true => path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")),
        false => registry.recipe(&arguments.file).is_some(),
    };
    let layout = arguments.layout.map(Arrangement::layout);
    let layout = layout.or_else(|| six_files(arguments).then_some(Layout::Cube));
    // A recipe is evaluated at the width that is wanted, any other map is made so wide.
    let of_recipe = arguments.width.filter(|_| is_recipe);
    let light = Light {
        map: arguments.file.clone(),
        width: of_recipe,
        replace_bad_texels: arguments.replace_bad_texels,
        arrangement: arguments.env_layout.and_then(|reading| reading.0),
        ..Light::default()
    };
    let map = open::environment(registry, &light)?;
    let width = arguments.width.filter(|_| !is_recipe);
    map.in_form(Form { layout, face: arguments.face, width })
}

fn six_files(arguments: &Arguments) -> bool {
    let name = arguments.output.as_ref().and_then(|path| path.file_name());
    name.is_some_and(|name| name.to_string_lossy().contains('%'))
}

/// The files to be written; refused before any work where they cannot be.
fn outputs(arguments: &Arguments) -> Result<Vec<PathBuf>> {
    let Some(path) = &arguments.output else { return Ok(Vec::new()) };
    let layout = arguments.layout;
    if matches!(layout, Some(Arrangement::OpenExrLatLong | Arrangement::OpenExrCube)) {
        return Err(Problem::new(
            format!("--layout {}", layout.as_ref().map(word).unwrap_or_default()),
            "this is read, and not written",
            "write lat-long or cube, whose pixels are areas",
        ));
    }
    if six_files(arguments) && layout.is_some_and(|layout| layout != Arrangement::StripCol) {
        return Err(Problem::new(
            path.display().to_string(),
            "a % writes a cube as six files",
            "leave out --layout, or name one file",
        ));
    }
    let paths = match six_files(arguments) {
        true => face_paths(path).to_vec(),
        false => vec![path.clone()],
    };
    let inputs =
        [vec![PathBuf::from(&arguments.file)], crate::environment::files_of(&arguments.file)]
            .concat();
    let same =
        |a: &Path, b: &Path| a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b));
    for path in &paths {
        MapFormat::of(path)?;
        picture::check_writable(path)?;
        if inputs.iter().any(|input| same(input, path)) {
            return Err(Problem::new(
                path.display().to_string(),
                "the new map would replace the one that it is made from",
                "give it another name",
            ));
        }
    }
    Ok(paths)
}

fn written(arguments: &Arguments, layout: Layout) -> Arrangement {
    arguments.layout.unwrap_or(match layout {
        Layout::LatLong => Arrangement::LatLong,
        Layout::Cube => Arrangement::StripCol,
    })
}

fn write(map: &Environment, arrangement: Arrangement, paths: &[PathBuf]) -> Result<()> {
    let (width, texels) = match map.layout {
        Layout::LatLong => (map.width, map.texels.to_vec()),
        Layout::Cube => {
            let (width, _, texels) = pack(&map.texels, map.width, arrangement);
            (width, texels)
        }
    };
    // All are written before the first gets its name.
    let parts = texels.chunks(texels.len() / paths.len());
    let staged = paths.iter().zip(parts).map(|(path, part)| picture::stage_map(path, width, part));
    staged.collect::<Result<Vec<_>>>()?.into_iter().try_for_each(picture::Staged::keep)
}

fn size_of(map: &Environment) -> String {
    match map.layout {
        Layout::LatLong => format!("{}x{}", map.width, map.height),
        Layout::Cube => format!("faces of {0}x{0}", map.width),
    }
}

fn text(map: &Environment, facts: &Facts, wrote: &[String]) -> String {
    let percent = facts.brightest.map(|share| 100.0 * share);
    let [r, g, b] = facts.mean_radiance;
    let mut text = format!(
        "{}: {}, {}, ready in {:.3} s\n  \
         luminance from {:.4e} to {:.4e}, mean over the sphere {:.5e}\n  \
         mean radiance over the sphere {r:.5e} {g:.5e} {b:.5e}\n  \
         the brightest texels' share of the energy: 1: {:.3} %, 10: {:.3} %, 100: {:.3} %, 1000: {:.3} %\n  \
         {} texels above 65504, the range of 16-bit floats; {} black texels\n",
        map.name,
        facts.layout,
        size_of(map),
        facts.seconds,
        facts.min,
        facts.max,
        facts.mean,
        percent[0],
        percent[1],
        percent[2],
        percent[3],
        facts.above_f16,
        facts.black,
    );
    for note in &map.notes {
        text.push_str(&format!("  note: {note}\n"));
    }
    for path in wrote {
        text.push_str(&format!("  wrote {path}\n"));
    }
    text
}

/// The words of `--layout` are those of the arrangements that are written.
#[cfg(test)]
mod tests {
    use clap::ValueEnum;

    use super::*;

    #[test]
    fn the_help_names_every_layout() {
        use clap::CommandFactory;
        let mut command = super::super::Cli::command();
        let env = command.find_subcommand_mut("env").unwrap();
        let help = env.render_long_help().to_string();
        for arrangement in Arrangement::value_variants() {
            assert!(help.contains(&word(arrangement)), "{arrangement:?} is not in {help}");
        }
    }
}
