// The kernel behind the law of sampling for environments: directions drawn by independent random numbers.

struct Batch {
    seed: u32,
    /// Number of the first draw.
    first: u32,
}

struct LightDraw {
    dir: vec3f,
    pdf: f32,
}

@group(0) @binding(4) var<uniform> batch: Batch;
@group(0) @binding(5) var<storage, read_write> draws: array<LightDraw>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&draws) {
        return;
    }
    var s = sampler_begin(batch.seed, batch.first + i);
    let drawn = env_sample(next_2d_bits(&s));
    draws[i] = LightDraw(drawn.dir, drawn.pdf);
}
