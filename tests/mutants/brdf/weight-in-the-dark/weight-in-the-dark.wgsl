// Half of Lambert, whose weight is 1 in the other half too.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return select(vec3f(0.0), vec3f(INV_PI), wi.x * wo.x <= 0.0);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(1.0);
}
