//! What is refused, with its place; and what stays as it was written.

use crate::common::{file, translated};
use glsl_brdf::{Source, Use, read_preset, translate};

/// The refusal of a file.
#[track_caller]
fn refused(text: &str, expected: &str) {
    assert_eq!(translated(text).unwrap_err(), expected);
}

/// The refusal of a body, whose first line is line 7.
#[track_caller]
fn refused_body(body: &str, expected: &str) {
    let text =
        file("", &format!("vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {{\n{body}\n}}"));
    assert_eq!(translated(&text).unwrap_err(), expected);
}

const REST: &str = "::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return vec3(1); }\n::end shader\n";

#[test]
fn files_that_break_the_grammar_are_told_by_line() {
    refused(
        "",
        "t.brdf:1:1: the file does not begin with its kind; write `analytic` into the first line",
    );
    refused(
        "hello\n",
        "t.brdf:1:1: `hello` is no kind of file that is read here; a model begins with `analytic`, a file of values with `bparam`",
    );
    refused(
        "analytic\n::begin parameters\n::begin shader\n",
        "t.brdf:3:1: a section begins inside of the section `parameters`; write `::end parameters` before it",
    );
    refused(
        "analytic\n::begin notes\n",
        "t.brdf:2:1: there is no section `notes`; name it parameters, shader or isFunc, or remove it",
    );
    refused(
        "analytic\n::begin parameters\n::end shader\n",
        "t.brdf:3:1: this ends `shader`, and the open section is `parameters`; write `::end parameters`",
    );
    refused(
        "analytic\n::end shader\n",
        "t.brdf:2:1: this ends a section where none is open; remove it, or write the `::begin` that is missing",
    );
    refused(
        "analytic\n::begin shader\nfloat x;\n",
        "t.brdf:2:1: the section `shader` never ends; write `::end shader`",
    );
    refused(
        "analytic\nhello\n",
        "t.brdf:2:1: this line stands in no section; put it between `::begin` and `::end`, or begin it with `#`",
    );
    refused(
        "analytic\n# nothing\n",
        "t.brdf:1:1: the file has no `::begin shader`; write `vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)` between `::begin shader` and `::end shader`",
    );
    let parameters =
        |line: &str| format!("analytic\n::begin parameters\n{line}\n::end parameters\n{REST}");
    refused(
        &parameters("vec2 x 0 1"),
        "t.brdf:3:1: there is no parameter type `vec2`; write float, bool or color",
    );
    refused(
        &parameters("float x 0 1"),
        "t.brdf:3:1: a float has a name and 3 numbers, and this one has fewer; write `float NAME MIN MAX DEFAULT`",
    );
    refused(
        &parameters("float x 0 one 1"),
        "t.brdf:3:11: `one` is no number; write `float NAME MIN MAX DEFAULT`",
    );
    refused(
        &parameters("float x 1 0 1"),
        "t.brdf:3:9: the least value lies above the greatest; exchange them",
    );
    refused(
        &parameters("bool 2x 0"),
        "t.brdf:3:6: `2x` cannot be a name in GLSL; use letters, digits and `_`, not beginning with a digit",
    );
    refused(
        &parameters("color c 1 0 nan"),
        "t.brdf:3:13: `nan` is no number; write `color NAME R G B`",
    );
    refused(
        &parameters("float x 0 1 1\nfloat x 0 1 1"),
        "t.brdf:4:7: the parameter `x` stands twice; remove one",
    );
}

