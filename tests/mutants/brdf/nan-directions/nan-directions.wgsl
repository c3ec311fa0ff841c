// Lambert; the root is that of a negative number for every second sample.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(INV_PI);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let lost = 0.0 * sqrt(u.z - 0.5);
    return vec3f(lost) + cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}
