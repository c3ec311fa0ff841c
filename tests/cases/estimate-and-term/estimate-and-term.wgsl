fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    return vec3f(0.0);
}

fn term(q: Settings, hit: Hit, k: u32, sum: ptr<function, Quadrature>) -> vec3f {
    return vec3f(0.0);
}
