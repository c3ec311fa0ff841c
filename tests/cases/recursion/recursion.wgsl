fn half(x: f32) -> f32 {
    return half(0.5 * x);
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(half(1.0));
}
