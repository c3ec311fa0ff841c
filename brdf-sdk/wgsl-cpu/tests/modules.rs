//! Modules as they may come: what is not covered is refused at its place, and nothing panics.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

mod common;

use common::generate::{Tape, program};
use common::{binding, lower};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use wgsl_cpu::{Failure, Precision, Program, Refusal, Resource, Run, Storage};

fn validated(text: &str) -> Option<(naga::Module, ModuleInfo)> {
    let module = naga::front::wgsl::parse_str(text).ok()?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
    let info = validator.validate(&module).ok()?;
    Some((module, info))
}

fn refusal(text: &str) -> Refusal {
    let Some((module, info)) = validated(text) else { panic!("naga refuses\n{text}") };
    let Err(refusal) = Program::new(&module, &info) else { panic!("this is covered:\n{text}") };
    refusal
}

/// Asserts that the construct between the brackets `«` and `»` is refused, at its own place.
fn refused_at(text: &str) {
    let first = text.find('«').unwrap();
    let plain = text.replacen('«', "", 1);
    let end = plain.find('»').unwrap();
    let plain = plain.replacen('»', "", 1);
    let refusal = refusal(&plain);
    let range = refusal.span.to_range().unwrap_or_else(|| panic!("{refusal}, of\n{plain}"));
    let inside = first <= range.start && range.end <= end && !range.is_empty();
    let here = &plain[range.clone()];
    assert!(inside, "{refusal} at `{here}`, not at `{}`", &plain[first..end]);
}

/// A kernel with some declarations around `body`.
fn kernel(declarations: &str, body: &str) -> String {
    format!(
        "enable f16;
         @group(0) @binding(0) var<storage, read_write> output: array<u32>;
         {declarations}
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             var x = f32(id.x);
             {body}
             output[id.x] = u32(x);
         }}"
    )
}

#[test]
fn what_is_not_covered_is_refused_at_its_place() {
    let texture =
        "@group(0) @binding(1) var t: texture_2d<f32>; @group(0) @binding(2) var s: sampler;";
    for (declarations, body) in [
        ("var<workgroup> w: u32;", "«w = 3u;»"),
        ("var<workgroup> w: u32;", "output[0] = «w»;"),
        ("var<workgroup> w: array<atomic<u32>, 4>;", "«atomicAdd(&w[1], 1u);»"),
        ("", "«workgroupBarrier();»"),
        ("", "«storageBarrier();»"),
        ("var<workgroup> w: u32;", "output[0] = «workgroupUniformLoad(&w)»;"),
        (texture, "x = «textureSampleLevel(t, s, vec2f(x), 0.0)».x;"),
        (texture, "x = «textureGather(0, t, s, vec2f(x))».x;"),
        (
            "@group(0) @binding(1) var t: texture_storage_2d<r32float, write>;",
            "«textureStore(t, vec2u(0u), vec4f(x));»",
        ),
        ("@group(0) @binding(1) var t: texture_3d<f32>;", "x = «textureLoad(t, vec3u(0u), 0)».x;"),
        (
            "@group(0) @binding(1) var t: texture_2d<i32>;",
            "output[0] = u32(«textureLoad(t, vec2u(0u), 0)».x);",
        ),
        (
            "@group(0) @binding(1) var<storage, read_write> a: atomic<u32>;",
            "«let old = atomicCompareExchangeWeak(&a, 1u, 2u).old_value;»",
        ),
        ("", "x += f32(«f16(x)»);"),
        ("", "«var h: f16;» x += f32(h);"),
        ("«var<private> h: f16;»", "x += f32(h);"),
        ("", "x += f32(«1.5lf * f64(x)»);"),
        ("override gain: f32;", "x *= «gain»;"),
        ("", "«var big: array<u32, 100000>;» output[0] = big[id.x];"),
        ("", "x += f32(«subgroupAdd(1u)»);"),
        ("", "x += f32(«subgroupBallot(true)».x);"),
    ] {
        refused_at(&kernel(declarations, body));
    }
    let vertex = "@vertex fn main() -> @builtin(position) vec4f { return vec4f(); }";
    let fragment = "@fragment fn main(@location(0) x: f32) { if x < 0.5 { discard; } }";
    let two = "@compute @workgroup_size(1) fn a() {} @compute @workgroup_size(1) fn b() {}";
    for text in [vertex, fragment, two, "fn f() {}"] {
        refusal(text);
    }
}