#[test]
fn code_that_is_no_glsl_is_told_by_line_and_column() {
    refused(
        "analytic\n::begin shader\nfloat f() { return 1.; }\n::end shader\n",
        "t.brdf: its shader has no function `BRDF`; write `vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)`",
    );
    refused(
        "analytic\n::begin shader\nfloat BRDF(vec3 L) { return 1.; }\n::end shader\n",
        "t.brdf: its function `BRDF` takes and gives something else; write `vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)`",
    );
    refused_body("float x = 1.0", "t.brdf:8:1: `;` is missing before `}`; write `;`");
    refused_body(
        "return vec3(a);",
        "t.brdf:7:13: there is nothing of the name `a` here; declare it, or write it into the parameters",
    );
    refused_body(
        "return vec3(BRDF);",
        "t.brdf:7:13: there is nothing of the name `BRDF` here; `BRDF` is a function: call it",
    );
    refused_body(
        "return vec3(foo(1.));",
        "t.brdf:7:13: there is no function foo(float); declare it, or mend its name",
    );
    refused_body(
        "return texture2D(t, L.xy).rgb;",
        "t.brdf:7:18: there is nothing of the name `t` here; declare it, or write it into the parameters",
    );
    refused_body(
        "return dFdx(L);",
        "t.brdf:7:8: there is no function dFdx(vec3); a BRDF knows of no neighbouring pixel",
    );
    refused_body(
        "float x = L;",
        "t.brdf:7:11: a float does not begin with a vec3; convert the value",
    );
    refused_body(
        "return L + vec2(1);",
        "t.brdf:7:8: `+` has no meaning between vec3 and vec2; convert one of them",
    );
    refused_body(
        "return L.xyq;",
        "t.brdf:7:8: a vec3 has no `.xyq`; name components by xyzw, rgba or stpq",
    );
    refused_body(
        "if (L.z) return L;",
        "t.brdf:7:5: a condition is a bool, and this is a float; compare it with something",
    );
    refused_body(
        "const float k = 1.; k = 2.;",
        "t.brdf:7:21: `k` is const and cannot change; copy it into a variable first",
    );
    refused_body(
        "float k = 1.; return vec3(k + k++);",
        "t.brdf:7:31: `k` changes in the midst of an expression that also reads it; change it in a statement of its own",
    );
    refused_body(
        "discard;",
        "t.brdf:7:1: a BRDF has no pixel to discard; return vec3(0.0) instead",
    );
    refused_body(
        "double d = 1.0;",
        "t.brdf:7:1: a BRDF has no `double`; write float: there are no doubles here",
    );
    refused_body("return L @ V;", "t.brdf:7:10: GLSL has no `@`; remove it");
    refused_body("/* for ever", "t.brdf:7:1: this comment never ends; close it with */");
    refused_body(
        "return vec3(1e60);",
        "t.brdf:7:13: `1e60` is larger than a float; write at most 3.4e38",
    );
    refused_body(
        "switch (1) { case 0: L; case 1: break; } return L;",
        "t.brdf:7:14: this case goes on with the next one; end it with `break`, and write what both do into a function",
    );
    refused_body(
        "float a[2] = float[2](1., 2.); return vec3(a[1.0]);",
        "t.brdf:7:44: an index is a whole number, and this is a float; write int(...)",
    );
    let code = |code: &str| file("float rough 0 1 1", code);
    refused(
        &code("uniform float x;"),
        "t.brdf:6:1: a BRDF has no `uniform`; write it as a parameter: `float NAME MIN MAX DEFAULT` between `::begin parameters` and `::end parameters`",
    );
    refused(
        &code("float f() { return 1.; }\nfloat f() { return 2.; }"),
        "t.brdf:7:7: the function `f` stands twice; remove one",
    );
    refused(
        &code("void f() { rough = 1.0; }"),
        "t.brdf:6:12: `rough` is a parameter and cannot change; copy it into a variable first",
    );
    refused(
        &code("vec5 x;"),
        "t.brdf:6:1: there is no type `vec5`; write float, vec3 or another type of GLSL, or declare the struct before",
    );
    refused(
        &code("#define A(x) x ## 1"),
        "t.brdf:6:16: tokens are not joined here; write the macro out",
    );
    refused(
        &code("#defines A 1"),
        "t.brdf:6:2: there is no preprocessor line `#defines`; a comment has a blank behind its `#`",
    );
    refused(&code("#if 1"), "t.brdf:6:1: this condition never ends; write `#endif`");
    refused(
        &code("#endif"),
        "t.brdf:6:1: there is no `#if` before it; remove it, or write the `#if`",
    );
    refused(&code("#error not yet"), "t.brdf:6:1: the code says: not yet; mend what it names");
}

