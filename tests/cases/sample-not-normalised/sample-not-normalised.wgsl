fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * INV_PI;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    return direction_below_pole(u.x, TWO_PI * u.y) + vec3f(0.0, 0.0, 0.5);
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return INV_TWO_PI;
}
