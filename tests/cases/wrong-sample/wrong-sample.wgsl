fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(INV_PI);
}

fn sample(p: Params, wo: vec3f, u: vec2f) -> vec3f {
    return vec3f(u, 1.0);
}
