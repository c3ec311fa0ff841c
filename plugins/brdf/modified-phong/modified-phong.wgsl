// Modified Phong: a diffuse part and a normalised lobe around the mirror direction, each sampled as it is.
//
// A large exponent multiplies every error of the cosine's logarithm, so no cosine near 1 enters: it is
// 1 - |r - wi|^2 / 2 there, of which the logarithm is taken as a series, and `sample` draws 1 - cos directly.

/// max(cos(r, wi), 0)^n, r the mirror direction of `wo`.
fn lobe(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let r = vec3f(-wo.xy, wo.z);
    let cosine = max(dot(r, wi), 0.0);
    if cosine == 0.0 {
        return 0.0;
    }
    if cosine < 0.5 {
        return exp(p.n * log(cosine));
    }
    let chord = r - wi;
    return exp(p.n * log1p(-0.5 * dot(chord, chord)));
}

/// Lafortune and Willems 1994, eq. 3 and 6.
fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.kd * INV_PI + p.ks * ((p.n + 2.0) * INV_TWO_PI * lobe(p, wo, wi));
}

/// How often the lobe and the cosine are drawn: by their parts of the albedo at `wo`.
fn shares(p: Params, wo: vec3f) -> vec2f {
    // What is left of the lobe above the horizon: wo.z where it is narrow, and at grazing angles the mean
    // height of the upper half of a normal distribution of variance 1 / n; off by less than a quarter.
    let width = 1.0 / (1.0 + 0.5 * PI * p.n);
    let above = min(0.5 * (wo.z + sqrt(wo.z * wo.z + width)), 1.0);
    let parts = vec2f(above * dot(p.ks, vec3f(1.0)), dot(p.kd, vec3f(1.0)));
    if parts.x <= 0.0 {
        return vec2f(0.0, 1.0);
    }
    return parts / (parts.x + parts.y);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    if u.z >= shares(p, wo).x {
        return cosine_sample(u.xy);
    }
    // cos = xi^(1 / (n + 1)) around the mirror direction, with xi = 1 - u.x, which is never 0.
    let local = direction_below_pole(-expm1(log1p(-u.x) / (p.n + 1.0)), TWO_PI * u.y);
    // The rotation that takes +z to r the shortest way; 1 + r.z is never small.
    let r = vec3f(-wo.xy, wo.z);
    let along = dot(local.xy, r.xy);
    return vec3f(local.xy + r.xy * (local.z - along / (1.0 + r.z)), local.z * r.z - along);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return dot(shares(p, wo), vec2f((p.n + 1.0) * INV_TWO_PI * lobe(p, wo, wi), cosine_pdf(wi)));
}
