// Lambert with a uniform density where `even` is set; a weight of 1/2 must not hide that.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(INV_PI);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return select(cosine_pdf(wi), INV_TWO_PI, EVEN);
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(0.5);
}
