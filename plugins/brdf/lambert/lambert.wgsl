// Lambert: f = albedo / pi, sampled by the cosine, which makes the weight the albedo itself.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * INV_PI;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let r = sqrt(u.x);
    let phi = TWO_PI * u.y;
    return vec3f(r * cos(phi), r * sin(phi), sqrt(1.0 - u.x));
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return wi.z * INV_PI;
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo;
}
