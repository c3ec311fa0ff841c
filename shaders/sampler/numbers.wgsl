// What the samplers share: hashes, and floats from bits. Integer arithmetic: every executor and
// precision draws the same points. A sampler gives `next_1d`, `next_2d_bits` and
// `next_3d_bits`.

/// The output function of PCG (O'Neill 2014, RXS-M-XS).
fn hash_output(state: u32) -> u32 {
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

/// A well-mixed hash (pcg, Jarzynski and Olano 2020).
fn hash_u32(x: u32) -> u32 {
    return hash_output(x * 747796405u + 2891336453u);
}

fn hash_combine(a: u32, b: u32) -> u32 {
    return hash_u32(a ^ hash_u32(b));
}

/// [0, 1) from 32 bits; 24 of them, so that 1 is never reached.
fn unit_f32(x: u32) -> f32 {
    return f32(x >> 8u) * 0x1p-24;
}
