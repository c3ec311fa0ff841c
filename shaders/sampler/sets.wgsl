// Points in [0, 1) from either sampler, and what two techniques have of them: which one is picked, and how much each
// of them counts.

/// Two dimensions in [0, 1)^2.
fn next_2d(s: ptr<function, Sampler>) -> vec2f {
    let bits = next_2d_bits(s);
    return vec2f(unit_f32(bits.x), unit_f32(bits.y));
}

/// Three dimensions in [0, 1)^3.
fn next_3d(s: ptr<function, Sampler>) -> vec3f {
    let bits = next_3d_bits(s);
    return vec3f(unit_f32(bits.x), unit_f32(bits.y), unit_f32(bits.z));
}

/// One of two ways, and a number to go on with.
struct Way {
    first: bool,
    bits: u32,
}

/// Picks the first of two ways with probability `share` by a number of 32 bits, and stretches the part of
/// the numbers that picks the same over all of them: points that fill the square evenly still do so
/// in either way. `fresh` in [0, 1) fills up the bits that stretching leaves.
fn pick_way(bits: u32, share: f32, fresh: f32) -> Way {
    let border = u32(share * 0x1p32);
    let first = bits < border;
    let place = select(bits - border, bits, first);
    let all = select(0u - border, border, first);
    let ratio = min((f32(place) + 0.5) / f32(all), 0x1.fffffep-1);
    return Way(first, (u32(ratio * 0x1p24) << 8u) | u32(fresh * 256.0));
}

/// The balance heuristic for the densities of two techniques, own / (own + other) (Veach and Guibas 1995): as a ratio,
/// since those of narrow lobes and small suns overflow in products.
fn balance_heuristic(own: f32, other: f32) -> f32 {
    return 1.0 / (1.0 + other / own);
}
