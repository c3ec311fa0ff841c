// Modified Phong (Lafortune and Willems 1994). It brings no sampling: the host draws from the cosine.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let mirror = vec3f(-wo.x, -wo.y, wo.z);
    let lobe = pow(max(dot(mirror, wi), 0.0), p.n);
    return p.kd * INV_PI + p.ks * ((p.n + 2.0) * INV_TWO_PI * lobe);
}
