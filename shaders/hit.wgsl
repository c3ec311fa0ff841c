// Shading points: where a pixel's ray met the object, and the frame there.

/// One shading point as stored: world frame, local view direction.
struct HitRow {
    wo: vec3f,
    /// Index of the pixel, row by row from the top left.
    pixel: u32,
    tangent: vec3f,
    normal: vec3f,
}

@group(0) @binding(4) var<storage, read> hits: array<HitRow>;

/// A shading point as integrators see it.
struct Hit {
    pixel: u32,
    /// To the viewer, unit, local frame.
    wo: vec3f,
    /// Columns: tangent, bitangent, normal; right-handed.
    world_from_local: mat3x3f,
}

fn hit_of(row: u32) -> Hit {
    let tangent = hits[row].tangent;
    let normal = hits[row].normal;
    return Hit(hits[row].pixel, hits[row].wo, mat3x3f(tangent, cross(normal, tangent), normal));
}

/// Local to world direction.
fn to_world(hit: Hit, local: vec3f) -> vec3f {
    return hit.world_from_local * local;
}

/// World to local direction.
fn to_local(hit: Hit, world: vec3f) -> vec3f {
    return world * hit.world_from_local;
}
