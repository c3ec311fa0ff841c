//! `isFunc`: sampling as the two dialects of the format have it.

use crate::common::{run, translated};

const MODEL: &str = "analytic\n::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return vec3(1.0); }\n::end shader\n::begin isFunc\n";

const PAIR: [[[f64; 3]; 2]; 1] = [[[0.6, 0.0, 0.8], [0.0, 0.28, 0.96]]];

#[test]
fn directions_come_back_by_result_or_by_argument() {
    let by_result = "vec3 sampleBRDF(float u, float v, vec3 normal, vec3 tangent, vec3 bitangent, vec3 wo, out float pdf) {\n\
                     pdf = 2.0; return normal * u + tangent * v + bitangent * wo.x;\n}\n\
                     float pdfBRDF(vec3 wi, vec3 wo, vec3 normal) { return dot(wi, normal) + 10.0 * wo.x; }\n::end isFunc\n";
    let by_argument = "vec3 sampleBRDF(float u, float v, vec3 normal, vec3 tangent, vec3 bitangent, out vec3 wi, out float pdf) {\n\
                       pdf = 1.0; wi = normal * u + tangent * v; return vec3(0.0);\n}\n\
                       float PDF(vec3 L, vec3 V) { return L.z + 10.0 * V.x; }\n::end isFunc\n";
    for (code, third) in [(by_result, 0.6), (by_argument, 0.0)] {
        let model = translated(&format!("{MODEL}{code}")).unwrap();
        assert!(model.notes.is_empty());
        let drawn = run(&model, &[], &[], "sample(p, wo, vec3f(0.25, 0.5, 0.75))", &PAIR);
        for (got, expected) in drawn[0].iter().zip([0.5, third, 0.25]) {
            assert!((got - expected).abs() < 1e-6, "{drawn:?}");
        }
        let density = run(&model, &[], &[], "vec3f(pdf(p, wo, wi))", &PAIR);
        assert!((density[0][0] - 6.96).abs() < 1e-5, "{density:?}");
    }
}

#[test]
fn half_of_a_sampler_is_told() {
    let code = "vec3 sampleBRDF(float u, float v, vec3 normal, vec3 tangent, vec3 bitangent, out vec3 wi, out float pdf) { wi = normal; pdf = 1.0; return wi; }\n::end isFunc\n";
    let model = translated(&format!("{MODEL}{code}")).unwrap();
    assert!(!model.wgsl.contains("fn sample("), "{}", model.wgsl);
    let note = "t.brdf: `sampleBRDF` draws directions, and no one function `pdf...` of wi (or L), wo (or V) and the frame tells the density of a given one: both are needed";
    assert_eq!(model.notes, [note]);
}

#[test]
fn densities_are_known_by_name_and_arguments() {
    let draws = "void sampleBRDF(vec2 u, vec3 normal, vec3 wo, out vec3 H, out vec3 L) { H = wo; L = normal * u.x; }\n";
    let model = translated(&format!("{MODEL}{draws}float ggxPdf(vec3 h, vec3 n) {{ return 77.; }}\nfloat pdfBRDF(vec3 wi, vec3 wo, vec3 normal) {{ return 5.; }}\n::end isFunc\n")).unwrap();
    assert!(model.notes.is_empty(), "{:?}", model.notes);
    assert_eq!(run(&model, &[], &[], "vec3f(pdf(p, wo, wi))", &PAIR)[0][0], 5.0);
    assert_eq!(
        run(&model, &[], &[], "sample(p, wo, vec3f(0.25, 0.5, 0.75))", &PAIR)[0],
        [0.0, 0.0, 0.25]
    );
    for density in [
        "float pdf(vec3 H, vec3 V) { return 1.; }",
        "float pdf(vec3 a, vec3 b) { return 1.; }",
        "float pdfWeight() { return 3.; }",
    ] {
        let model = translated(&format!("{MODEL}{draws}{density}\n::end isFunc\n")).unwrap();
        assert_eq!(model.notes.len(), 1, "{density}");
    }
}