#[test]
fn deep_nesting_neither_fails_nor_overflows() {
    let many =
        |count: usize, line: &dyn Fn(usize) -> String| -> String { (0..count).map(line).collect() };
    let chain = many(500, &|i| format!("if id.x == {i}u {{ x = {i}.0; }} else "));
    let calls = |count| {
        let functions = many(count, &|i| {
            format!("fn step{}(x: f32) -> f32 {{ return step{i}(x) + 1.0; }}\n", i + 1)
        });
        kernel(
            &format!("fn step0(x: f32) -> f32 {{ return x; }}\n{functions}"),
            &format!("x = step{count}(x);"),
        )
    };
    let early =
        many(400, &|i| format!("if id.x == {}u {{ output[id.x] = {i}u; return; }}\n", i * 3));
    let sum = format!("x = x{};", many(400, &|i| format!(" + {i}.0")));
    let loops = many(20, &|i| {
        format!("for (var i{i} = 0u; i{i} < 1u; i{i}++) {{ if id.x == {i}u {{ break; }}\n")
    });
    let texts = [
        kernel("", &format!("{chain} {{ x = 7.0; }}")),
        calls(300),
        kernel("", &early),
        kernel("", &sum),
        kernel("", &format!("{loops} x += 1.0; {}", "}".repeat(20))),
        kernel("", &format!("{}x += 1.0;{}", "{".repeat(100), "}".repeat(100))),
    ];
    let wanted: [fn(u32) -> u32; 6] = [
        |i| if i < 500 { i } else { 7 },
        |i| i + 300,
        |i| if i % 3 == 0 && i < 1200 { i / 3 } else { i },
        |i| i + 79_800,
        |i| if i < 20 { i } else { i + 1 },
        |i| i + 1,
    ];
    for (text, wanted) in texts.iter().zip(wanted) {
        let (module, info) = on_large_stack(|| validated(text)).expect("naga takes it");
        let program = Program::new(&module, &info).unwrap();
        let storage = Storage::new(640, false);
        let resources = [(binding(0), Resource::Storage(&storage))];
        let run = Run {
            resources: &resources,
            groups: [10, 1, 1],
            fuel: 1 << 30,
            set: None,
            lanes: None,
        };
        program.run(Precision::F32, &run).unwrap();
        for index in 0..640 {
            assert_eq!(storage.word(index as usize), Some(wanted(index)), "invocation {index}");
        }
    }
    // Deeper than anybody writes: naga or the lowering may refuse it.
    for count in [1000, 3000] {
        let text = calls(count);
        if let Some((module, info)) = on_large_stack(|| validated(&text)) {
            let _ = Program::new(&module, &info);
        }
    }
}

/// naga's parser and validator recurse too.
fn on_large_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let builder = std::thread::Builder::new().stack_size(256 << 20);
        builder.spawn_scoped(scope, work).unwrap().join().unwrap()
    })
}

#[test]
fn what_is_missing_is_named() {
    let program = lower(
        "@group(0) @binding(3) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(1) fn main() { output[0] = 1u; }",
    )
    .unwrap();
    let run = Run { resources: &[], groups: [1, 1, 1], fuel: 100, set: None, lanes: None };
    assert_eq!(program.run(Precision::F32, &run), Err(Failure::Missing(binding(3))));
}

/// Much of the language on three pages.
const SOURCE: &str = "struct Item { key: u32, at: vec3f, m: mat3x2f, list: array<i32, 4> }
struct Block { count: u32, items: array<Item> }
@group(0) @binding(0) var<storage, read> input: array<u32>;
@group(0) @binding(1) var<storage, read_write> output: array<u32>;
@group(0) @binding(2) var<storage, read_write> block: Block;
@group(0) @binding(3) var<storage, read_write> counters: array<atomic<i32>, 3>;
@group(0) @binding(4) var image: texture_2d<f32>;
const TABLE = array<f32, 6>(0.5, 1.5, -2.0, 3.25, 1e20, 0.0);
var<private> seed: u32 = 7u;
fn next() -> u32 { seed = seed * 1664525u + 1013904223u; return seed >> 8u; }
fn turn(v: vec3f, by: f32) -> vec3f {
    let m = mat3x3f(vec3f(cos(by), sin(by), 0.0), vec3f(-sin(by), cos(by), 0.0), vec3f(0.0, 0.0, 1.0));
    return normalize(m * v) + reflect(v, vec3f(0.0, 1.0, 0.0)) * determinant(m);
}
fn fill(item: ptr<function, Item>, index: i32) -> bool {
    if index < 0 { return false; }
    (*item).list[index] = index * 2;
    (*item).at[u32(index) % 3u] += TABLE[index];
    (*item).m[index][1] = pow(2.0, f32(index));
    return (*item).list[index] > 3 && (*item).at.x < 5.0;
}
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    var item: Item;
    var sum = vec4f(0.0);
    for (var i = 0; i < 9; i++) {
        if !fill(&item, i - 2 + i32(id.x % 3u)) { continue; }
        sum += textureLoad(image, vec2i(i, i32(id.x)), 0);
        sum.x = smoothstep(0.0, 4.0, length(turn(item.at, sum.y)));
        if any(sum.xyz > vec3f(100.0)) { break; }
    }
    block.items[id.x] = item;
    block.items[id.x % 5u].key = arrayLength(&block.items) + textureDimensions(image).x;
    let before = atomicAdd(&counters[id.x], i32(next() % 10u)) + atomicMax(&counters[1], -3);
    switch before % 4 {
        case 0, 1: { output[id.x] = pack4x8unorm(sum); }
        case 2: { output[local] = input[id.x * 3u] / input[id.x]; }
        default: { output[id.x] ^= extractBits(bitcast<u32>(sum.w), 3u, 20u); }
    }
    while next() % 5u != 0u { output[seed % 8u] += 1u; }
}
";

