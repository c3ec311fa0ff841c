// Lambert times 1/2: consistent with itself, and wrong.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return 0.5 * p.albedo * INV_PI;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}
