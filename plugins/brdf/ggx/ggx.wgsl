// GGX: f = F D G2 / (4 cos(wo) cos(wi)), with bounded visible-normal sampling.
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

/// The reflectance of a smooth surface whose index of refraction is n + i k, for unpolarised light at
/// an angle of cosine `c` and sine^2 `s2`. With a + i b = sqrt((n + i k)^2 - s2) it is
/// (Rs + Rp) / 2, Rs = ((a - c)^2 + b^2) / ((a + c)^2 + b^2), and Rp / Rs likewise of a c, s2 and b c
/// (Born and Wolf, 14.4).
fn exact_fresnel(n: vec3f, k: vec3f, c: f32, s2: f32) -> vec3f {
    let excess = (n - 1.0) * (n + 1.0);
    let real_part = select(n * n - s2, excess + c * c, n >= vec3f(1.0)) - k * k;
    let imaginary_part = n * k;
    // The root's larger part is a sum; the smaller one follows from a b = n k.
    let modulus = sqrt(real_part * real_part + 4.0 * imaginary_part * imaginary_part);
    let larger = sqrt(0.5 * (modulus + abs(real_part)));
    let smaller = imaginary_part / max(larger, vec3f(1e-18));
    let a = select(smaller, larger, real_part > vec3f(0.0));
    let b = select(larger, smaller, real_part > vec3f(0.0));
    // Where b is small, an index near 1 makes a - c the difference of close numbers; a^2 - c^2 has its digits.
    let from_squares = (excess - (k - b) * (k + b)) / (a + c);
    let gap = select(a - c, from_squares, b < 0.25 * (a + c));
    let rs = (gap * gap + b * b) / ((a + c) * (a + c) + b * b);
    let bc2 = (b * c) * (b * c);
    let rp_over_rs = ((a * c - s2) * (a * c - s2) + bc2) / ((a * c + s2) * (a * c + s2) + bc2);
    return rs * (0.5 + 0.5 * rp_over_rs);
}

/// F at the angle between `wo` and the half vector: its cosine is c = |wo + wi| / 2, its sine
/// |wo - wi| / 2. For Schlick's, 1 - c comes from 1 - c^2, which keeps its digits where c is close to 1.
fn fresnel(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let sum = wo + wi;
    let difference = wo - wi;
    if FRESNEL == FRESNEL_DIELECTRIC {
        return exact_fresnel(vec3f(p.eta), vec3f(0.0), 0.5 * length(sum), 0.25 * dot(difference, difference));
    }
    if FRESNEL == FRESNEL_CONDUCTOR {
        return exact_fresnel(p.metal_eta, p.metal_k, 0.5 * length(sum), 0.25 * dot(difference, difference));
    }
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

/// x: k, which lowers the cap's rim from -z to -k z and costs no direction above the horizon
/// (Eto and Tokuyoshi 2023, eq. 5, with the smaller alpha); y: 1 - k, which is not to be had from k.
fn cap_bound(p: Params, wo: vec3f) -> vec2f {
    let a = min(p.alpha_x, p.alpha_y);
    let s = 1.0 + length(wo.xy);
    let scale = 1.0 / (s * s + a * a * wo.z * wo.z);
    return vec2f((1.0 - a) * (1.0 + a) * s * s, a * a * (s * s + wo.z * wo.z)) * scale;
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    return fresnel(p, wo, wi) * (distribution(p, m) * visibility(p, wo, wi));
}

/// Visible normals by spherical caps: in the space where alpha is 1 the reflected direction is
/// uniform on the cap z > -k wo.z, and the half vector is the sum of both (Dupuy and Benyoub 2023;
/// the bound k by Eto and Tokuyoshi 2023).
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let stretched = normalize(vec3f(p.alpha_x * wo.x, p.alpha_y * wo.y, wo.z));
    let bound = cap_bound(p, wo);
    // The cap's point has the height 1 - u.y (1 + k z); neither its radius nor the sum's height
    // subtracts close numbers when they are written so.
    let depth = 1.0 + bound.x * stretched.z;
    let rest = (1.0 - u.y) * depth;
    let lift = bound.y * stretched.z;
    let rim2 = dot(stretched.xy, stretched.xy) + lift * (1.0 + bound.x) * stretched.z;
    let r = sqrt(u.y * (rim2 + rest * depth));
    let phi = TWO_PI * u.x;
    let half_std = vec3f(r * cos(phi) + stretched.x, r * sin(phi) + stretched.y, rest + lift);
    let h = normalize(vec3f(p.alpha_x * half_std.x, p.alpha_y * half_std.y, half_std.z));
    return 2.0 * dot(wo, h) * h - wo;
}

/// D_visible / (4 wo.h) = D / (2 (cos(wo) + len)), on the smaller cap D / (2 (k cos(wo) + len)).
fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return 0.5 * distribution(p, wo + wi) / (cap_bound(p, wo).x * wo.z + stretched_length(p, wo));
}

/// F G2 / G1(wo), less the part of the cap that is left out: D has cancelled.
fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let cap = cap_bound(p, wo).x * wo.z + stretched_length(p, wo);
    return fresnel(p, wo, wi) * (2.0 * visibility(p, wo, wi) * wi.z * cap);
}
