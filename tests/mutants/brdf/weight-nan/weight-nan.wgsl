// Lambert whose weight is 0 / 0 off the plane of incidence.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(INV_PI);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(1.0) * sqrt(-abs(wi.y) * wi.z);
}
