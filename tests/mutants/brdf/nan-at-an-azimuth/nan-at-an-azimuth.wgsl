// GGX with a grazing term that divides by wo.y, which is 0 along the tangent.

fn stretched_length(p: Params, w: vec3f) -> f32 {
    return length(vec3f(p.alpha_x * w.x, p.alpha_y * w.y, w.z));
}

fn distribution(p: Params, m: vec3f) -> f32 {
    let stretched = vec3f(m.x / p.alpha_x, m.y / p.alpha_y, m.z);
    let ratio = dot(m, m) / dot(stretched, stretched);
    return INV_PI * (ratio / p.alpha_x) * (ratio / p.alpha_y);
}

/// 1, by way of the squared sine and cosine of the azimuth.
fn graze(wo: vec3f) -> f32 {
    if wo.z > 0.02 {
        return 1.0;
    }
    let slope = wo.x / wo.y;
    let square = slope * slope;
    return square / (1.0 + square) + 1.0 / (1.0 + square);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let visibility = graze(wo) / ((wo.z + stretched_length(p, wo)) * (wi.z + stretched_length(p, wi)));
    return vec3f(distribution(p, wo + wi) * visibility);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let alpha = vec2f(p.alpha_x, p.alpha_y);
    let stretched = normalize(vec3f(alpha * wo.xy, wo.z));
    let cap = direction_below_pole(u.y * (1.0 + stretched.z), TWO_PI * u.x) + stretched;
    let h = normalize(vec3f(alpha * cap.xy, cap.z));
    return 2.0 * dot(wo, h) * h - wo;
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return 0.5 * distribution(p, wo + wi) / (wo.z + stretched_length(p, wo));
}
