// Burley 2012: a diffuse part with sheen, a GGX lobe (GTR2) and a clear coat (GTR1).
//
// Everything is written in m = wo + wi: the half vector h is m / |m|, (wo.h) is |m| / 2, and
// 1 - (wo.h) follows from |wo - wi|, so that no term subtracts close numbers.

/// Schlick's (1 - cos)^5 at the angle between `wo` and the half vector.
fn fresnel_weight(wo: vec3f, wi: vec3f) -> f32 {
    let difference = wo - wi;
    return pow5(min(dot(difference, difference) / (4.0 + 2.0 * length(wo + wi)), 1.0));
}

/// The hue of the base colour: the colour over its luminance.
fn tint(p: Params) -> vec3f {
    let luminance = dot(p.base_color, vec3f(0.3, 0.6, 0.1));
    return select(vec3f(1.0), p.base_color / max(luminance, 1e-30), luminance > 0.0);
}

/// From 1 at the normal to `end` at the horizon by Schlick's weight; 1 - (1 - z)^5 is written as a sum.
fn grazing_factor(end: f32, z: f32) -> f32 {
    let q = 1.0 - z;
    let q2 = q * q;
    return z * (1.0 + q + q2 + q2 * q + q2 * q2) + end * (q2 * q2 * q);
}

/// The diffuse part, between retro-reflection by roughness and scattering below the surface after
/// Hanrahan and Krueger, and the sheen [1/sr].
fn diffuse(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let sum = wo + wi;
    // roughness (wo.h)^2: what flattened scattering has at grazing angles, and twice that and a half without.
    let grazing = 0.25 * p.roughness * dot(sum, sum);
    let rough = grazing_factor(0.5 + 2.0 * grazing, wo.z) * grazing_factor(0.5 + 2.0 * grazing, wi.z);
    let flat_albedo = grazing_factor(grazing, wo.z) * grazing_factor(grazing, wi.z);
    let below = 1.25 * (flat_albedo * (1.0 / (wo.z + wi.z) - 0.5) + 0.5);
    let sheen = p.sheen * fresnel_weight(wo, wi) * mix(vec3f(1.0), tint(p), p.sheen_tint);
    return (INV_PI * mix(rough, below, p.subsurface) * p.base_color + sheen) * (1.0 - p.metallic);
}

/// The GGX lobe's alphas along tangent and bitangent.
fn alphas(p: Params) -> vec2f {
    let aspect = sqrt(1.0 - 0.9 * p.anisotropic);
    let alpha = p.roughness * p.roughness;
    return max(vec2f(alpha / aspect, alpha * aspect), vec2f(0.001));
}

/// |(ax w.x, ay w.y, w.z)|.
fn stretched_length(alpha: vec2f, w: vec3f) -> f32 {
    return length(vec3f(alpha * w.xy, w.z));
}

/// GTR2 is GGX: 1 / (pi ax ay |(hx/ax, hy/ay, hz)|^4) [1/sr].
fn gtr2(alpha: vec2f, m: vec3f) -> f32 {
    let stretched = vec3f(m.xy / alpha, m.z);
    let ratio = dot(m, m) / dot(stretched, stretched);
    return INV_PI * (ratio / alpha.x) * (ratio / alpha.y);
}

/// G1 / (2 cos) of GGX facets.
fn half_visibility(alpha: f32, cosine: f32) -> f32 {
    return 1.0 / (cosine + sqrt(alpha * alpha + (1.0 - alpha) * (1.0 + alpha) * cosine * cosine));
}

fn specular_f0(p: Params) -> vec3f {
    let dielectric = 0.08 * p.specular * mix(vec3f(1.0), tint(p), p.specular_tint);
    return mix(dielectric, p.base_color, p.metallic);
}

/// F D G / (4 cos(wo) cos(wi)); G has a roughness of its own, from 0.5 to 1.
fn specular(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let root = 0.5 + 0.5 * p.roughness;
    let visibility = half_visibility(root * root, wo.z) * half_visibility(root * root, wi.z);
    return mix(specular_f0(p), vec3f(1.0), fresnel_weight(wo, wi)) * (visibility * gtr2(alphas(p), wo + wi));
}

fn coat_alpha(p: Params) -> f32 {
    return mix(0.1, 0.001, p.clearcoat_gloss);
}

/// GTR1 [1/sr]: (a^2 - 1) / (pi log(a^2) (hx^2 + hy^2 + a^2 hz^2)).
fn gtr1(a: f32, m: vec3f) -> f32 {
    let norm = (1.0 - a) * (1.0 + a) / (-2.0 * PI * log(a));
    return norm * dot(m, m) / (dot(m.xy, m.xy) + a * a * m.z * m.z);
}

/// The clear coat: a quarter of GTR1 with an index of 1.5 and a G of roughness 0.25.
fn coat(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let visibility = half_visibility(0.25, wo.z) * half_visibility(0.25, wi.z);
    let f = mix(0.04, 1.0, fresnel_weight(wo, wi));
    return 0.25 * p.clearcoat * f * (visibility * gtr1(coat_alpha(p), wo + wi));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return diffuse(p, wo, wi) + specular(p, wo, wi) + coat(p, wo, wi);
}

/// G1 of GGX facets.
fn g1(alpha: f32, cosine: f32) -> f32 {
    return 2.0 * cosine * half_visibility(alpha, cosine);
}

