//! Wavefront OBJ -> soup, by tobj, behind a scan that knows lines.
//!
//! tobj reports no line, reads polylines as faces, panics on some bad relative indices and on short
//! material lines. The scan checks every face against the file's counts, names line and column, and
//! hands tobj only what it needs: v, vt, vn, f and the names of groups. Polygons are cut into fans,
//! which suits convex ones. All groups are merged.

use brdf_sdk::{Problem, Result};
use glam::{DVec2, DVec3};

use super::{Soup, check_count};

/// Reads the text of an OBJ file; `thing` names it in problems.
pub(super) fn parse(thing: &str, bytes: &[u8]) -> Result<Soup> {
    // Names and comments may be in any encoding; what matters is ASCII.
    let text = String::from_utf8_lossy(bytes);
    let essence = scan(thing, &text)?;
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) =
        tobj::load_obj_buf(&mut essence.as_bytes(), &options, no_materials).map_err(|error| {
            Problem::new(thing, format!("is not a valid OBJ file: {error}"), "export it again")
        })?;
    let mut soup = Soup::default();
    for model in models {
        append(&mut soup, &model.mesh);
    }
    Ok(soup)
}

/// Adds one of tobj's meshes.
fn append(soup: &mut Soup, mesh: &tobj::Mesh) {
    let triple = |v: &[f32]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let first = soup.positions.len() as u32;
    let vertices = mesh.positions.len() / 3;
    soup.positions.extend(mesh.positions.chunks_exact(3).map(triple));
    let total = soup.positions.len();
    // Where only some faces of a group name normals or uv, tobj's arrays no longer match its
    // vertices; such a group counts as having none.
    if mesh.normals.len() == 3 * vertices {
        soup.normals.extend(mesh.normals.chunks_exact(3).map(triple));
    }
    if mesh.texcoords.len() == 2 * vertices {
        let pair = |v: &[f32]| DVec2::new(v[0].into(), v[1].into());
        soup.uvs.extend(mesh.texcoords.chunks_exact(2).map(pair));
    }
    soup.normals.resize(total, DVec3::ZERO);
    soup.uvs.resize(total, DVec2::NAN);
    let corners = mesh.indices.chunks_exact(3);
    soup.triangles.extend(corners.map(|t| [first + t[0], first + t[1], first + t[2]]));
}

/// Checks vertices and faces, and returns the lines that tobj shall read.
fn scan(thing: &str, text: &str) -> Result<String> {
    fn keyword(line: &str) -> &str {
        line.split_whitespace().next().unwrap_or_default()
    }
    let count = |key: &str| text.lines().filter(|line| keyword(line) == key).count() as i64;
    let totals = [count("v"), count("vt"), count("vn")];
    if totals[0] == 0 {
        return Err(Problem::new(
            thing,
            "is not an OBJ file: it has no vertices (lines \"v x y z\")",
            "choose another file, or export it again",
        ));
    }
    let mut essence = String::with_capacity(text.len());
    let mut seen = [0_i64; 3];
    let mut triangles = 0;
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let key = words.next().unwrap_or_default();
        // A problem at one word of this line; words are slices of `text`, so they know their place.
        let at = |word: &str, reason: String, cure: &str| {
            let start = word.as_ptr() as usize - text.as_ptr() as usize;
            Problem::at(thing, text, start..start + word.len(), reason, cure)
        };
        match key {
            "v" => {
                seen[0] += 1;
                let words: Vec<&str> = words.collect();
                for word in words.iter().take(3) {
                    if !word.parse().is_ok_and(f32::is_finite) {
                        let reason = format!("\"{word}\" is not a finite coordinate");
                        return Err(at(word, reason, "repair the vertex"));
                    }
                }
                if words.len() < 3 {
                    return Err(at(key, "a vertex needs x, y and z".into(), "repair the vertex"));
                }
                // Four numbers are x y z w; any others after the third are colours.
                let kept = if words.len() == 4 { 4 } else { 3 };
                essence.push_str("v ");
                essence.push_str(&words[..kept].join(" "));
                essence.push('\n');
                continue;
            }
            "vt" => seen[1] += 1,
            "vn" => seen[2] += 1,
            "f" => {
                let mut corners = 0_usize;
                for word in words {
                    corners += 1;
                    check_corner(word, totals, seen).map_err(|reason| {
                        at(word, reason, "count from 1, or back from the last with -1")
                    })?;
                }
                if corners < 3 {
                    let reason = "a face needs three vertices".into();
                    return Err(at(key, reason, "remove the face"));
                }
                triangles += corners - 2;
            }
            "o" | "g" => {}
            _ => continue,
        }
        essence.push_str(line);
        essence.push('\n');
    }
    if triangles == 0 {
        return Err(Problem::new(
            thing,
            "has no faces (lines \"f a b c\")",
            "export the mesh with its faces",
        ));
    }
    check_count(thing, triangles)?;
    Ok(essence)
}

/// Whether one corner of a face, v/vt/vn, points at what the file has.
fn check_corner(word: &str, totals: [i64; 3], seen: [i64; 3]) -> Result<(), String> {
    let names = ["vertex", "texture coordinate", "normal"];
    let parts: Vec<&str> = word.split('/').collect();
    if parts.len() > 3 || parts[0].is_empty() {
        return Err(format!("\"{word}\" is not a corner of a face (v, v/vt, v//vn or v/vt/vn)"));
    }
    for (i, part) in parts.iter().enumerate().filter(|(_, part)| !part.is_empty()) {
        let index: i64 = part.parse().map_err(|_| format!("\"{part}\" is not an index"))?;
        let valid = (1..=totals[i]).contains(&index) || (-seen[i]..=-1).contains(&index);
        if !valid {
            let (name, total) = (names[i], totals[i]);
            return Err(format!("{name} {index} is out of range: the file has {total}"));
        }
    }
    Ok(())
}
