// The kernel of `brdf eval`: f, pdf and weight for a list of direction pairs, local frame.

/// One pair of unit directions. They come rounded to f32, and to a program in f64, for which `rounded` is 1, they are no
/// unit vectors any more: half vectors near the horizon would be lost by that.
struct Pair {
    wo: vec3f,
    rounded: u32,
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
    var wo = pairs[i].wo;
    var wi = pairs[i].wi;
    if pairs[i].rounded != 0u {
        wo = normalize(wo);
        wi = normalize(wi);
    }
    let f = brdf_value(wo, wi);
    let at = brdf_at(wo, wi);
    scattered[i] = Scattered(f, at.pdf, weight_of(wo, wi, at), loops_exhausted());
}
