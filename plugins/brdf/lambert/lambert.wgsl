// Lambert: f = albedo / pi, sampled by the cosine, which makes the weight the albedo itself.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * INV_PI;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo;
}
