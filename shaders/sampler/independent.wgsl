// Independent random numbers: PCG (O'Neill 2014), started afresh for every sample by a hash.

struct Sampler {
    /// The generator's state.
    state: u32,
}

fn sampler_begin(seed: u32, index: u32) -> Sampler {
    return Sampler(hash_combine(seed, index));
}

/// 32 random bits.
fn next_bits(s: ptr<function, Sampler>) -> u32 {
    (*s).state = (*s).state * 747796405u + 2891336453u;
    return hash_output((*s).state);
}

/// One number in [0, 1).
fn next_1d(s: ptr<function, Sampler>) -> f32 {
    return unit_f32(next_bits(s));
}

/// Two numbers of 32 bits.
fn next_2d_bits(s: ptr<function, Sampler>) -> vec2u {
    let x = next_bits(s);
    return vec2u(x, next_bits(s));
}

/// Three numbers of 32 bits.
fn next_3d_bits(s: ptr<function, Sampler>) -> vec3u {
    let xy = next_2d_bits(s);
    return vec3u(xy, next_bits(s));
}
