// Lambert that draws from one half of the hemisphere alone: its pdf is right, and light is missed.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * INV_PI;
}

fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f {
    let r = sqrt(u.x);
    return vec3f(r * sin(PI * u.y), r * cos(PI * u.y), sqrt(1.0 - u.x));
}

fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 {
    return select(0.0, 2.0 * cosine_pdf(wi), wi.x >= 0.0);
}
