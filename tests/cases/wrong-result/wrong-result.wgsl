fn helper() -> f32 {
    return 1.0;
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return helper();
}
