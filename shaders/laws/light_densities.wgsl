// The density of draws of the environment, for a list of directions.

struct LightDensity {
    /// World frame.
    dir: vec3f,
    /// [1/sr], the answer.
    pdf: f32,
}

@group(0) @binding(5) var<storage, read_write> densities: array<LightDensity>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&densities) {
        return;
    }
    densities[id.x].pdf = env_pdf(densities[id.x].dir);
}
