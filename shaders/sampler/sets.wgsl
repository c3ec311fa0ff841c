// Points in [0, 1) from either sampler.

/// Two dimensions in [0, 1)^2.
fn next_2d(s: ptr<function, Sampler>) -> vec2f {
    let bits = next_2d_bits(s);
    return vec2f(unit_f32(bits.x), unit_f32(bits.y));
}

/// Three dimensions in [0, 1)^3: a 2D set and a 1D set.
fn next_3d(s: ptr<function, Sampler>) -> vec3f {
    let xy = next_2d(s);
    return vec3f(xy, next_1d(s));
}
