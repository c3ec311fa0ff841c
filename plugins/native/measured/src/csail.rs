//! MIT CSAIL: anisotropic materials over the angles of both directions (Ngan, Durand, Matusik 2005).
//!
//! A file holds sixteen 32-bit integers (0 to 3: bins of theta_in, theta_out, phi_diff and phi_in; 9: whether
//! phi_diff goes over half a turn only; 10: channels), then planes of 32-bit floats, phi_in fastest, then
//! phi_diff, theta_out, theta_in. phi_diff is phi_out - phi_in. A negative value says that nothing was measured.
//!
//! Files have up to 787 MB: the planes are read side by side, a piece at a time, and a bin is kept in 32 bits.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};

use brdf_sdk::native::directions::{Vec3, direction};
use brdf_sdk::native::lobes::{self, Grid};
use brdf_sdk::native::{Array, Loaded, in_parallel};

use crate::LUMINANCE;
use crate::file;
use crate::made_up::Lacquer;
use crate::shared_exponent::{LEAST, MOST, packed, unpacked};

/// Bytes of the header.
const HEADER: u64 = 64;

/// Bins that fit into the buffers that the manifest asks for.
const MOST_BINS: u64 = 1 << 26;

/// A material.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Bins of theta_in, theta_out, phi_diff, phi_in.
    pub bins: [usize; 4],
    /// Whether phi_diff goes over half a turn; the other half follows by exchanging the directions.
    pub half: bool,
    /// Stored values in 32 bits, phi_in fastest; 0 where nothing was measured.
    pub values: Vec<u32>,
    /// Bins without a measurement.
    pub missing: usize,
    /// The largest rounding error, of a bin's largest channel; below 2^-16 it is 2^-25 instead, at the most.
    pub loss: f32,
}

/// The arrays of a file, or of a brushed lacquer that is made up.
pub fn load(path: Option<&str>) -> Result<Loaded, String> {
    let table = match path {
        None => made_up(),
        Some(path) => {
            let length = file::length(path)?;
            read(length, |at| {
                let mut plane = file::open(path)?;
                plane.seek(SeekFrom::Start(at)).map_err(|error| file::unreadable(&error))?;
                Ok(BufReader::with_capacity(1 << 20, plane))
            })?
        }
    };
    Ok(arrays(table))
}

/// Reads bytes, as fuzzers give them.
pub fn parse(bytes: &[u8]) -> Result<Table, String> {
    read(bytes.len() as u64, |at| {
        let mut cursor = Cursor::new(bytes);
        cursor.set_position(at);
        Ok(cursor)
    })
}

/// Reads a file of that length; `from` opens it at a byte.
fn read<R: Read>(length: u64, from: impl Fn(u64) -> Result<R, String>) -> Result<Table, String> {
    let mut header = [0; 16];
    let mut words = file::Words::new(from(0)?, length);
    for word in &mut header {
        *word = words.i32()?;
    }
    let named = "it is no file of MIT's anisotropic materials, so name another";
    let mut bins = [0; 4];
    let mut count = 1u64;
    for (bin, size) in bins.iter_mut().zip(&header[..4]) {
        if !(1..=4096).contains(size) {
            return Err(format!("its header asks for {size} bins of an angle; {named}"));
        }
        *bin = *size as usize;
        count *= *size as u64;
    }
    if header[10] != 3 {
        return Err(format!("its header says {} channels and not 3; {named}", header[10]));
    }
    let [a, b, c, d] = bins;
    if count > MOST_BINS {
        return Err(format!(
            "its {a} x {b} x {c} x {d} bins are more than the {MOST_BINS} that fit; store it with fewer"
        ));
    }
    let wanted = HEADER + 12 * count;
    if length != wanted {
        return Err(format!(
            "it has {length} bytes and its {a} x {b} x {c} x {d} bins need {wanted}; it was cut off or is another \
             format, so fetch it again"
        ));
    }
    let plane = |channel: u64| {
        let at = HEADER + 4 * count * channel;
        Ok::<_, String>(file::Words::new(from(at)?, length))
    };
    fill([plane(0)?, plane(1)?, plane(2)?], bins, header[9] != 0, count as usize)
}

fn fill<R: Read>(
    mut planes: [file::Words<R>; 3],
    bins: [usize; 4],
    half: bool,
    count: usize,
) -> Result<Table, String> {
    const PIECE: usize = 1 << 16;
    let mut table = Table { bins, half, values: Vec::with_capacity(count), missing: 0, loss: 0.0 };
    let mut piece = vec![[0.0f32; 3]; PIECE.min(count)];
    while table.values.len() < count {
        let some = (count - table.values.len()).min(PIECE);
        for (channel, plane) in planes.iter_mut().enumerate() {
            plane.each(some, |index, bytes| {
                piece[index][channel] = f32::from_le_bytes(bytes);
                Ok(())
            })?;
        }
        for rgb in &piece[..some] {
            table.push(*rgb)?;
        }
    }
    if table.missing == count {
        return Err("not one of its bins was measured; name a file with data".to_owned());
    }
    Ok(table)
}

