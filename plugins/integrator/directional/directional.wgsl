// A light of no extent: one term, no integral, no noise.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let theta = q.theta * (PI / 180.0);
    let phi = q.phi * (PI / 180.0);
    let dir = vec3f(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
    return brdf_cos(hit.wo, to_local(hit, dir)) * q.irradiance;
}
