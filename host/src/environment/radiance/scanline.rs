//! One scanline of a Radiance picture, in any of its three codings.

/// Why a scanline cannot be decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The bytes ended first.
    Ends,
    /// The bytes contradict themselves.
    Damaged,
}

/// Appends the `width` texels of the next scanline to `out` and gives the bytes after it.
pub fn append<'a>(
    bytes: &'a [u8],
    width: usize,
    out: &mut Vec<[u8; 4]>,
) -> Result<&'a [u8], Fault> {
    match bytes {
        // New coding: 2, 2, then the width in 15 bits; the four components follow one by one.
        [2, 2, high, low, rest @ ..] if *high < 128 && (8..0x8000).contains(&width) => {
            if usize::from(*high) << 8 | usize::from(*low) != width {
                return Err(Fault::Damaged);
            }
            components(rest, width, out)
        }
        _ => texels(bytes, width, out),
    }
}

fn components<'a>(
    mut bytes: &'a [u8],
    width: usize,
    out: &mut Vec<[u8; 4]>,
) -> Result<&'a [u8], Fault> {
    // The shortest coding of a component is one pair of bytes for each 127 texels.
    if bytes.len() < 4 * 2 * width.div_ceil(127) {
        return Err(Fault::Ends);
    }
    let start = out.len();
    out.resize(start + width, [0; 4]);
    let scanline = &mut out[start..];
    for component in 0..4 {
        let mut x = 0;
        while x < width {
            let (&code, rest) = bytes.split_first().ok_or(Fault::Ends)?;
            let (run, count) = (code > 128, usize::from(code & 127));
            // 128 itself is a literal of 128 texels.
            let count = if code == 128 { 128 } else { count };
            let target = scanline.get_mut(x..x + count).ok_or(Fault::Damaged)?;
            let (values, rest) =
                rest.split_at_checked(if run { 1 } else { count }).ok_or(Fault::Ends)?;
            for (i, texel) in target.iter_mut().enumerate() {
                texel[component] = values[if run { 0 } else { i }];
            }
            x += count;
            bytes = rest;
        }
    }
    Ok(bytes)
}

/// Flat texels; among them, (1, 1, 1, n) repeats the last one n times, and successive repeats are
/// the bytes of one number, lowest first (the old coding).
fn texels<'a>(
    mut bytes: &'a [u8],
    width: usize,
    out: &mut Vec<[u8; 4]>,
) -> Result<&'a [u8], Fault> {
    let start = out.len();
    let end = start + width;
    let mut shift = 0;
    while out.len() < end {
        let (&texel, rest) = bytes.split_first_chunk::<4>().ok_or(Fault::Ends)?;
        bytes = rest;
        if let [1, 1, 1, count] = texel {
            let count = usize::from(count) << shift;
            shift += 8;
            let last = *out[start..].last().ok_or(Fault::Damaged)?;
            if shift > 24 || out.len() + count > end {
                return Err(Fault::Damaged);
            }
            out.resize(out.len() + count, last);
        } else {
            out.push(texel);
            shift = 0;
        }
    }
    Ok(bytes)
}