#[test]
fn deep_and_endless_code_is_refused_and_not_followed() {
    let brackets = format!("return L * {}1.0{};", "(".repeat(5000), ")".repeat(5000));
    let told = translated(&file(
        "",
        &format!("vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {{ {brackets} }}"),
    ))
    .unwrap_err();
    assert!(
        told.ends_with("the code is nested more than 200 deep; give parts of it names"),
        "{told}"
    );
    let mut macros = "#define M0 1.0 +\n".to_owned();
    for n in 1..40 {
        macros += &format!("#define M{n} M{} M{}\n", n - 1, n - 1);
    }
    let told = translated(&file("", &format!("{macros}float x = M39 1.0;"))).unwrap_err();
    assert!(
        told.ends_with("macros make more code than fits; write less of it by macros"),
        "{told}"
    );
    assert!(translated(&file("", "#define A A\nfloat x = A;")).is_err());
}

#[test]
fn lines_and_comments_stay_where_they_were() {
    let text = "analytic\n# of the file\n::begin parameters\nfloat rough 0 1 .5   how rough\n::end parameters\n::begin shader\n// about f\nfloat f(float x) // behind\n{\n    /* in\n       two lines */\n    float y = x * 2. +\n        1.; // the last\n    if (y > 1.) y = 1.; else y = 0.;\n    return y;\n}\n\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)\n{\n    return vec3(f(L.z) * rough);\n}\n::end shader\n";
    let model = translated(text).unwrap();
    let lines: Vec<&str> = model.wgsl.lines().collect();
    let source: Vec<&str> = text.lines().collect();
    for (needle, found) in [
        ("# of the file", "// of the file"),
        ("// about f", "// about f"),
        ("float f(float x) // behind", "fn f(x: f32) -> f32 { // behind"),
        ("    /* in", "    /* in"),
        ("       two lines */", "       two lines */"),
        ("    float y = x * 2. +", "    var y = x * 2.0 +"),
        ("        1.; // the last", "        1.0; // the last"),
        ("    if (y > 1.) y = 1.; else y = 0.;", "    if y > 1.0 { y = 1.0; } else { y = 0.0; }"),
        ("    return y;", "    return y;"),
        ("    return vec3(f(L.z) * rough);", "    return vec3f(f(L.z) * p.rough);"),
    ] {
        let line = source.iter().position(|line| *line == needle).unwrap();
        assert_eq!(lines[line], found, "{}", model.wgsl);
    }
    assert!(model.manifest.contains("about = \"how rough\""), "{}", model.manifest);
}

#[test]
fn files_of_values_are_read() {
    let read = |text: &str| read_preset(Source { file: "v.bparam", text }).map_err(|p| p.line());
    let preset = read("bparam some folder/my model.brdf\n\n::begin parameters\nfloat rough 0 1 2.5\nbool on 1\ncolor c 1 .5 0\n::end parameters\n").unwrap();
    assert_eq!(preset.model, "some folder/my model.brdf");
    let model = file(
        "float rough 0 1 .5\nbool on 0\ncolor c 1 1 1",
        "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return c; }",
    );
    let source = Source { file: "t.brdf", text: &model };
    let manifest = |using| translate(source, "t", Some(using)).unwrap().manifest;
    let own = manifest(Use::Preset(&preset, "My Values"));
    assert!(own.contains("default = 0.5\nrange = [0.0, 2.5]\n"), "{own}");
    let set = "[presets.my_values]\nabout = \"From the file v.bparam.\"\nset = { rough = 2.5, on = true, c = [1.0, 0.5, 0.0] }\n";
    assert!(own.contains(set), "{own}");
    let given = manifest(Use::Defaults(&preset));
    for line in ["default = 2.5\nrange = [0.0, 2.5]", "default = true", "default = [1.0, 0.5, 0.0]"]
    {
        assert!(given.contains(line), "{given}");
    }
    assert_eq!(
        read("bparam\n").unwrap_err(),
        "v.bparam:1:1: a file of values begins with `bparam` and the name of a model's file; write `bparam model.brdf`"
    );
}

