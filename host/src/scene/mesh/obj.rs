//! Wavefront OBJ -> soup: v, vt, vn and f.
//!
//! All else is passed over: groups, which are merged, materials, smoothing, lines, points, curves.
//! Each combination of position, uv and normal that a face names is one vertex; what a corner does
//! not name is missing at that vertex alone. `polygon` cuts faces into triangles.

use std::collections::HashMap;

use brdf_sdk::{Problem, Result};
use glam::{DVec2, DVec3, Vec3};

use super::{Soup, check_count, polygon};

const REPAIR: &str = "repair the vertex";

/// What a face's corner names, by place in [`Corner`].
const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Numbers of a position, uv and normal, from 1; 0 where a corner names none.
type Corner = [u32; 3];

/// Reads the text of an OBJ file; `thing` names it in problems.
pub(super) fn parse(thing: &str, bytes: &[u8]) -> Result<Soup> {
    // Names and comments may be in any encoding; what matters is ASCII.
    let mut text = String::from_utf8_lossy(bytes);
    if !text.contains('\n') {
        text = text.replace('\r', "\n").into();
    }
    let mut file = File { thing, text: &text, ..File::default() };
    for words in statements(text.trim_start_matches('\u{feff}')) {
        file.read(&words)?;
    }
    file.check()?;
    Ok(file.soup())
}

/// The statements, each as its words: `#` begins a comment, a line that ends in `\` goes on in the
/// next.
fn statements(text: &str) -> impl Iterator<Item = Vec<&str>> {
    fn is_comment(word: &&str) -> bool {
        word.starts_with('#')
    }
    let mut lines = text.lines();
    std::iter::from_fn(move || {
        let mut line = lines.next()?;
        let mut words = Vec::new();
        while let Some(part) = line.trim_end().strip_suffix('\\') {
            if part.split_whitespace().any(|word| is_comment(&word)) {
                break;
            }
            words.extend(part.split_whitespace());
            line = lines.next().unwrap_or_default();
        }
        words.extend(line.split_whitespace().take_while(|word| !is_comment(word)));
        Some(words)
    })
}

