//! The linker: names, positions, reachability, bindings, bounded loops; all without a device.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use brdf_host::link::{Form, Sampling, View, link};
use brdf_host::plugin::Configured;
use common::{brdf, from_text, integrator};

const BRDF: &str = "kind = \"brdf\"\nname = \"B\"\nabout = \"B.\"\n";
const INTEGRATOR: &str = "kind = \"integrator\"\nname = \"I\"\nabout = \"I.\"\n";
const EVAL: &str =
    "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    return vec3f(INV_PI);\n}\n";

fn film(brdf: Configured, integrator: Configured) -> View {
    View::Film { brdf, integrator, form: Form::default() }
}

#[test]
fn private_names_of_two_plugins_never_clash() {
    // Both are called `twin`, and both declare the same function, struct, constant and alias.
    let shared = "const SCALE: f32 = 2.0;\nalias Number = f32;\nstruct Data { x: Number, scale: f32 }\n\
                  fn helper(x: Number) -> f32 { let d = Data(x, SCALE); return d.x * d.scale; }\n";
    let b = from_text(
        "twin",
        BRDF,
        &format!(
            "{shared}fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{ return vec3f(helper(wo.z)); }}"
        ),
    );
    let i = from_text(
        "twin",
        INTEGRATOR,
        &format!(
            "{shared}fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {{ return brdf_cos(hit.wo, hit.wo) * helper(1.0); }}"
        ),
    );
    let program = link(&film(b, i)).unwrap();
    assert!(program.reached.text.contains("brdf_twin__helper"));
    assert!(program.reached.text.contains("integrator_twin__helper"));
}

#[test]
fn a_plugin_may_use_the_hosts_names_for_its_own() {
    // The prelude's pow5, the host's brdf_pdf and hits, as function, struct and local.
    let source = "fn pow5(x: f32) -> f32 { return x; }\nstruct Hit { hits: f32 }\n\
                  fn brdf_pdf(h: Hit) -> f32 { let work = h.hits; return pow5(work); }\n\
                  fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f { return vec3f(brdf_pdf(Hit(wo.z))); }";
    link(&film(from_text("own", BRDF, source), integrator("brdf-is", &[]))).unwrap();
}

#[test]
fn columns_hold_behind_renamed_names() {
    // `lobe` is renamed twice on the line before the error; the column must still be the author's.
    let source = "fn lobe(x: f32) -> f32 { return x; }\n\
                  fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f { return vec3f(lobe(lobe(gloss))); }";
    let problem = link(&View::Eval { brdf: from_text("columns", BRDF, source) }).unwrap_err();
    let place = problem.place.clone().unwrap();
    let column = source.lines().nth(1).unwrap().find("gloss").unwrap() + 1;
    assert_eq!((place.line, place.column, place.length), (2, column, 5), "{problem}");
    assert!(!problem.to_string().contains("brdf_columns__"), "{problem}");
}

#[test]
fn linking_is_a_function_of_its_input() {
    let view = || film(brdf("ggx", &["alpha_x=0.3"]), integrator("uniform", &[]));
    let (a, b) = (link(&view()).unwrap(), link(&view()).unwrap());
    assert_eq!(a.reached, b.reached);
    assert_eq!(format!("{:?}", a.module), format!("{:?}", b.module));
}

#[test]
fn sampling_falls_back_to_the_cosine_and_says_so_once() {
    let sample =
        "fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f { return vec3f(0.0, 0.0, 1.0); }\n";
    let pdf = "fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32 { return 1.0; }\n";
    for (source, missing) in [
        (EVAL.to_owned(), Some("neither `sample` nor `pdf`")),
        (format!("{EVAL}{sample}"), Some("`sample` but no `pdf`")),
        (format!("{EVAL}{pdf}"), Some("`pdf` but no `sample`")),
        (format!("{EVAL}{sample}{pdf}"), None),
    ] {
        let program =
            link(&film(from_text("half", BRDF, &source), integrator("brdf-is", &[]))).unwrap();
        match missing {
            Some(missing) => {
                assert_eq!(program.sampling, Sampling::Cosine);
                assert_eq!(program.notes, [format!("half has {missing}: sampled by the cosine")]);
                assert!(program.reached.text.contains("fn cosine_sample"));
            }
            None => {
                assert_eq!((program.sampling, program.notes.len()), (Sampling::Own, 0));
                assert!(program.reached.left_out.contains(&"cosine_sample".to_owned()));
            }
        }
    }
}