/// Probabilities of diffuse part, GGX lobe and coat: nearly their part in the albedo at `wo`, by fits
/// of ours, at least about 0.02 each, and 0 where there is none.
fn shares(p: Params, wo: vec3f) -> vec3f {
    let grazing = pow5(1.0 - wo.z);
    let base = dot(p.base_color, vec3f(1.0 / 3.0));
    let below = base * (1.0 + (p.roughness - 0.5) * grazing) + 0.09 * p.sheen * sqrt(grazing);
    // What reaches the facets over what GGX's own G1 lets through, and what leaves again; rough
    // facets turn light away from the horizon and are seen less obliquely.
    let root = 0.5 + 0.5 * p.roughness;
    let alpha = p.roughness * p.roughness;
    let passed = g1(root * root, wo.z) / g1(alpha, wo.z) * g1(root * root, mix(wo.z, 0.6, p.roughness));
    let f = pow5(1.0 - min(length(vec2f(wo.z, 0.6 * p.roughness)), 1.0));
    let gloss = max(passed * mix(dot(specular_f0(p), vec3f(1.0 / 3.0)), 1.0, f), 1e-6);
    let part = vec3f((1.0 - p.metallic) * below, gloss, p.clearcoat * (0.008 + 0.04 * sqrt(grazing)));
    let there = select(vec3f(0.0), vec3f(0.02), part > vec3f(0.0));
    let share = max(part / (part.x + part.y + part.z), there);
    return share / (share.x + share.y + share.z);
}

/// x: k of the cap z > -k wo.z that holds all directions above the horizon; y: 1 - k
/// (Eto and Tokuyoshi 2023, eq. 5).
fn cap_bound(alpha: vec2f, wo: vec3f) -> vec2f {
    let a = min(min(alpha.x, alpha.y), 1.0);
    let s = 1.0 + length(wo.xy);
    let scale = 1.0 / (s * s + a * a * wo.z * wo.z);
    return vec2f((1.0 - a) * (1.0 + a) * s * s, a * a * (s * s + wo.z * wo.z)) * scale;
}

/// Visible normals of GTR2 by the bounded spherical cap (Dupuy and Benyoub 2023).
fn sample_gtr2(p: Params, wo: vec3f, u: vec2f) -> vec3f {
    let alpha = alphas(p);
    let stretched = normalize(vec3f(alpha * wo.xy, wo.z));
    let bound = cap_bound(alpha, wo);
    let depth = 1.0 + bound.x * stretched.z;
    let rest = (1.0 - u.y) * depth;
    let lift = bound.y * stretched.z;
    let rim2 = dot(stretched.xy, stretched.xy) + lift * (1.0 + bound.x) * stretched.z;
    let r = sqrt(u.y * (rim2 + rest * depth));
    let phi = TWO_PI * u.x;
    let half_std = vec3f(r * cos(phi) + stretched.x, r * sin(phi) + stretched.y, rest + lift);
    let h = normalize(vec3f(alpha * half_std.xy, half_std.z));
    return 2.0 * dot(wo, h) * h - wo;
}

fn pdf_gtr2(p: Params, wo: vec3f, m: vec3f) -> f32 {
    let alpha = alphas(p);
    return 0.5 * gtr2(alpha, m) / (cap_bound(alpha, wo).x * wo.z + stretched_length(alpha, wo));
}

/// Whether the facet of this slope reflects `wo` above the horizon; then it also faces `wo`.
fn reflects(wo: vec3f, slope: vec2f) -> bool {
    return wo.z * (1.0 - dot(slope, slope)) + 2.0 * dot(wo.xy, slope) > 0.0;
}

/// A slope drawn by GTR1, or its opposite: both would make a cavity, and the side is picked in
/// proportion to the area that the viewer sees (Heitz and d'Eon 2014, 4.2), if both reflect above the horizon.
fn sample_gtr1(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    // tan^2 of Burley's eq. 5 for cos^2, (1 - a^(2 - 2 u)) / (1 - a^2), where no difference cancels.
    let a = coat_alpha(p);
    let range = -2.0 * log(a);
    let slope = a * sqrt(expm1(u.y * range) / -expm1((u.y - 1.0) * range));
    let phi = TWO_PI * u.x;
    let side = vec2f(slope * cos(phi), slope * sin(phi));
    let lean = dot(wo.xy, side);
    let area = select(0.0, wo.z + lean, reflects(wo, side));
    let other_area = select(0.0, wo.z - lean, reflects(wo, -side));
    // Where only one counts it is that one, also for a number that rounding has brought to 1.
    let picked = select(-side, side, (other_area == 0.0) | (u.z * (area + other_area) < area));
    let h = normalize(vec3f(picked, 1.0));
    return 2.0 * dot(wo, h) * h - wo;
}

/// 2 D h.z (wo.h) / (2 wo.z h.z) / (4 wo.h), or 2 D h.z / (4 wo.h) where the other side does not count.
fn pdf_gtr1(p: Params, wo: vec3f, m: vec3f) -> f32 {
    let both = reflects(wo, -m.xy / m.z);
    return gtr1(coat_alpha(p), m) * select(m.z / dot(m, m), 0.25 / wo.z, both);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let share = shares(p, wo);
    if u.z < share.x {
        return cosine_sample(u.yx);
    }
    let rest = u.z - share.x - share.y;
    if rest < 0.0 || share.z == 0.0 {
        return sample_gtr2(p, wo, u.xy);
    }
    return sample_gtr1(p, wo, vec3f(u.xy, rest / share.z));
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let m = wo + wi;
    let share = shares(p, wo);
    return dot(share, vec3f(cosine_pdf(wi), pdf_gtr2(p, wo, m), pdf_gtr1(p, wo, m)));
}
