// The kernel behind the laws of sampling: draws of the BRDF for one `wo`, by independent random numbers.

struct Batch {
    wo: vec3f,
    seed: u32,
    /// Number of the first draw.
    first: u32,
}

struct Draw {
    wi: vec3f,
    pdf: f32,
    weight: vec3f,
    /// 1 where the plugin's loops used up their budget.
    exhausted: u32,
    /// The point that it came of.
    u: vec3f,
}

@group(0) @binding(4) var<uniform> batch: Batch;
@group(0) @binding(5) var<storage, read_write> draws: array<Draw>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&draws) {
        return;
    }
    var s = sampler_begin(batch.seed, batch.first + i);
    let u = next_3d(&s);
    let drawn = brdf_sample(batch.wo, u);
    draws[i] = Draw(drawn.wi, drawn.pdf, drawn.weight, loops_exhausted(), u);
}
