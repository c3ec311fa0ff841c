//! The text before a Radiance picture's scanlines.

use brdf_sdk::{Problem, Result};

/// What the four bytes of a texel mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pixels {
    Rgbe,
    Xyze,
}

/// Everything that a header says about its texels' values and places.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Columns, as claimed.
    pub width: u64,
    /// Rows, as claimed.
    pub height: u64,
    pub pixels: Pixels,
    /// The product of all EXPOSURE lines; stored value = radiance x exposure.
    pub exposure: f64,
    /// The product of all COLORCORR lines, which were multiplied in like the exposure.
    pub colour_correction: [f64; 3],
    /// The last PRIMARIES line: x and y of red, green, blue and white.
    pub primaries: Option<[f64; 8]>,
    /// `+Y`: the first scanline is the lowest.
    pub bottom_up: bool,
    /// `-X`: a scanline runs from right to left.
    pub right_to_left: bool,
}

impl Header {
    /// What was applied, in words.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.exposure != 1.0 {
            notes.push(format!("divided by the file's EXPOSURE {}", self.exposure));
        }
        if self.colour_correction != [1.0; 3] {
            let [r, g, b] = self.colour_correction;
            notes.push(format!("divided by the file's COLORCORR {r} {g} {b}"));
        }
        notes
    }
}

/// Reads the header; also gives the offset of the first scanline.
pub fn read(name: &str, bytes: &[u8]) -> Result<(Header, usize)> {
    let mut header = Header {
        width: 0,
        height: 0,
        pixels: Pixels::Rgbe,
        exposure: 1.0,
        colour_correction: [1.0; 3],
        primaries: None,
        bottom_up: false,
        right_to_left: false,
    };
    let mut lines = Lines { bytes, at: 0 };
    let cut = || Problem::new(name, "the file ends in its header", "fetch it again");
    lines.next().ok_or_else(cut)?;
    loop {
        let line = lines.next().ok_or_else(cut)?;
        if line.is_empty() {
            break;
        }
        // Keys start their lines: an indented one belongs to a picture that this one was made from.
        let Some((key, value)) = line.split_once('=') else { continue };
        match key {
            "FORMAT" => header.pixels = pixels(name, value.trim())?,
            "EXPOSURE" => header.exposure *= factors::<1>(name, &line, value)?[0],
            "COLORCORR" => {
                let factors = factors::<3>(name, &line, value)?;
                header.colour_correction.iter_mut().zip(factors).for_each(|(all, one)| *all *= one);
            }
            "PRIMARIES" => header.primaries = Some(numbers::<8>(name, &line, value)?),
            _ => {}
        }
    }
    let line = lines.next().ok_or_else(cut)?;
    let parts: Vec<&str> = line.split_whitespace().collect();
    let size = |text: &str| text.parse::<u64>().ok().filter(|size| *size > 0);
    let unknown = || {
        Problem::new(
            name,
            format!(
                "the resolution line `{}` is not of the form `-Y height +X width`",
                clip(&line)
            ),
            "turn the picture upright and write it again",
        )
    };
    let [y, rows, x, columns] = parts[..] else { return Err(unknown()) };
    if !matches!(y, "-Y" | "+Y") || !matches!(x, "+X" | "-X") {
        return Err(unknown());
    }
    header.height = size(rows).ok_or_else(unknown)?;
    header.width = size(columns).ok_or_else(unknown)?;
    header.bottom_up = y == "+Y";
    header.right_to_left = x == "-X";
    Ok((header, lines.at))
}

/// Lines up to a line feed; the last needs one as well.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Lines<'_> {
    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|byte| *byte == b'\n')?;
        self.at += length + 1;
        let line = String::from_utf8_lossy(&rest[..length]);
        Some(line.trim_end_matches('\r').to_owned())
    }
}

fn pixels(name: &str, format: &str) -> Result<Pixels> {
    match format {
        "32-bit_rle_rgbe" => Ok(Pixels::Rgbe),
        "32-bit_rle_xyze" => Ok(Pixels::Xyze),
        _ => Err(Problem::new(
            name,
            format!("its FORMAT is `{}`", clip(format)),
            "convert it to 32-bit_rle_rgbe or 32-bit_rle_xyze",
        )),
    }
}

/// Numbers that values are divided by.
fn factors<const N: usize>(name: &str, line: &str, value: &str) -> Result<[f64; N]> {
    let factors = numbers::<N>(name, line, value)?;
    if factors.iter().any(|factor| *factor <= 0.0) {
        return Err(malformed::<N>(name, line, "positive "));
    }
    Ok(factors)
}

fn numbers<const N: usize>(name: &str, line: &str, value: &str) -> Result<[f64; N]> {
    let parsed: Option<Vec<f64>> = value
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect();
    parsed
        .and_then(|numbers| <[f64; N]>::try_from(numbers).ok())
        .ok_or_else(|| malformed::<N>(name, line, ""))
}

fn malformed<const N: usize>(name: &str, line: &str, kind: &str) -> Problem {
    let numbers = if N == 1 { "number" } else { "numbers" };
    Problem::new(
        name,
        format!("the header line `{}` does not give {N} {kind}{numbers}", clip(line)),
        "correct that line",
    )
}

/// The start of a text from a file, fit for one line of a message.
fn clip(text: &str) -> String {
    text.chars().take(60).map(|c| if c.is_control() { '?' } else { c }).collect()
}
