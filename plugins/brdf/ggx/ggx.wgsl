// GGX: f = F D G2 / (4 cos(wo) cos(wi)), with visible-normal sampling.
//
// Everything is written in m = wo + wi, the half vector before it is normalised, and in
// len(w) = |(ax w.x, ay w.y, w.z)|: no term subtracts close numbers, however small alpha is.

/// |(ax w.x, ay w.y, w.z)|, from which Smith's G1 = 2 w.z / (w.z + len).
fn stretched_length(p: Params, w: vec3f) -> f32 {
    return length(vec3f(p.alpha_x * w.x, p.alpha_y * w.y, w.z));
}

/// D(h) [1/sr], Walter 2007 eq. 33 in the form without NoH: 1 / (pi ax ay |(hx/ax, hy/ay, hz)|^4).
fn distribution(p: Params, m: vec3f) -> f32 {
    let stretched = vec3f(m.x / p.alpha_x, m.y / p.alpha_y, m.z);
    let ratio = dot(m, m) / dot(stretched, stretched);
    return INV_PI * (ratio / p.alpha_x) * (ratio / p.alpha_y);
}

/// Schlick's Fresnel term at the angle between `wo` and the half vector, whose cosine is |m| / 2.
fn fresnel(p: Params, m: vec3f) -> vec3f {
    let c = min(0.5 * length(m), 1.0);
    return p.f0 + (1.0 - p.f0) * pow5(1.0 - c);
}

/// G2 / (4 cos(wo) cos(wi)).
fn visibility(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let len_o = stretched_length(p, wo);
    let len_i = stretched_length(p, wi);
    if MASKING == MASKING_SEPARABLE {
        return 1.0 / ((wo.z + len_o) * (wi.z + len_i));
    }
    return 0.5 / (wi.z * len_o + wo.z * len_i);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    return fresnel(p, m) * (distribution(p, m) * visibility(p, wo, wi));
}

/// Visible normals by spherical caps: in the space where alpha is 1 the reflected direction is
/// uniform on the cap z > -wo.z, and the half vector is the sum of both (Dupuy and Benyoub 2023).
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let stretched = normalize(vec3f(p.alpha_x * wo.x, p.alpha_y * wo.y, wo.z));
    let half_std = direction_below_pole(u.y * (1.0 + stretched.z), TWO_PI * u.x) + stretched;
    let h = normalize(vec3f(p.alpha_x * half_std.x, p.alpha_y * half_std.y, half_std.z));
    return 2.0 * dot(wo, h) * h - wo;
}

/// D_visible / (4 wo.h) = G1(wo) D / (4 cos(wo)).
fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return 0.5 * distribution(p, wo + wi) / (wo.z + stretched_length(p, wo));
}

/// F G2 / G1(wo): D has cancelled.
fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let g2_over_g1 = 2.0 * visibility(p, wo, wi) * wi.z * (wo.z + stretched_length(p, wo));
    return fresnel(p, wo + wi) * g2_over_g1;
}
