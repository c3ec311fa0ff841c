// Lambert whose eval includes the cosine, which the host multiplies by once more.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * (INV_PI * wi.z);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return cosine_sample(u.xy);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return cosine_pdf(wi);
}
