// Owen-scrambled Sobol points, padded in sets of one, two and three dimensions.
//
// Burley, "Practical Hash-based Owen Scrambling" (2020), with Vegdahl's better Laine-Karras hash.

struct Sampler {
    /// Index of the sample in its sequence.
    index: u32,
    /// Scrambles the sequence: a hash of seed, pixel and replicate.
    seed: u32,
    /// Sets drawn so far in this sample.
    drawn: u32,
}

/// Flips each bit by a hash of the lower ones: an Owen scramble of the reversed word.
fn laine_karras(x: u32, seed: u32) -> u32 {
    var y = x ^ (x * 0x3d20adeau);
    y += seed;
    y *= (seed >> 16u) | 1u;
    y ^= y * 0x05526c56u;
    y ^= y * 0x53a22864u;
    return y;
}

/// Second dimension of the Sobol sequence, bit-reversed: Pascal's triangle modulo 2, by shifts.
fn sobol_second_reversed(index: u32) -> u32 {
    var x = index;
    x ^= (x >> 16u) & 0x0000ffffu;
    x ^= (x >> 8u) & 0x00ff00ffu;
    x ^= (x >> 4u) & 0x0f0f0f0fu;
    x ^= (x >> 2u) & 0x33333333u;
    x ^= (x >> 1u) & 0x55555555u;
    return x;
}

/// Third dimension, bit-reversed. The index is a polynomial over {0, 1}; its digits in powers of p = x^2 + x + 1,
/// two bits each, as the first dimension has its digits in powers of x and the second in powers of x + 1
/// (Niederreiter 1988). p^(2^k) = x^(2^(k+1)) + x^(2^k) + 1, so each step divides words half as long: their
/// quarters (a, b, c, d) become the quotient (a, b + a) and the rest (c + b, d + b + a).
fn sobol_third_reversed(index: u32) -> u32 {
    var x = index;
    x ^= (x >> 8u) & 0x00ffff00u;
    x ^= (x >> 16u) & 0x000000ffu;
    x ^= (x >> 4u) & 0x0ff00ff0u;
    x ^= (x >> 8u) & 0x000f000fu;
    x ^= (x >> 2u) & 0x3c3c3c3cu;
    x ^= (x >> 4u) & 0x03030303u;
    x ^= (x >> 1u) & 0x66666666u;
    x ^= (x >> 2u) & 0x11111111u;
    return x;
}

fn sampler_begin(seed: u32, index: u32) -> Sampler {
    return Sampler(index, seed, 0u);
}

/// Seed of the next set; its index is shuffled too, so that padded sets are independent.
fn next_set_seed(s: ptr<function, Sampler>) -> u32 {
    let seed = hash_combine((*s).seed, (*s).drawn);
    (*s).drawn += 1u;
    return seed;
}

fn shuffled_index(index: u32, seed: u32) -> u32 {
    return reverseBits(laine_karras(reverseBits(index), seed));
}

/// One dimension in [0, 1).
fn next_1d(s: ptr<function, Sampler>) -> f32 {
    let seed = next_set_seed(s);
    let index = shuffled_index((*s).index, seed);
    return unit_f32(reverseBits(laine_karras(index, hash_combine(seed, 1u))));
}

/// Two dimensions, 32 bits each.
fn next_2d_bits(s: ptr<function, Sampler>) -> vec2u {
    let seed = next_set_seed(s);
    let index = shuffled_index((*s).index, seed);
    let x = reverseBits(laine_karras(index, hash_combine(seed, 1u)));
    let y = reverseBits(laine_karras(sobol_second_reversed(index), hash_combine(seed, 2u)));
    return vec2u(x, y);
}

/// Three dimensions, 32 bits each. Any two dimensions and all three fill elementary intervals evenly, so that
/// the points that fall to one lobe, picked by the third, are still stratified in the first two.
fn next_3d_bits(s: ptr<function, Sampler>) -> vec3u {
    let seed = next_set_seed(s);
    let index = shuffled_index((*s).index, seed);
    let x = reverseBits(laine_karras(index, hash_combine(seed, 1u)));
    let y = reverseBits(laine_karras(sobol_second_reversed(index), hash_combine(seed, 2u)));
    let z = reverseBits(laine_karras(sobol_third_reversed(index), hash_combine(seed, 3u)));
    return vec3u(x, y, z);
}
