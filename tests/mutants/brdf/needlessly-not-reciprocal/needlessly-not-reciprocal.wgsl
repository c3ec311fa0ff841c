// Lambert that declares not to be reciprocal.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * INV_PI;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let r = sqrt(u.x);
    return vec3f(r * cos(TWO_PI * u.y), r * sin(TWO_PI * u.y), sqrt(1.0 - u.x));
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return wi.z * INV_PI;
}
