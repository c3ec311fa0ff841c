//! `scene.toml` -> scene: section by section, keys that it leaves out at their default.

use std::path::Path;

use brdf_sdk::manifest::check_format;
use brdf_sdk::table::{Document, Table};
use brdf_sdk::{Kind, ParamValue, Result};

use super::paths::from_folder;
use super::values::{count, one_of, one_of_all, positive, set};
use super::{Chosen, Light, Output, Session};
use crate::registry::Registry;
use crate::render::{MAX_REPLICATES, MAX_SAMPLES};
use crate::scene::Camera;

impl Session {
    /// Reads `scene.toml`; paths in it are relative to `folder`, keys that it leaves out keep their default.
    pub fn parse(registry: &Registry, file: &str, source: &str, folder: &Path) -> Result<Self> {
        Document { file, source }.read(|table| {
            check_format(table)?;
            let mut session = Self::new(registry)?;
            section(table, "brdf", |section| {
                set(&mut session.place, section.get("place"), |v| Ok(count(v, 0)? as usize))?;
                read_plugin(registry, Kind::Brdf, section, folder, &mut session.brdf)
            })?;
            section(table, "integrator", |section| {
                read_plugin(registry, Kind::Integrator, section, folder, &mut session.integrator)
            })?;
            if let Some(value) = table.get("beside") {
                for item in value.items()? {
                    let section = item.table()?;
                    section.require("plugin", "the name or the folder of a BRDF")?;
                    let mut chosen = session.brdf.clone();
                    read_plugin(registry, Kind::Brdf, &section, folder, &mut chosen)?;
                    section.finish()?;
                    session.beside.push(chosen);
                }
            }
            session.place = session.place.min(session.beside.len());
            section(table, "environment", |s| read_light(s, folder, &mut session.environment))?;
            section(table, "shape", |s| {
                let value = s.require(
                    "kind",
                    "`kind = \"sphere\"`, torus, plane, teapot, or a mesh's path",
                )?;
                session.shape = from_folder(folder, value.string()?);
                Ok(())
            })?;
            section(table, "camera", |s| read_camera(s, &mut session.camera))?;
            section(table, "film", |s| read_output(s, &mut session.film))?;
            section(table, "stopping", |s| read_stopping(s, &mut session))?;
            Ok(session)
        })
    }
}

/// Reads one section, if it is there, and refuses what it does not know.
fn section(
    table: &Table<'_>,
    key: &str,
    read: impl FnOnce(&Table<'_>) -> Result<()>,
) -> Result<()> {
    let Some(value) = table.get(key) else { return Ok(()) };
    let section = value.table()?;
    read(&section)?;
    section.finish()
}

fn read_plugin(
    registry: &Registry,
    kind: Kind,
    section: &Table<'_>,
    folder: &Path,
    chosen: &mut Chosen,
) -> Result<()> {
    if let Some(value) = section.get("plugin") {
        let name = value.string()?;
        let reference = from_folder(folder, name);
        *chosen =
            Chosen::find(registry, kind, &reference).map_err(|problem| match problem.place {
                Some(_) => problem,
                None => {
                    value.problem(format!("{}: {}", problem.thing, problem.reason), problem.cure)
                }
            })?;
    }
    if kind == Kind::Brdf {
        set(&mut chosen.configured.fit_sampler, section.get("fit_sampler"), |v| v.boolean())?;
    }
    if let Some(value) = section.get("params") {
        let params = value.table()?;
        let manifest = chosen.configured.plugin.manifest.clone();
        let values = &mut chosen.configured.values;
        values.set_table(&manifest, &params)?;
        for entry in params.entries() {
            if let Some(ParamValue::File(path)) = values.get(&entry.key)
                && !path.is_empty()
            {
                let path = folder.join(path).display().to_string();
                values.set(&entry.key, ParamValue::File(path));
            }
        }
        params.finish()?;
    }
    Ok(())
}

fn read_light(s: &Table<'_>, folder: &Path, light: &mut Light) -> Result<()> {
    if let Some(value) = s.get("map") {
        light.map = from_folder(folder, value.string()?);
    }
    set(&mut light.phi, s.get("phi"), |v| v.number())?;
    set(&mut light.theta, s.get("theta"), |v| v.number())?;
    set(&mut light.replace_bad_texels, s.get("replace_bad_texels"), |v| v.boolean())?;
    set(&mut light.lighting.filter, s.get("filter"), one_of)?;
    set(&mut light.lighting.weighting, s.get("weighting"), one_of)?;
    set(&mut light.arrangement, s.get("read_as"), |v| one_of(v).map(Some))?;
    set(&mut light.layout, s.get("layout"), |v| one_of(v).map(Some))?;
    set(&mut light.face, s.get("face"), |v| Ok(Some(count(v, 1)?)))?;
    set(&mut light.width, s.get("width"), |v| Ok(Some(count(v, 1)?)))
}

fn read_camera(s: &Table<'_>, camera: &mut Camera) -> Result<()> {
    set(&mut camera.yaw, s.get("yaw"), |v| v.number())?;
    set(&mut camera.pitch, s.get("pitch"), |v| v.number())?;
    set(&mut camera.distance, s.get("distance"), |v| v.number())?;
    set(&mut camera.fov, s.get("fov"), |v| v.number())?;
    set(&mut camera.shift, s.get("shift"), |v| v.numbers())?;
    camera.check().map_err(|problem| s.problem(s.span(), problem.reason, problem.cure))
}

fn read_output(s: &Table<'_>, film: &mut Output) -> Result<()> {
    set(&mut film.resolution, s.get("resolution"), |v| {
        let items = v.items()?;
        match items.as_slice() {
            [width, height] => Ok([count(width, 1)?, count(height, 1)?]),
            _ => Err(v.problem("a resolution has two entries", "write [width, height]")),
        }
    })?;
    set(&mut film.tone.exposure, s.get("exposure"), |v| v.number())?;
    set(&mut film.tone.curve, s.get("curve"), one_of)?;
    set(&mut film.background, s.get("background"), |v| one_of_all(v, "background"))
}

fn read_stopping(s: &Table<'_>, session: &mut Session) -> Result<()> {
    let Session { effort, stop, sampler, .. } = session;
    set(&mut effort.samples, s.get("samples"), |v| {
        let samples = count(v, 1)?;
        match samples <= MAX_SAMPLES {
            true => Ok(samples),
            false => Err(v.problem(
                format!("{samples} samples a pass exceed {MAX_SAMPLES}"),
                "take more passes instead",
            )),
        }
    })?;
    set(&mut effort.replicates, s.get("replicates"), |v| {
        let replicates = count(v, 1)?;
        match replicates <= MAX_REPLICATES {
            true => Ok(replicates),
            false => Err(
                v.problem(format!("{replicates} replicates exceed {MAX_REPLICATES}"), "take fewer")
            ),
        }
    })?;
    set(&mut stop.time, s.get("time"), |v| Ok(Some(positive(v)?)))?;
    set(&mut stop.error, s.get("error"), |v| Ok(Some(positive(v)?)))?;
    if stop.time.is_some() || stop.error.is_some() {
        effort.passes = None;
    }
    set(&mut effort.passes, s.get("passes"), |v| Ok(Some(count(v, 1)?)))?;
    set(sampler, s.get("sampler"), one_of)?;
    set(&mut effort.seed, s.get("seed"), |v| count(v, 0))
}
