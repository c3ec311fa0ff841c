// The kernel of `brdf eval`: f, pdf and weight for a list of direction pairs, local frame.

/// One pair of unit directions.
struct Pair {
    wo: vec3f,
    wi: vec3f,
}

/// What the BRDF says of it; zero below the horizon.
struct Scattered {
    f: vec3f,
    pdf: f32,
    weight: vec3f,
    /// 1 where the plugin's loops used up their budget.
    exhausted: u32,
}

@group(0) @binding(4) var<storage, read> pairs: array<Pair>;
@group(0) @binding(5) var<storage, read_write> scattered: array<Scattered>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&scattered) {
        return;
    }
    let wo = pairs[i].wo;
    let wi = pairs[i].wi;
    let f = brdf_value(wo, wi);
    let at = brdf_at(wo, wi);
    scattered[i] = Scattered(f, at.pdf, weight_of(wo, wi, at), loops_exhausted());
}
