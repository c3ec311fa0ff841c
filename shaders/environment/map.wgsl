// Radiance that arrives from a world direction: a map of texels, turned by one rotation.
//
// The linker says how the map lies: ENV_CUBE (six faces, else lat-long) and ENV_LINEAR (the filter,
// else texels are constant). A place on the map is a texel and where in it. The fourth value of a
// texel is the density with which `env_sample` draws from it, so radiance and density come together.

struct Environment {
    /// Takes world directions to map directions.
    map_from_world: mat3x3f,
    /// Columns and rows of texels; the six faces of a cube lie one below the other.
    size: vec2u,
    /// Entries of the guides to rows and columns, as powers of two.
    guide_bits: vec2u,
    /// A power of two that brings the map's mean radiance near 1.
    scale: f32,
    /// Texels that a sum over the map visits.
    terms: u32,
}

@group(0) @binding(2) var<uniform> environment: Environment;
@group(0) @binding(3) var env_map: texture_2d<f32>;

/// A place on the map: a texel (column, row), and where in it, in [0, 1) from its upper left corner.
struct EnvPlace {
    texel: vec2u,
    offset: vec2f,
}

/// What a place on the map sends: radiance, and the density of `env_sample` there [1/sr].
struct EnvLight {
    radiance: vec3f,
    pdf: f32,
}

/// Splits a coordinate in texels; what rounding takes past the edge belongs to the last texel.
fn env_split(at: vec2f, size: vec2u) -> EnvPlace {
    let texel = min(vec2u(max(at, vec2f(0.0))), size - 1u);
    return EnvPlace(texel, clamp(at - vec2f(texel), vec2f(0.0), vec2f(1.0)));
}

/// Where a map direction meets a lat-long map. Row 0 is +y, the image centre looks to +z, u = 0.25 is
/// +x. The polar angle comes by atan2, exact near the poles.
fn env_place_latlong(d: vec3f) -> EnvPlace {
    let at_pole = d.x == 0.0 && d.z == 0.0;
    let phi = atan2(d.x, select(d.z, 1.0, at_pole));
    let theta = atan2(length(d.xz), d.y);
    let uv = vec2f(fract(0.5 - phi * INV_TWO_PI), theta * INV_PI);
    return env_split(uv * vec2f(environment.size), environment.size);
}

/// The longitude of a place on a lat-long map, from +z to +x; `x` in texels from the left edge.
fn env_longitude(x: f32) -> f32 {
    return TWO_PI * (0.5 - x / f32(environment.size.x));
}

/// Where a map direction meets a cube: the face of its largest component, there s to the right and t down.
fn env_place_cube(d: vec3f) -> EnvPlace {
    let a = abs(d);
    var face = 0u;
    var st = vec2f(0.0);
    if a.x >= a.y && a.x >= a.z {
        face = select(0u, 1u, d.x < 0.0);
        st = vec2f(select(-d.z, d.z, d.x < 0.0), -d.y) / a.x;
    } else if a.y >= a.z {
        face = select(2u, 3u, d.y < 0.0);
        st = vec2f(d.x, select(d.z, -d.z, d.y < 0.0)) / a.y;
    } else {
        face = select(4u, 5u, d.z < 0.0);
        st = vec2f(select(d.x, -d.x, d.z < 0.0), -d.y) / a.z;
    }
    let side = environment.size.x;
    let place = env_split((st * 0.5 + 0.5) * f32(side), vec2u(side));
    return EnvPlace(place.texel + vec2u(0u, face * side), place.offset);
}

/// Where a map direction meets the map.
fn env_place_of(d: vec3f) -> EnvPlace {
    if ENV_CUBE {
        return env_place_cube(d);
    }
    return env_place_latlong(d);
}

/// s and t in [-1, 1] of a place on a cube's face.
fn env_face_coordinates(place: EnvPlace) -> vec2f {
    let side = environment.size.x;
    let texel = vec2f(f32(place.texel.x), f32(place.texel.y % side));
    return (texel + place.offset) * (2.0 / f32(side)) - 1.0;
}

/// The direction of s and t on a cube's face, as long as it comes out: sqrt(1 + s^2 + t^2).
fn env_face_direction(face: u32, st: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -st.y, -st.x); }
        case 1u: { return vec3f(-1.0, -st.y, st.x); }
        case 2u: { return vec3f(st.x, 1.0, st.y); }
        case 3u: { return vec3f(st.x, -1.0, -st.y); }
        case 4u: { return vec3f(st.x, -st.y, 1.0); }
        default: { return vec3f(-st.x, -st.y, -1.0); }
    }
}

/// The texel as the texture holds it: behind a border of one where the filter is linear; the faces of
/// a cube three to a row.
fn env_texel(texel: vec2u) -> vec2u {
    let border = select(0u, 1u, ENV_LINEAR);
    if ENV_CUBE {
        let side = environment.size.x;
        let face = texel.y / side;
        let corner = vec2u(face % 3u, face / 3u) * (side + 2u * border);
        return corner + vec2u(texel.x, texel.y % side) + border;
    }
    return texel + border;
}

/// Bilinear between texel centres. The border holds what lies across an edge, so nothing wraps here.
fn env_filtered(at: vec2u, offset: vec2f) -> vec3f {
    let low = at - select(vec2u(0u), vec2u(1u), offset < vec2f(0.5));
    let f = fract(offset + 0.5);
    let top = mix(textureLoad(env_map, low, 0).rgb, textureLoad(env_map, low + vec2u(1u, 0u), 0).rgb, f.x);
    let bottom = mix(
        textureLoad(env_map, low + vec2u(0u, 1u), 0).rgb,
        textureLoad(env_map, low + vec2u(1u, 1u), 0).rgb,
        f.x,
    );
    return mix(top, bottom, f.y);
}

/// The light at a place; `offset` runs linearly in the map's own coordinates.
fn env_light_at(place: EnvPlace) -> EnvLight {
    let at = env_texel(place.texel);
    let held = textureLoad(env_map, at, 0);
    var light = EnvLight(held.rgb, held.a);
    if ENV_LINEAR {
        light.radiance = env_filtered(at, place.offset);
    }
    if ENV_CUBE {
        // Texels are drawn by area; a solid angle is the area over (1 + s^2 + t^2)^(3/2).
        let st = env_face_coordinates(place);
        let square = 1.0 + dot(st, st);
        light.pdf *= square * sqrt(square);
    }
    return light;
}

/// Where a world direction meets the map.
fn env_place(dir: vec3f) -> EnvPlace {
    return env_place_of(environment.map_from_world * dir);
}

/// L_e [the map's units] from the world direction `dir`.
fn env_radiance(dir: vec3f) -> vec3f {
    return env_light_at(env_place(dir)).radiance;
}

/// Radiance from the world direction `dir`, and the density [1/sr] with which `env_sample` draws it, from
/// one look at the map.
fn env_light(dir: vec3f) -> EnvLight {
    return env_light_at(env_place(dir));
}

/// A power of two that brings the map's mean radiance near 1: for numbers whose squares must hold.
fn environment_scale() -> f32 {
    return environment.scale;
}