#[test]
fn changes_that_the_rest_would_see_are_refused() {
    let seen = "changes in the midst of an expression that also reads it";
    let several = "several parts of one expression change something";
    let functions = "int seed = 0; float rnd(inout int s) { s++; return float(s); }\nint n = 0; float count() { return float(++n); }\n\
                     float f(inout float x) { x = 10.; return 20.; }\nint idx() { return n++; }\n";
    for (body, told) in [
        ("return vec3(rnd(seed), rnd(seed), 1);", seen),
        ("vec2 v = vec2(1); return vec3(f(v.x) + v.x);", seen),
        ("float x = 1.; if (x + (x = 3.) > 5.) return L; return V;", seen),
        ("int i = 2; if (i + i++ > 4) return L; return V;", seen),
        ("int i = 2; switch (i * i++) { default: return L; } return V;", seen),
        ("int i = 2; while (i + i++ < 4) { } return V;", seen),
        ("float x = count() + (L.z > 0. ? count() : 0.) * 10.; return vec3(x);", several),
        ("float x = float(n) + (L.z > 0. ? count() : 0.) * 10.; return vec3(x);", several),
        ("float r; float x = count() + (r = count()) * 10.; return vec3(x);", several),
        (
            "int t[2]; t[idx()] += 2; return vec3(t[0]);",
            "a place that changes while it is looked for cannot be translated",
        ),
        (
            "vec3 t[2]; t[idx()].xy = vec2(1, 2); return t[0];",
            "a place that changes while it is looked for cannot be translated",
        ),
        (
            "vec2 v; bool h = L.z > 0. && f(v.x) > 1.; return vec3(v, 1);",
            "an argument that is handed back behind `&&` or `||` cannot be translated",
        ),
        (
            "vec4 v; v.wzyx.xy = vec2(1); return v.xyz;",
            "a component of several components as a place cannot be translated",
        ),
        ("return vec3(1.0 / 0.0);", "this divides by a zero that is written there"),
    ] {
        let code =
            format!("{functions}vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {{ {body} }}");
        let line = translated(&file("", &code)).unwrap_err();
        assert!(line.contains(told), "{body}: {line}");
    }
}

#[test]
fn what_would_run_for_ever_or_too_deep_is_refused() {
    let body = |code: &str| {
        file("", &format!("vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {{ {code} }}"))
    };
    let mut empty = "#define A0\n".to_owned();
    for n in 1..40 {
        empty += &format!("#define A{n} A{0} A{0}\n", n - 1);
    }
    let nested = |n: usize, open: &str| format!("{}1.{}", open.repeat(n), ")".repeat(n));
    for (text, told) in [
        (body(&format!("return L * ({}1.);", "1.+".repeat(20_000))), "operators follow each other"),
        (body(&format!("return L{};", ".xyz".repeat(100_000))), "operators follow each other"),
        (
            file("", &format!("#if {}1\n#endif\n", "(".repeat(200_000))),
            "this condition cannot be read",
        ),
        (
            file("", &format!("#if {}1\n#endif\n", "!".repeat(400_000))),
            "this condition cannot be read",
        ),
        (file("", &format!("{empty}A39\n")), "macros take more steps than anybody waits for"),
        (
            file("", &format!("#define F(x) x\nfloat x = {};", nested(20_000, "F("))),
            "macros take more steps than anybody waits for",
        ),
        (
            file(
                "",
                &format!(
                    "float f(inout float s, float x) {{ return x; }}\nfloat f(inout int s, float x) {{ return x; }}\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {{ float s; return vec3({}); }}",
                    nested(60, "f(s, ")
                ),
            ),
            "cannot be translated",
        ),
    ] {
        let line = translated(&text).unwrap_err();
        assert!(line.contains(told), "{}", &line[..line.len().min(300)]);
    }
    let deep = "float f(inout float s, float x) { return x; }\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { float s; return vec3(";
    assert!(translated(&file("", &format!("{deep}{}); }}", nested(60, "f(s, ")))).is_ok());
}
