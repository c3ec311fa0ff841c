// BRDF importance sampling: the weight holds f cos / pdf.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let drawn = brdf_sample(hit.wo, next_3d(s));
    if all(drawn.weight == vec3f(0.0)) {
        return vec3f(0.0);
    }
    return drawn.weight * env_radiance(to_world(hit, drawn.wi));
}