/// Cuts a text into words, numbers, blanks and single characters.
fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    let kind = |c: char| if c.is_alphanumeric() || c == '_' || c == '.' { 1 } else { 0 };
    while let Some(first) = rest.chars().next() {
        let same = |c: char| kind(first) == 1 && kind(c) == 1;
        let end =
            rest.char_indices().skip(1).find(|(_, c)| !same(*c)).map_or(rest.len(), |(at, _)| at);
        tokens.push(&rest[..end]);
        rest = &rest[end..];
    }
    tokens
}

/// Changes one to three things.
fn mutated(text: &str, random: &mut impl FnMut(usize) -> usize) -> String {
    const NUMBERS: [&str; 14] = [
        "0",
        "1",
        "2u",
        "0u",
        "1u",
        "31u",
        "32u",
        "4294967295u",
        "-1",
        "3i",
        "65536u",
        "1e30",
        "0.0",
        "100000",
    ];
    const WORDS: [&str; 12] = [
        "u32", "i32", "f32", "bool", "vec3f", "vec2f", "continue", "break", "return", "min", "dot",
        "abs",
    ];
    const SIGNS: [&str; 16] =
        ["+", "-", "*", "/", "%", "<", ">", "&", "|", "^", "!", "~", "(", ")", ";", ","];
    let mut all: Vec<String> = tokens(text).into_iter().map(str::to_owned).collect();
    for _ in 0..1 + random(3) {
        let at = random(all.len());
        let token = all[at].clone();
        let semicolons: Vec<usize> = (0..all.len()).filter(|i| all[*i] == ";").collect();
        match random(6) {
            0 if semicolons.len() > 2 => {
                let one = random(semicolons.len() - 1);
                let statement = semicolons[one] + 1..semicolons[one + 1] + 1;
                if random(2) == 0 {
                    all.drain(statement);
                } else {
                    let copy: Vec<String> = all[statement.clone()].to_vec();
                    let to = semicolons[random(semicolons.len())] + 1;
                    all.splice(to..to, copy);
                }
            }
            _ if token.starts_with(|c: char| c.is_ascii_digit()) => {
                all[at] = NUMBERS[random(NUMBERS.len())].to_owned();
            }
            _ if token.starts_with(char::is_alphabetic) => {
                let words: Vec<&String> =
                    all.iter().filter(|t| t.starts_with(char::is_alphabetic)).collect();
                let other = words[random(words.len())].clone();
                all[at] =
                    if random(3) == 0 { WORDS[random(WORDS.len())].to_owned() } else { other };
            }
            _ if SIGNS.contains(&token.as_str()) => {
                all[at] = SIGNS[random(SIGNS.len())].to_owned();
            }
            _ => {}
        }
    }
    all.concat()
}

/// Runs a program on buffers of a few words or none.
fn run_small(program: &Program, size: usize, precision: Precision) -> Result<(), Failure> {
    let storages: Vec<Storage> = (0..4).map(|_| Storage::new(size, size % 2 == 1)).collect();
    let words: Vec<u32> = (0..size as u32).map(|i| i.wrapping_mul(2_654_435_761)).collect();
    let texels = vec![[0.5; 4]; size];
    let mut resources = vec![
        (binding(0), Resource::Words(&words)),
        (binding(1), Resource::Storage(&storages[1])),
        (binding(2), Resource::Storage(&storages[2])),
        (binding(3), Resource::Storage(&storages[3])),
        (binding(4), Resource::Texture { size: [size as u32, 1], texels: &texels }),
    ];
    if size == 2 {
        resources.remove(0);
    }
    let run =
        Run { resources: &resources, groups: [1, 1, 1], fuel: 100_000, set: None, lanes: None };
    program.run(precision, &run)
}