#[test]
fn the_program_binds_what_it_reaches_and_no_more() {
    let names = |view: &View| -> Vec<String> {
        link(view).unwrap().bindings.iter().map(|b| format!("{:?} {}", b.kind, b.name)).collect()
    };
    let with_light = film(brdf("ggx", &[]), integrator("uniform", &[]));
    assert_eq!(
        names(&with_light),
        [
            "Uniform brdf_params",
            "Uniform environment",
            "Texture env_map",
            "Read hits",
            "Uniform work",
            "ReadWrite sums"
        ]
    );
    // Tables where they are read, and not where a switch leaves them out.
    for (switch, bound) in [("compensated=true", true), ("compensated=false", false)] {
        let brdf = brdf("ggx-multiscatter", &[switch]);
        assert_eq!(link(&View::Eval { brdf }).unwrap().binds("brdf_tables"), bound);
    }
    // Neither a parameter nor the environment is reached here.
    let dark = from_text(
        "dark",
        INTEGRATOR,
        "fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f { return brdf_cos(hit.wo, hit.wo); }",
    );
    assert_eq!(
        names(&film(from_text("plain", BRDF, EVAL), dark)),
        ["Read hits", "Uniform work", "ReadWrite sums"]
    );
}

#[test]
fn branches_on_choices_are_decided_by_the_linker() {
    let source = "fn a() -> f32 { return 1.0; }\nfn b() -> f32 { return 2.0; }\nfn c() -> f32 { return 3.0; }\n\
        fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n\
            var x = 0.0;\n\
            switch MODE { case MODE_ONE: { x = a(); } case MODE_TWO: { x = b(); } default: { x = 0.5; } }\n\
            if EXTRA { x += c(); }\n\
            return vec3f(x);\n\
        }";
    let manifest = format!(
        "{BRDF}\n[params.mode]\ntype = \"choice\"\ndefault = \"one\"\noptions = [\"one\", \"two\"]\nabout = \"M.\"\n\
         \n[params.extra]\ntype = \"bool\"\ndefault = false\nabout = \"E.\"\n"
    );
    let functions = |set: &[&str]| -> Vec<String> {
        let mut configured = from_text("modes", &manifest, source);
        let manifest = configured.plugin.manifest.clone();
        set.iter().for_each(|s| configured.values.set_text(&manifest, s).unwrap());
        let program = link(&View::Eval { brdf: configured }).unwrap();
        let names = program.module.functions.iter().filter_map(|(_, f)| f.name.clone());
        let own = names.filter_map(|name| name.strip_prefix("brdf_modes__").map(str::to_owned));
        own.filter(|name| name.len() == 1).collect()
    };
    assert_eq!(functions(&[]), ["a"]);
    assert_eq!(functions(&["mode=two"]), ["b"]);
    assert_eq!(functions(&["mode=two", "extra=true"]), ["b", "c"]);
}

#[test]
fn expanded_text_is_a_program_of_its_own() {
    for (b, i) in [("ggx", "uniform"), ("modified-phong", "brdf-is")] {
        let program = link(&film(brdf(b, &[]), integrator(i, &[]))).unwrap();
        let module = naga::front::wgsl::parse_str(&program.reached.text).unwrap();
        naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::empty(),
        )
        .validate(&module)
        .unwrap();
    }
}

#[test]
fn every_loop_of_a_plugin_is_bounded() {
    let source = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n\
        var x = 0.0;\n    loop { loop { x += 1.0; } }\n    return vec3f(x);\n}";
    let program = link(&View::Eval { brdf: from_text("endless", BRDF, source) }).unwrap();
    // One load of the counter for each loop; without loops there is none.
    let loads = |program: &brdf_host::link::Program| {
        let eval = program
            .module
            .functions
            .iter()
            .find(|(_, f)| f.name.as_deref().is_some_and(|name| name.ends_with("__eval")));
        let (_, eval) = eval.unwrap();
        let global = |e: naga::Handle<naga::Expression>| {
            matches!(eval.expressions[e], naga::Expression::GlobalVariable(_))
        };
        eval.expressions
            .iter()
            .filter(|(_, e)| matches!(e, naga::Expression::Load { pointer } if global(*pointer)))
            .count()
    };
    assert_eq!(loads(&program), 2);
    assert_eq!(loads(&link(&View::Eval { brdf: from_text("plain", BRDF, EVAL) }).unwrap()), 0);
}

#[test]
fn long_and_deep_text_is_linked_or_refused_but_never_overflows() {
    let chain = |n: usize| {
        let terms = vec!["wo.z"; n].join(" + ");
        format!("fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{ return vec3f({terms}); }}")
    };
    let parentheses = |n: usize| {
        let (open, close) = ("(".repeat(n), ")".repeat(n));
        format!(
            "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{ return vec3f({open}wo.z{close}); }}"
        )
    };
    link(&View::Eval { brdf: from_text("chain", BRDF, &chain(7000)) }).unwrap();
    let refused = link(&View::Eval { brdf: from_text("chain", BRDF, &chain(10_000)) }).unwrap_err();
    assert!(refused.reason.contains("tokens"), "{refused}");
    // Whether naga takes it or refuses it is naga's business; it must come back.
    let _ = link(&View::Eval { brdf: from_text("deep", BRDF, &parentheses(14_000)) });
}

#[test]
fn reserved_words_are_those_of_the_shader_compiler() {
    let mut ours = brdf_sdk::reserved::RESERVED_WORDS.to_vec();
    let mut theirs = naga::keywords::wgsl::RESERVED.to_vec();
    ours.sort_unstable();
    theirs.sort_unstable();
    assert_eq!(ours, theirs);
}
