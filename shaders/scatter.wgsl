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

/// f_r times the cosine of `wi` [1/sr], above the horizon.
fn value_cos(wo: vec3f, wi: vec3f) -> vec3f {
    return author_eval(wo, wi) * max(wi.z, 0.0);
}

/// f_r times the cosine of `wi` [1/sr], zero below the horizon.
fn brdf_cos(wo: vec3f, wi: vec3f) -> vec3f {
    if !above_horizon(wo, wi) {
        return vec3f(0.0);
    }
    return value_cos(wo, wi);
}

/// Density of `brdf_sample` [1/sr].
fn brdf_pdf(wo: vec3f, wi: vec3f) -> f32 {
    if !above_horizon(wo, wi) {
        return 0.0;
    }
    return author_pdf(wo, wi);
}

/// f_r cos and the density of `brdf_sample`, of one direction.
struct BrdfAt {
    cos: vec3f,
    pdf: f32,
}

/// `brdf_cos` and `brdf_pdf` together: what both look up is looked up once.
fn brdf_at(wo: vec3f, wi: vec3f) -> BrdfAt {
    let is_above = above_horizon(wo, wi);
    // Wide machines compute a branch for lanes that do not take it, too: theirs look up one and the same place, and
    // not one far off in a table each.
    let above = select(vec3f(0.0, 0.0, 1.0), wi, is_above);
    if !is_above {
        return BrdfAt(vec3f(0.0), 0.0);
    }
    return BrdfAt(value_cos(wo, above), author_pdf(wo, above));
}

/// f cos / pdf, zero below the horizon; `at` is what `brdf_at` gives there.
fn weight_of(wo: vec3f, wi: vec3f, at: BrdfAt) -> vec3f {
    if !above_horizon(wo, wi) {
        return vec3f(0.0);
    }
    if AUTHOR_WEIGHS {
        return author_weight(wo, wi);
    }
    return at.cos / at.pdf;
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
    let at = brdf_at(wo, wi);
    return BrdfSample(wi, weight_of(wo, wi, at), at.pdf);
}