#[test]
fn mutants_run_or_are_refused_or_stopped() {
    let mut state = 1u64;
    let mut random = |count: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    let mut sources = vec![SOURCE.to_owned()];
    for _ in 0..20 {
        let numbers: Vec<u16> = (0..300).map(|_| random(65536) as u16).collect();
        sources.push(program(&mut Tape::new(&numbers)).text());
    }
    let [mut ran, mut refused, mut stopped] = [0; 3];
    for round in 0..22_000 {
        let source = if random(2) == 0 { &sources[0] } else { &sources[random(sources.len())] };
        // A workgroup's size decides how much there is to do: it stays.
        let marker = "@workgroup_size(64)";
        let (head, tail) = source.split_once(marker).unwrap();
        let text = format!("{}{marker}{}", mutated(head, &mut random), mutated(tail, &mut random));
        let text = if round == 0 { source.clone() } else { text };
        let Some((module, info)) = validated(&text) else { continue };
        let outcome = std::panic::catch_unwind(|| {
            let program = Program::new(&module, &info)?;
            let precision = [Precision::F32, Precision::F64][round % 2];
            Ok([0, 1, 2, 40].map(|size| run_small(&program, size, precision)))
        });
        match outcome {
            Err(_) => panic!("a panic in\n{text}"),
            Ok(Err(refusal)) => {
                let refusal: Refusal = refusal;
                assert!(!refusal.reason.is_empty());
                refused += 1;
            }
            Ok(Ok(results)) => {
                ran += 1;
                let stops = |result: &Result<_, _>| matches!(result, Err(Failure::Stopped(_)));
                stopped += usize::from(results.iter().any(stops));
            }
        }
    }
    assert!(ran > 1500 && stopped > 0, "{ran} ran, {refused} refused, {stopped} stopped");
}

/// Calls of nothing, doubled at each level: 2^40 of them, refused before long.
#[test]
fn calls_that_double_are_refused_though_they_do_nothing() {
    let mut text = "fn e0() {}\n".to_owned();
    for level in 1..=40 {
        text += &format!("fn e{level}() {{ e{0}(); e{0}(); }}\n", level - 1);
    }
    text += "@compute @workgroup_size(64) fn main() { e40(); }";
    assert!(refusal(&text).reason.contains("instructions, with all calls written out"));
}

/// Large values copied back and forth: the program is refused where it gets too large.
#[test]
fn a_function_that_grows_too_large_is_refused_at_its_own_place() {
    let copies = "b = a; a = b;\n".repeat(300);
    let text = format!(
        "fn grow() -> f32 {{ var a: array<f32, 4096>; var b: array<f32, 4096>;\n{copies} return b[0]; }}
         @group(0) @binding(1) var<storage, read_write> output: array<f32>;
         @compute @workgroup_size(64) fn main() {{ output[0] = grow(); }}"
    );
    let refusal = refusal(&text);
    assert!(refusal.reason.contains("instructions"), "{refusal}");
    let place = &text[refusal.span.to_range().unwrap()];
    assert!(["a", "b", "b = a", "a = b"].contains(&place), "{place}");
}

/// Resources of another kind than the program's are refused before anything runs, and more
/// invocations than can be counted are too.
#[test]
fn what_stands_behind_a_binding_must_be_of_its_kind() {
    let text = "@group(0) @binding(0) var<storage, read_write> output: array<u32>;
                @compute @workgroup_size(64)
                fn main(@builtin(global_invocation_id) id: vec3u) { output[id.x] = 1u; }";
    let program = lower(text).unwrap();
    let (words, storage) = ([0u32; 4], Storage::new(4, false));
    let texture = Resource::Texture { size: [2, 2], texels: &[[0.0; 4]; 4] };
    for wrong in [Resource::Words(&words), texture] {
        let resources = [(binding(0), wrong)];
        let run = Run { resources: &resources, groups: [1; 3], fuel: 1, set: None, lanes: None };
        assert_eq!(program.run(Precision::F32, &run), Err(Failure::Missing(binding(0))));
    }
    let resources = [(binding(0), Resource::Storage(&storage))];
    let groups = [1 << 30, 1, 1];
    let run = Run { resources: &resources, groups, fuel: 1, set: None, lanes: None };
    assert_eq!(program.run(Precision::F32, &run), Err(Failure::TooMany));
}
