// Cosine-weighted sampling of the hemisphere.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let wi = cosine_sample(next_2d(s));
    let p = cosine_pdf(wi);
    if p <= 0.0 {
        return vec3f(0.0);
    }
    return brdf_cos(hit.wo, wi) * env_radiance(to_world(hit, wi)) / p;
}
