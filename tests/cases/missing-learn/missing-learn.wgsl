fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>, state: ptr<function, State>) -> vec3f {
    return vec3f(0.0);
}