/// What was read so far.
#[derive(Default)]
struct File<'a> {
    thing: &'a str,
    text: &'a str,
    positions: Vec<DVec3>,
    uvs: Vec<DVec2>,
    normals: Vec<DVec3>,
    /// Corners of all faces, and how many each face has.
    corners: Vec<Corner>,
    sizes: Vec<usize>,
    /// The largest numbers that faces name, and where: they may come before what they name.
    largest: [(u32, &'a str); 3],
}

impl<'a> File<'a> {
    fn read(&mut self, words: &[&'a str]) -> Result<()> {
        let Some((key, words)) = words.split_first() else { return Ok(()) };
        match *key {
            "v" => self.positions.push(self.position(key, words)?),
            "vt" => self.uvs.push(self.uv(key, words)?),
            "vn" => self.normals.push(self.normal(key, words)?),
            "f" => self.face(key, words)?,
            _ => {}
        }
        Ok(())
    }

    /// A problem at a word, which is a slice of the text and so knows its place.
    fn at(&self, word: &str, reason: impl Into<String>, cure: &str) -> Problem {
        let start = word.as_ptr() as usize - self.text.as_ptr() as usize;
        Problem::at(self.thing, self.text, start..start + word.len(), reason, cure)
    }

    /// In f32, so that vertices of a seam that differ by their last printed digits are one place.
    fn position(&self, key: &str, words: &[&str]) -> Result<DVec3> {
        let number = |word: &str| {
            let reason = || format!("\"{word}\" is not a finite coordinate");
            let value = word.parse().ok().filter(|value: &f32| value.is_finite());
            value.ok_or_else(|| self.at(word, reason(), REPAIR))
        };
        let &[x, y, z, ..] = words else {
            return Err(self.at(key, "a vertex needs x, y and z", REPAIR));
        };
        let position = Vec3::new(number(x)?, number(y)?, number(z)?);
        // Four numbers are x y z w; any others after the third are colours.
        let &[_, _, _, w] = words else { return Ok(position.as_dvec3()) };
        let divided = position / number(w)?;
        match divided.is_finite() {
            true => Ok(divided.as_dvec3()),
            false => Err(self.at(w, "dividing by w gives no finite vertex", REPAIR)),
        }
    }

    fn uv(&self, key: &str, words: &[&str]) -> Result<DVec2> {
        match *words {
            [] => Err(self.at(key, "a texture coordinate needs u", "export the file again")),
            [u] => Ok(DVec2::new(self.number(u)?, 0.0)),
            [u, v, ..] => Ok(DVec2::new(self.number(u)?, self.number(v)?)),
        }
    }

    fn normal(&self, key: &str, words: &[&str]) -> Result<DVec3> {
        let &[x, y, z, ..] = words else {
            return Err(self.at(key, "a normal needs x, y and z", "export the normals again"));
        };
        Ok(DVec3::new(self.number(x)?, self.number(y)?, self.number(z)?))
    }

    /// A number that may be NaN: uv and normals that cannot be used count as missing.
    fn number(&self, word: &str) -> Result<f64> {
        let failed = |_| self.at(word, format!("\"{word}\" is not a number"), "repair the line");
        word.parse().map_err(failed)
    }

    fn face(&mut self, key: &str, words: &[&'a str]) -> Result<()> {
        for word in words {
            let corner = self.corner(word).map_err(|reason| self.out_of_range(word, reason))?;
            for (largest, number) in self.largest.iter_mut().zip(corner) {
                if number > largest.0 {
                    *largest = (number, word);
                }
            }
            self.corners.push(corner);
        }
        if words.len() < 3 {
            return Err(self.at(key, "a face needs three vertices", "remove the face"));
        }
        self.sizes.push(words.len());
        Ok(())
    }

    fn out_of_range(&self, word: &str, reason: String) -> Problem {
        self.at(word, reason, "count from 1, or back from the last with -1")
    }

    /// Reads v, v/vt, v//vn or v/vt/vn.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let no_corner =
            || format!("\"{word}\" is not a corner of a face (v, v/vt, v//vn or v/vt/vn)");
        let seen = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [0; 3];
        for (i, part) in word.split('/').enumerate() {
            let number = corner.get_mut(i).ok_or_else(no_corner)?;
            if part.is_empty() {
                continue;
            }
            let index: i64 = part.parse().map_err(|_| format!("\"{part}\" is not an index"))?;
            let from_start = if index < 0 { seen[i] as i64 + 1 + index } else { index };
            let found = u32::try_from(from_start).ok().filter(|found| *found > 0);
            let (name, seen) = (NAMES[i], seen[i]);
            let reason = || format!("{name} {index} is out of range: {seen} stand before it");
            *number = found.ok_or_else(reason)?;
        }
        if corner[0] == 0 { Err(no_corner()) } else { Ok(corner) }
    }

    /// Whether there are faces, and all that they name.
    fn check(&self) -> Result<()> {
        let fail = |reason: &str, cure: &str| Err(Problem::new(self.thing, reason, cure));
        let totals = [self.positions.len(), self.uvs.len(), self.normals.len()];
        if totals[0] == 0 {
            let reason = "is not an OBJ file: it has no vertices (lines \"v x y z\")";
            return fail(reason, "choose another file, or export it again");
        }
        if self.sizes.is_empty() {
            return fail("has no faces (lines \"f a b c\")", "export the mesh with its faces");
        }
        for ((name, total), (number, word)) in NAMES.iter().zip(totals).zip(self.largest) {
            if number as usize > total {
                let reason = format!("{name} {number} is out of range: the file has {total}");
                return Err(self.out_of_range(word, reason));
            }
        }
        check_count(self.thing, self.sizes.iter().map(|size| size - 2).sum())
    }

    /// The triangles, once all is checked.
    fn soup(&self) -> Soup {
        let mut soup = Soup::default();
        let mut vertex_of = HashMap::new();
        let mut rest = self.corners.as_slice();
        for &size in &self.sizes {
            let (face, others) = rest.split_at(size);
            rest = others;
            let mut vertex = |&corner| {
                *vertex_of.entry(corner).or_insert_with(|| self.append(&mut soup, corner))
            };
            let vertices: Vec<u32> = face.iter().map(&mut vertex).collect();
            let places: Vec<DVec3> = vertices.iter().map(|v| soup.positions[*v as usize]).collect();
            let triangles = polygon::triangles(&places);
            soup.triangles.extend(triangles.into_iter().map(|t| t.map(|corner| vertices[corner])));
        }
        soup
    }

    /// Adds a vertex and gives its number.
    fn append(&self, soup: &mut Soup, [v, vt, vn]: Corner) -> u32 {
        fn named<T: Copy>(values: &[T], number: u32) -> Option<T> {
            values.get((number as usize).checked_sub(1)?).copied()
        }
        let vertex = soup.positions.len() as u32;
        soup.positions.extend(named(&self.positions, v));
        soup.uvs.push(named(&self.uvs, vt).unwrap_or(DVec2::NAN));
        soup.normals.push(named(&self.normals, vn).unwrap_or(DVec3::ZERO));
        vertex
    }
}
