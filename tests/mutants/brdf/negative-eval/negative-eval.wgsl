// Lambert less a little, which leaves less than nothing at grazing angles.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return p.albedo * INV_PI * min((wo.z * wi.z - 0.001) * 100.0, 1.0);
}
