fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    return hits[0].wo;
}
