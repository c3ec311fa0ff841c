// The kernel behind the object: the environment's radiance along the rays that miss it.

/// A ray's direction, world frame, and then the radiance along it.
struct Ray {
    direction: vec3f,
    radiance: vec3f,
}

@group(0) @binding(5) var<storage, read_write> rays: array<Ray>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&rays) {
        return;
    }
    rays[id.x].radiance = env_radiance(rays[id.x].direction);
}
