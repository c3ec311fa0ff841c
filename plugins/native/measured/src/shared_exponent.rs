//! Three numbers in 32 bits: nine bits each and one exponent (the format RGB9E5 of graphics devices).
//!
//! The WGSL of `merl` and `csail` reads what is packed here. Negative numbers and those above `MOST` are the
//! caller's to keep out.

/// The largest number.
pub const MOST: f32 = 32704.0;

/// Where the nine bits of a largest channel begin to be too few: below, errors are up to 2^-24.
pub const LEAST: f32 = 1.0 / 32768.0;

/// Bits of a colour, none of it negative or above [`MOST`]. From [`LEAST`] on the largest channel is off by 1/512
/// of itself at the most, the others by as much as it. Of the exponents the least and the greatest are not used.
pub fn packed(rgb: [f32; 3]) -> u32 {
    let largest = rgb.iter().copied().fold(0.0, f32::max);
    // The power of two above the largest, of which the shared exponent has 30.
    let above = ((largest.to_bits() >> 23) as i32 - 126).max(-14);
    let mut exponent = above + 15;
    let step = |exponent: i32| f32::from_bits(((exponent + 103) as u32) << 23);
    if (largest / step(exponent)).round() >= 512.0 {
        exponent += 1;
    }
    let [r, g, b] = rgb.map(|c| (c / step(exponent)).round() as u32);
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

/// What a colour's step has more than the f32 with its exponent: 2^103. So a reader may take the exponent as it is, and
/// multiply by this beside what it multiplies by anyway.
pub const BIAS: f32 = f32::from_bits((103 + 127) << 23);

/// The colour.
pub fn unpacked(bits: u32) -> [f32; 3] {
    let step = f32::from_bits((bits >> 27) << 23) * BIAS;
    [0, 9, 18].map(|shift| (bits >> shift & 511) as f32 * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over the whole range of exponents the largest channel, 256 steps or more, is off by half a step, and what
    /// has nine bits comes back as it was.
    #[test]
    fn colours_come_back() {
        for power in -15..=14 {
            for part in [1.0f32, 1.001, 1.0019, 1.4, 1.9, 1.997, 1.999] {
                let value = (part * (power as f32).exp2()).min(MOST);
                let back = unpacked(packed([value, 0.5 * value, 0.0]));
                let off = |c: usize, of: f32| (back[c] - of).abs() / value;
                assert!(off(0, value) <= 1.0 / 512.0, "{value}: {back:?}");
                assert!(off(1, 0.5 * value) <= 1.0 / 512.0 && back[2] == 0.0, "{value}: {back:?}");
            }
        }
        for exact in [[0.0; 3], [1.0, 0.5, 0.25], [511.0, 3.0, 1.0], [MOST, 0.0, 128.0]] {
            assert_eq!(unpacked(packed(exact)), exact);
        }
    }
}
