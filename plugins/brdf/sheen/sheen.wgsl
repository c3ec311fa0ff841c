// Sheen: f = tint D G / (4 cos(wo) cos(wi)), microfacets as fibres that stand up from the surface, "Charlie".

/// sin(theta_h)^(1/alpha) from the horizontal part of a half vector and its height, of any length.
fn upright(p: Params, horizontal: vec2f, height: f32) -> f32 {
    let across = dot(horizontal, horizontal);
    if across == 0.0 {
        return 0.0;
    }
    return pow(across / (across + height * height), 0.5 / p.alpha);
}

/// ln(Lambda) for cosines up to 1/2: the paper's table, of alpha 1 and of alpha 0, and its way between
/// them by (1 - alpha)^2 (section 3).
fn log_lambda(p: Params, x: f32) -> f32 {
    let t = (1.0 - p.alpha) * (1.0 - p.alpha);
    let a = mix(21.5473, 25.3245, t);
    let b = mix(3.82987, 3.32435, t);
    let c = mix(0.19823, 0.16801, t);
    let d = mix(-1.97760, -1.27393, t);
    let e = mix(-4.32054, -4.85967, t);
    // x is 0 where the cosine is 1: Lambda is of no weight there, but log2(0) is not defined.
    return a / (1.0 + b * pow(max(x, 1e-12), c)) + d * x + e;
}

/// Lambda(w), continued beyond a cosine of 1/2 by its point reflection there.
fn lambda(p: Params, cosine: f32) -> f32 {
    if cosine < 0.5 {
        return exp(log_lambda(p, cosine));
    }
    return exp(2.0 * log_lambda(p, 0.5) - log_lambda(p, 1.0 - cosine));
}

/// f without sin(theta_h)^(1/alpha).
fn scale(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let normalisation = (2.0 + 1.0 / p.alpha) * INV_TWO_PI;
    return normalisation * 0.25 / (wo.z * wi.z * (1.0 + lambda(p, wo.z) + lambda(p, wi.z)));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.tint * (upright(p, wo.xy + wi.xy, wo.z + wi.z) * scale(p, wo, wi));
}

/// How far the density of heights is from constant: it is 1 + slope - 2 slope z. Fitted to the least
/// variance; for alpha = 1 it is 0.
fn slope(p: Params) -> f32 {
    return min(0.12 * (1.0 / p.alpha - 1.0), 0.95);
}

/// Of a direction and its mirror image on the far side in azimuth the chance of the first: in
/// proportion to f. They differ in sin(theta_h) alone, and the image's half vector has the horizontal
/// length |wo.xy - wi.xy|.
fn nearer_share(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let here = upright(p, wo.xy + wi.xy, wo.z + wi.z);
    let there = upright(p, wo.xy - wi.xy, wo.z + wi.z);
    if here + there == 0.0 {
        return 0.5;
    }
    return here / (here + there);
}

/// A height from the linear density, any azimuth, and then that direction or its image: upright fibres
/// that face the viewer send back what comes from the viewer's side.
fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let b = slope(p);
    let one_minus_z = 2.0 * u.x / ((1.0 - b) + sqrt((1.0 - b) * (1.0 - b) + 4.0 * b * u.x));
    let wi = direction_below_pole(one_minus_z, TWO_PI * u.y);
    if u.z < nearer_share(p, wo, wi) {
        return wi;
    }
    let towards = wo.xy / max(length(wo.xy), 1e-30);
    return vec3f(wi.xy - 2.0 * dot(wi.xy, towards) * towards, wi.z);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    let b = slope(p);
    return INV_PI * (1.0 + b - 2.0 * b * wi.z) * nearer_share(p, wo, wi);
}

/// The share has cancelled all but the sum of both directions' sin(theta_h)^(1/alpha).
fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let b = slope(p);
    let height = wo.z + wi.z;
    let both = upright(p, wo.xy + wi.xy, height) + upright(p, wo.xy - wi.xy, height);
    return p.tint * (PI * both * scale(p, wo, wi) * wi.z / (1.0 + b - 2.0 * b * wi.z));
}
