// Radiance that arrives from a world direction: a lat-long map, turned by one rotation.
//
// Row 0 is +y, the image centre looks to +z, u = 0.25 is +x. Texels are constant (nearest).

struct Environment {
    /// Takes world directions to map directions.
    map_from_world: mat3x3f,
    /// Width and height in texels.
    size: vec2u,
}

@group(0) @binding(2) var<uniform> environment: Environment;
@group(0) @binding(3) var env_map: texture_2d<f32>;

/// The texel that a map direction falls into. The polar angle by atan2, exact near the poles.
fn env_texel_of(d: vec3f) -> vec2u {
    let at_pole = d.x == 0.0 && d.z == 0.0;
    let phi = atan2(d.x, select(d.z, 1.0, at_pole));
    let theta = atan2(length(d.xz), d.y);
    let uv = vec2f(fract(0.5 - phi * INV_TWO_PI), theta * INV_PI);
    return min(vec2u(uv * vec2f(environment.size)), environment.size - 1u);
}

/// L_e [the map's units] from the world direction `dir`.
fn env_radiance(dir: vec3f) -> vec3f {
    return textureLoad(env_map, env_texel_of(environment.map_from_world * dir), 0).rgb;
}
