fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let mirror = vec3f(-wo.xy, wo.z);
    return select(vec3f(0.0), p.albedo / wi.z, distance(mirror, wi) < 1e-6);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return vec3f(-wo.xy, wo.z);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return 1.0;
}
