// The kernel of `brdf numerics`: one of the author's functions alone, for a list of cases.
//
// It calls the author's function itself, so that every error in the outcome is the author's. The
// linker supplies FUNCTION and its four values; the branches on it are decided while linking.

/// Unit directions above the horizon, and a point of [0, 1)^3; `sample` takes wo and u, the others wo and wi.
struct Case {
    wo: vec3f,
    wi: vec3f,
    u: vec3f,
}

/// What the function gave; `pdf` in all three.
struct Outcome {
    value: vec3f,
}

@group(0) @binding(4) var<storage, read> cases: array<Case>;
@group(0) @binding(5) var<storage, read_write> outcomes: array<Outcome>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&outcomes) {
        return;
    }
    let c = cases[i];
    var value = vec3f(0.0);
    if FUNCTION == FUNCTION_EVAL {
        value = author_eval(c.wo, c.wi);
    } else if FUNCTION == FUNCTION_PDF {
        value = vec3f(author_pdf(c.wo, c.wi));
    } else if FUNCTION == FUNCTION_SAMPLE {
        value = author_sample(c.wo, c.u);
    } else {
        value = author_weight(c.wo, c.wi);
    }
    outcomes[i].value = value;
}
