// Half of Lambert, whose weight is 1 in the other half too.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return select(vec3f(0.0), vec3f(INV_PI), wi.x * wo.x <= 0.0);
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let r = sqrt(u.x);
    return vec3f(r * cos(TWO_PI * u.y), r * sin(TWO_PI * u.y), sqrt(1.0 - u.x));
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return wi.z * INV_PI;
}

fn weight(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(1.0);
}
