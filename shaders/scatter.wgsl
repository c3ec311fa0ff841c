// The BRDF as integrators see it, in the local frame. The cosine and the horizon test stand here and nowhere else.
//
// The linker supplies `author_eval`, `author_sample`, `author_pdf`, and `author_weight` with
// AUTHOR_WEIGHS, which says whether the author gave one.

/// A direction drawn from the BRDF: `pdf` [1/sr] and `weight` = f cos / pdf; no sample where `pdf` is 0.
struct BrdfSample {
    wi: vec3f,
    weight: vec3f,
    pdf: f32,
}

/// Whether light from `wi` can leave towards `wo`.
fn above_horizon(wo: vec3f, wi: vec3f) -> bool {
    return wo.z > 0.0 && wi.z > 0.0;
}

/// Whether no light comes from directions within the chord `radius` of `axis`, a unit vector.
fn cone_is_below_horizon(axis: vec3f, radius: f32) -> bool {
    return axis.z < -radius;
}

/// Whether some but not all directions within the chord `radius` of `axis` lie below the horizon.
fn cone_meets_horizon(axis: vec3f, radius: f32) -> bool {
    return abs(axis.z) <= radius;
}

/// f_r [1/sr], zero below the horizon.
fn brdf_value(wo: vec3f, wi: vec3f) -> vec3f {
    if !above_horizon(wo, wi) {
        return vec3f(0.0);
    }
    return author_eval(wo, wi);
}

/// f_r times the cosine of `wi` [1/sr].
fn brdf_cos(wo: vec3f, wi: vec3f) -> vec3f {
    return brdf_value(wo, wi) * max(wi.z, 0.0);
}

/// Density of `brdf_sample` [1/sr].
fn brdf_pdf(wo: vec3f, wi: vec3f) -> f32 {
    if !above_horizon(wo, wi) {
        return 0.0;
    }
    return author_pdf(wo, wi);
}

/// f cos / pdf of a direction above the horizon.
fn brdf_weight(wo: vec3f, wi: vec3f) -> vec3f {
    if !above_horizon(wo, wi) {
        return vec3f(0.0);
    }
    if AUTHOR_WEIGHS {
        return author_weight(wo, wi);
    }
    return brdf_cos(wo, wi) / author_pdf(wo, wi);
}

/// Whether every channel is finite, by its bits: drivers fold float comparisons with NaN away.
fn is_finite(v: vec3f) -> bool {
    let exponent = bitcast<vec3u>(v) & vec3u(0x7f800000u);
    return all(exponent != vec3u(0x7f800000u));
}

/// Draws a direction; `u` in [0, 1)^3. A direction that is Inf or NaN comes back with a weight of NaN,
/// so that it is counted and not taken for one below the horizon.
fn brdf_sample(wo: vec3f, u: vec3f) -> BrdfSample {
    let wi = author_sample(wo, u);
    if !is_finite(wi) {
        let nan = bitcast<f32>(bitcast<u32>(wi.x) | 0x7fc00000u);
        return BrdfSample(wi, vec3f(nan), 0.0);
    }
    return BrdfSample(wi, brdf_weight(wo, wi), brdf_pdf(wo, wi));
}

/// Cosine-weighted direction, for BRDFs that bring no sampling of their own: r^2 = u.x by Malley's method.
fn cosine_sample(u: vec2f) -> vec3f {
    let r = sqrt(u.x);
    let phi = TWO_PI * u.y;
    return vec3f(r * cos(phi), r * sin(phi), sqrt(1.0 - u.x));
}

/// Density of `cosine_sample` [1/sr].
fn cosine_pdf(wi: vec3f) -> f32 {
    return wi.z * INV_PI;
}
