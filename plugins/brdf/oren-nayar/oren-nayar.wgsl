// Oren-Nayar: Lambertian facets that mask, shadow and light each other, in V-cavities. Sampled by the cosine.
//
// No angle is taken from its cosine. The paper's alpha is the larger angle with the normal and beta the
// smaller one, so sin(alpha) tan(beta) cos(dphi) = s / max(cos_o, cos_i), with s the dot product of the
// horizontal parts: neither the pole nor grazing directions are special cases.

/// sigma^2 / (sigma^2 + offset), sigma in radians: all that the fits make of the facets' spread.
fn saturation(p: Params, offset: f32) -> f32 {
    let sigma = p.sigma * (PI / 180.0);
    return sigma * sigma / (sigma * sigma + offset);
}

/// Light that has met two facets, as a part of albedo^2 / pi, where azimuths do not matter.
fn two_bounces(p: Params) -> f32 {
    return 0.17 * saturation(p, 0.13);
}

/// pi f / albedo of all terms of the 1994 fit, for three albedos. `upper` is the direction at beta,
/// `lower` that at alpha.
fn full(p: Params, upper: vec3f, lower: vec3f) -> vec3f {
    let sin_beta = length(upper.xy);
    let sin_alpha = length(lower.xy);
    // Without azimuth, at the pole, all that these are multiplied with is 0.
    let area = max(sin_alpha * sin_beta, 1e-30);
    let cos_dphi = dot(upper.xy, lower.xy) / area;
    let sin_dphi = (upper.x * lower.y - upper.y * lower.x) / area;

    // rise = 1 - 2 beta / pi, from the horizon: at grazing directions 1 - (2 beta / pi)^3 is small
    // and tan(beta) large.
    let rise = 2.0 * INV_PI * atan2(upper.z, sin_beta);
    let fall = 1.0 - rise;
    var c2 = sin_alpha;
    if cos_dphi < 0.0 {
        c2 = rise * (3.0 - 3.0 * rise + rise * rise) - lower.z * lower.z / (1.0 + sin_alpha);
    }
    let alpha = 0.5 * PI - atan2(lower.z, sin_alpha);
    let both = fall * (2.0 * INV_PI) * alpha;

    let c1 = 1.0 - 0.5 * saturation(p, 0.33);
    let along = 0.45 * saturation(p, 0.09) * cos_dphi * c2 * sin_beta / upper.z;
    // 1 - |cos(dphi)|, and tan((alpha + beta) / 2) as a quotient of sums.
    let aside = sin_dphi * sin_dphi / (1.0 + abs(cos_dphi));
    let across = 0.125 * saturation(p, 0.09) * both * both * aside * (sin_alpha + sin_beta) / (upper.z + lower.z);
    let twice = two_bounces(p) * (1.0 - cos_dphi * fall * fall);
    // For sigma above 40 degrees and little albedo the fit falls below 0 where light and viewer graze
    // the surface from opposite sides.
    return max(vec3f(c1 + along + across) + p.albedo * twice, vec3f(0.0));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    if FORM == FORM_FULL {
        return p.albedo * INV_PI * full(p, select(wi, wo, wo.z > wi.z), select(wo, wi, wo.z > wi.z));
    }
    let a = 1.0 - 0.5 * saturation(p, 0.33);
    let b = 0.45 * saturation(p, 0.09);
    let s = dot(wo.xy, wi.xy);
    let towards = max(s, 0.0) / max(wo.z, wi.z);
    if FORM == FORM_FUJII {
        return p.albedo * INV_PI * (a + b * (towards + min(s, 0.0)) + p.albedo * two_bounces(p));
    }
    return p.albedo * (INV_PI * (a + b * towards));
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return PI * eval(p, wo, wi);
}