impl Table {
    fn push(&mut self, rgb: [f32; 3]) -> Result<(), String> {
        let index = self.values.len();
        if let Some(bad) = rgb.iter().find(|c| !c.is_finite() || **c > MOST) {
            return Err(format!(
                "bin {index} holds {bad}, and {MOST} is the most that is kept; the file is damaged, so fetch it again"
            ));
        }
        if rgb.iter().any(|c| *c < 0.0) {
            self.missing += 1;
            self.values.push(0);
            return Ok(());
        }
        let bits = packed(rgb);
        let largest = rgb.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        if largest >= LEAST {
            let kept = unpacked(bits);
            let off = (0..3).map(|c| (kept[c] - rgb[c]).abs() / largest).fold(0.0, f32::max);
            self.loss = self.loss.max(off);
        }
        self.values.push(bits);
        Ok(())
    }

    /// The bin of light from `wi` leaving towards `wo`.
    pub fn bin(&self, wo: Vec3, wi: Vec3) -> usize {
        let azimuth = |w: Vec3| w[1].atan2(w[0]).rem_euclid(TAU);
        let difference = (azimuth(wo) - azimuth(wi)).rem_euclid(TAU);
        if self.half && difference > TAU / 2.0 {
            return self.bin(wi, wo);
        }
        let turn = if self.half { TAU / 2.0 } else { TAU };
        let theta = |w: Vec3| w[0].hypot(w[1]).atan2(w[2]) / FRAC_PI_2;
        let parts = [theta(wi), theta(wo), difference / turn, azimuth(wi) / TAU];
        let at = |axis: usize| {
            ((parts[axis] * self.bins[axis] as f64) as usize).min(self.bins[axis] - 1)
        };
        at(3) + self.bins[3] * (at(2) + self.bins[2] * (at(1) + self.bins[1] * at(0)))
    }

    fn luminance(&self, wo: Vec3, wi: Vec3) -> f64 {
        let rgb = unpacked(self.values[self.bin(wo, wi)]);
        (0..3).map(|c| LUMINANCE[c] * f64::from(rgb[c])).sum()
    }
}

fn arrays(table: Table) -> Loaded {
    let grid = Grid { theta_o: 16, phi_o: 16, theta_h: 45, phi_h: 24 };
    let mut loaded = Loaded::new(lobes::tables(grid, |wo, wi| table.luminance(wo, wi)));
    let shape = table.bins.map(|bins| bins as u64);
    let count = table.values.len();
    loaded.arrays.push(Array::u32("bins", shape, table.values));
    loaded.arrays.push(Array::u32("halves", [1], vec![u32::from(table.half)]));
    if table.loss > 0.0 {
        loaded.notes.push(format!(
            "a bin is kept in 32 bits: values are off by up to {:.1e} of their largest channel, or by 6e-8",
            table.loss
        ));
    }
    if table.missing > 0 {
        let share = 100.0 * table.missing as f64 / count as f64;
        loaded.notes.push(format!(
            "{} of {count} bins ({share:.1} %) hold no measurement and reflect nothing",
            table.missing
        ));
    }
    if table.half {
        loaded.notes.push(
            "it holds half of the differences of azimuth; the others exchange both directions"
                .to_owned(),
        );
    }
    loaded
}

/// Blue lacquer that was brushed along the bitangent; stored values are a tenth of f, as in MIT's files.
fn made_up() -> Table {
    let lacquer = Lacquer { alpha: [0.35, 0.12], base: [0.02, 0.05, 0.3], coat: [0.08; 3] };
    let bins = [24, 24, 72, 72];
    let value = |index: usize| {
        // The middle of each axis' bin as a part of its range, the fastest axis first.
        let mut rest = index;
        let [phi_in, phi_diff, theta_out, theta_in] = [3, 2, 1, 0].map(|axis: usize| {
            let part = ((rest % bins[axis]) as f64 + 0.5) / bins[axis] as f64;
            rest /= bins[axis];
            part
        });
        let wi = direction(theta_in * FRAC_PI_2, phi_in * TAU);
        let wo = direction(theta_out * FRAC_PI_2, (phi_in + phi_diff) * TAU);
        packed(lacquer.f(wo, wi).map(|c| (0.1 * c) as f32))
    };
    let values = in_parallel(bins.iter().product(), value);
    Table { bins, half: false, values, missing: 0, loss: 0.0 }
}
