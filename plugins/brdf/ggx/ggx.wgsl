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

/// Schlick's Fresnel term at the angle between `wo` and the half vector. Its cosine is c = |wo + wi| / 2;
/// 1 - c comes from 1 - c^2 = |wo - wi|^2 / 4, which keeps its digits where c is close to 1.
fn fresnel(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let sum = wo + wi;
    let difference = wo - wi;
    let one_minus_c = min(dot(difference, difference) / (4.0 + 2.0 * length(sum)), 1.0);
    return p.f0 + (1.0 - p.f0) * pow5(one_minus_c);
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
    return fresnel(p, wo, wi) * (distribution(p, m) * visibility(p, wo, wi));
}

/// Visible normals by spherical caps: in the space where alpha is 1 the reflected direction is
/// uniform on the cap z > -wo.z, and the half vector is the sum of both (Dupuy and Benyoub 2023).
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let stretched = normalize(vec3f(p.alpha_x * wo.x, p.alpha_y * wo.y, wo.z));
    // The cap's point has the height 1 - u.y (1 + z); neither its radius nor the sum's height
    // subtracts close numbers when they are written so.
    let depth = 1.0 + stretched.z;
    let rest = (1.0 - u.y) * depth;
    let r = sqrt(u.y * (dot(stretched.xy, stretched.xy) + rest * depth));
    let phi = TWO_PI * u.x;
    let half_std = vec3f(r * cos(phi) + stretched.x, r * sin(phi) + stretched.y, rest);
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
    return fresnel(p, wo, wi) * g2_over_g1;
}
