// Needle: constant within a cone about the mirror direction, zero elsewhere. There is no sampling.

/// Tangent^2 of the half vector's largest angle, one degree.
const CONE: f32 = 3.0468e-4;
/// Solid angle of the cone about the mirror direction, two degrees wide [sr].
const OMEGA: f32 = 3.8275e-3;

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    if dot(m.xy, m.xy) > CONE * m.z * m.z {
        return vec3f(0.0);
    }
    return vec3f(p.albedo / (OMEGA * max(wo.z, wi.z)));
}
