//! The executors: how one is chosen, and one program with the same numbers on the cores, on the
//! adapter, and in f64.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::sync::Arc;

use brdf_host::environment::Environment;
use brdf_host::exec::cpu::Cpu;
use brdf_host::exec::gpu::{Gpu, Lists};
use brdf_host::exec::{Executor, Precision};
use brdf_host::link::{Form, View, link};
use brdf_host::plugin::Configured;
use brdf_host::registry::Registry;
use brdf_host::render::evaluate::{Pair, evaluate};
use brdf_host::render::{Film, estimate};
use brdf_sdk::Kind;
use common::program::{folder, refused, run, small, text};
use common::shot::{Shot, map, sphere};
use common::wide::Wide;
use common::{brdf, from_text, gpu, integrator, program, root};

/// Every integrator of the tree with BRDFs of one lobe, of two and without sampling, and every
/// BRDF of the tree by its own samples.
fn shipped() -> Vec<(Configured, Configured)> {
    const ALL_INTEGRATORS: [&str; 4] = ["lambert", "ggx", "minnaert", "modified-phong"];
    let registry = Registry::new(&[root().join("plugins")]);
    let names = |kind| registry.all(kind).into_iter().map(|found| found.id).collect::<Vec<_>>();
    let mut all = Vec::new();
    for b in names(Kind::Brdf) {
        for i in names(Kind::Integrator) {
            if i == "brdf-is" || ALL_INTEGRATORS.contains(&b.as_str()) {
                all.push((brdf(&b, &[]), integrator(&i, &[])));
            }
        }
    }
    assert!(all.len() >= 16 + 4 * 11);
    all
}

/// The share of pixels whose means differ by more than 1e-4 of them, and the largest difference
/// between the pictures' means: relative, and as a part of the mean's standard error.
fn difference(a: &Film, b: &Film) -> (f64, f64, f64) {
    let mut apart = 0;
    for (x, y) in a.means().zip(b.means()) {
        let differs = |c: usize| (x[c] - y[c]).abs() > 1e-4 * y[c].abs() + 1e-7;
        apart += usize::from((0..3).any(differs));
    }
    let share = apart as f64 / a.rows() as f64;
    let (a, b) = (estimate(a), estimate(b));
    let error = b.mean_std_error.unwrap_or_default();
    let off = |c: usize| (a.mean[c] - b.mean[c]).abs();
    let relative = (0..3).map(|c| off(c) / b.mean[c]).fold(0.0, f64::max);
    (share, relative, (0..3).map(|c| off(c) / error[c]).fold(0.0, f64::max))
}

/// Pictures of `one` and `other` agree: in the furnace, where no sample can fall to another texel, at
/// every pixel; under a map with structure everywhere but where rounding took a sample over an edge.
fn agree(one: &mut dyn Executor, other: &mut dyn Executor, what: &str) {
    let furnace = Arc::new(Environment::constant(1.0));
    let structure = map(32, 16, |x, y| [1.0 + x as f32, (y % 5) as f32, ((x * y) % 7) as f32]);
    for (b, i) in shipped() {
        let mut take = |map: &Arc<Environment>| {
            // A sum over texels takes thousands of evaluations where the others take 32 samples.
            let side = if i.plugin.id == "convolution" { 16 } else { 40 };
            let shot = Shot::new(sphere(side), Arc::clone(map), 16, 2);
            let on = |executor: &mut dyn Executor| shot.take(executor, &b, &i).unwrap();
            difference(&on(one), &on(other))
        };
        let names = format!("{what}: {} with {}", b.plugin.id, i.plugin.id);
        let (apart, means, _) = take(&furnace);
        assert!(apart == 0.0 && means < 1e-6, "{names} in the furnace: {apart}, {means:e}");
        // 32 samples a pixel, each within 1e-7 of an edge with a probability of some 1e-5. One of them
        // in 30,000 weighs 1/170 of the mean's standard error where it is one deviation off.
        let (apart, means, of_error) = take(&structure);
        assert!(
            apart < 0.02 && (means < 1e-4 || of_error < 0.1),
            "{names} under a map: {apart}, {means:e}, {of_error}"
        );
    }
}

#[test]
fn pictures_of_the_cores_and_of_the_adapter_agree() {
    let Some(mut gpu) = gpu() else { return };
    agree(&mut Cpu::new(Precision::F32), &mut gpu, "cores and adapter");
}

/// Lists of vec4f and vec4u lie in textures for software, in buffers for cards: the same numbers come from either.
#[test]
fn lists_are_the_same_in_textures_and_in_buffers() {
    if gpu().is_none() {
        return;
    }
    let open = |lists| Gpu::open_with(None, Some(lists)).unwrap();
    let (mut textures, mut buffers) = (open(Lists::Textures), open(Lists::Buffers));
    let structure = map(32, 16, |x, y| [1.0 + x as f32, (y % 5) as f32, ((x * y) % 7) as f32]);
    let mut with_lists = Vec::new();
    for (b, i) in shipped() {
        let view = View::Film { brdf: b.clone(), integrator: i.clone(), form: Form::default() };
        if i.plugin.id != "brdf-is" || link(&view).unwrap().lists().is_empty() {
            continue;
        }
        with_lists.push(b.plugin.id.clone());
        let shot = Shot::new(sphere(24), Arc::clone(&structure), 16, 2);
        let [one, other] = [&mut textures, &mut buffers].map(|gpu| shot.take(gpu, &b, &i).unwrap());
        assert!(one.means().eq(other.means()), "{}", b.plugin.id);
    }
    assert_eq!(with_lists, ["merl", "rgl"]);
}

/// More dispatches than are marked together, and less time on the device than passes outside.
#[test]
fn the_devices_own_clock_counts_dispatches() {
    assert_eq!(Cpu::new(Precision::F32).device_seconds(), None);
    let Some(mut gpu) = gpu() else { return };
    let Some(begin) = gpu.device_seconds() else {
        eprintln!("skipped: {} has no timestamps", gpu.name());
        return;
    };
    let shot = Shot::new(sphere(32), Arc::new(Environment::constant(1.0)), 64, 2);
    let (mut wall, mut counted) = (0.0, vec![begin]);
    for _ in 0..40 {
        let start = std::time::Instant::now();
        shot.take(&mut gpu, &brdf("lambert", &[]), &integrator("uniform", &[])).unwrap();
        wall += start.elapsed().as_secs_f64();
        counted.push(gpu.device_seconds().unwrap());
    }
    assert!(counted.windows(2).all(|pair| pair[0] < pair[1]), "{counted:?}");
    let device = counted[40] - begin;
    assert!(device < wall, "{device} s of {wall} s");

    // The same where nobody looks meanwhile.
    for _ in 0..40 {
        shot.take(&mut gpu, &brdf("lambert", &[]), &integrator("uniform", &[])).unwrap();
    }
    assert!(gpu.device_seconds().unwrap() > counted[40]);
}

#[test]
fn pictures_in_f32_and_in_f64_agree() {
    agree(&mut Cpu::new(Precision::F32), &mut Cpu::new(Precision::F64), "f32 and f64");
}

/// Where a device has more lanes than there are pixels, several invocations share a pixel's replicates.
#[test]
fn shared_replicates_give_the_same_bits() {
    let structure = map(32, 16, |x, y| [1.0 + x as f32, (y % 5) as f32, ((x * y) % 7) as f32]);
    for (b, i) in shipped() {
        if b.plugin.id != "ggx" || i.plugin.id == "convolution" {
            continue;
        }
        for replicates in [16, 5, 1] {
            let mut shot = Shot::new(sphere(24), Arc::clone(&structure), 50, 2);
            shot.effort.replicates = replicates;
            let alone = shot.take(&mut Cpu::new(Precision::F32), &b, &i).unwrap();
            let shared = shot.take(&mut Wide(Cpu::new(Precision::F32)), &b, &i).unwrap();
            assert!(alone == shared, "{} in {replicates} replicates", i.plugin.id);
        }
    }
}

/// Expressions of floats a, b, c with their tolerance: relative to the larger of the value and `floor`.
///
/// The tolerances are WGSL's stated accuracies (section 15.7.4), which an adapter may use up; the
/// executor on the cores is held to far tighter ones by its own tests.
const EXPRESSIONS: [(&str, f64, f64); 42] = [
    ("a + b * c", 1e-6, 1.0),
    ("a - b", 1e-6, 1.0),
    ("a / (b * b + 0.5)", 1e-6, 1e-3),
    ("a % (c * c + 0.25)", 1e-5, 1.0),
    ("abs(a) - sign(b)", 1e-6, 1.0),
    ("acos(clamp(a, -1.0, 1.0))", 4e-3, 1.0),
    ("asin(clamp(a, -1.0, 1.0))", 4e-3, 1.0),
    ("atan(a)", 5e-4, 1e-3),
    ("atan2(a, b)", 5e-4, 1e-3),
    ("ceil(a * 3.0) + floor(b * 3.0)", 0.0, 1.0),
    ("cos(a)", 5e-4, 1.0),
    ("cosh(a)", 1e-4, 1.0),
    ("degrees(a) + radians(b)", 1e-6, 1.0),
    ("exp(a)", 2e-6, 1e-3),
    ("exp2(a)", 2e-6, 1e-3),
    ("fma(a, b, c)", 1e-6, 1.0),
    ("fract(a)", 1e-6, 1.0),
    ("inverseSqrt(a * a + 0.1)", 1e-6, 1e-3),
    ("ldexp(a, i32(b))", 1e-6, 1e-3),
    ("log(abs(a) + 0.01)", 1e-5, 1.0),
    ("log2(abs(a) + 0.01)", 1e-5, 1.0),
    ("max(a, b) - min(b, c)", 1e-6, 1.0),
    ("mix(a, b, c)", 1e-6, 4.0),
    ("pow(abs(a) + 0.01, b)", 1e-4, 1e-3),
    ("unpack4x8snorm(pack4x8snorm(vec4f(a, b, c, 0.0))).y", 0.01, 1.0),
    ("round(a * 3.0) + trunc(b * 3.0)", 0.0, 1.0),
    ("saturate(a) + step(a, b)", 1e-6, 1.0),
    ("sin(a)", 5e-4, 1.0),
    ("sinh(a)", 1e-4, 1.0),
    ("smoothstep(-1.0, 2.0, a)", 1e-5, 1.0),
    ("sqrt(abs(a))", 1e-6, 1e-3),
    ("tan(a * 0.4)", 2e-3, 1.0),
    ("tanh(a)", 1e-4, 1.0),
    ("asinh(a) + acosh(abs(b) + 1.0) + atanh(clamp(c, -0.9, 0.9))", 1e-3, 1.0),
    ("distance(vec2f(a, b), vec2f(c, 1.0)) + length(vec3f(a, b, c))", 1e-6, 1.0),
    ("dot(normalize(vec3f(a, b, 2.0)), reflect(vec3f(c, a, b), vec3f(0.0, 0.0, 1.0)))", 1e-5, 1.0),
    ("refract(normalize(vec3f(a, b, -2.0)), vec3f(0.0, 0.0, 1.0), 0.7).x", 1e-5, 1.0),
    ("determinant(mat3x3f(a, b, c, b, c, a, 1.0, a, b)) / 10.0", 1e-5, 1.0),
    ("(mat2x3f(a, b, c, c, b, a) * vec2f(b, c)).y", 1e-6, 4.0),
    ("f32(bitcast<u32>(a) >> 20u) + f32(u32(abs(b) * 100.0) % 7u)", 0.0, 1.0),
    ("f32(countOneBits(bitcast<u32>(a)) + firstLeadingBit(u32(abs(b) * 1e6)))", 0.0, 1.0),
    ("f32(extractBits(bitcast<u32>(a), 3u, 11u) ^ (bitcast<u32>(b) & 0xffu))", 0.0, 1.0),
];

#[test]
fn builtins_agree_on_the_cores_and_on_the_adapter() {
    let Some(mut gpu) = gpu() else { return };
    let mut cpu = Cpu::new(Precision::F32);
    // Both cosines are positive, so that the host's test lets every row through; the rest is free.
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 23) as f32 * 3.0 - 3.0
    };
    let pairs: Vec<Pair> =
        (0..2000).map(|_| Pair { wo: [next(), next(), 1.0], wi: [next(), 0.0, 1.0] }).collect();
    for three in EXPRESSIONS.chunks(3) {
        let [x, y, z] = [0, 1, 2].map(|index| three[index].0);
        let source = format!(
            "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{\n\
                 let a = wo.x;\n let b = wo.y;\n let c = wi.x;\n\
                 return vec3f({x}, {y}, {z});\n\
             }}"
        );
        let manifest = "kind = \"brdf\"\nname = \"Expressions\"\nabout = \"For a test.\"\n";
        let plugin = from_text("expressions", manifest, &source);
        let program = Arc::new(link(&View::Eval { brdf: plugin.clone() }).unwrap());
        let on =
            |executor: &mut dyn Executor| evaluate(executor, &program, &plugin, &pairs).unwrap();
        let (cores, adapter) = (on(&mut cpu), on(&mut gpu));
        for (index, (text, tolerance, floor)) in three.iter().enumerate() {
            for ((one, other), pair) in cores.iter().zip(&adapter).zip(&pairs) {
                let (one, other) = (one.f[index], other.f[index]);
                assert!(
                    (one - other).abs() <= tolerance * one.abs().max(*floor),
                    "{text}: {one} on the cores, {other} on the adapter, at {pair:?}"
                );
            }
        }
    }
}

#[test]
fn devices_are_chosen_by_name_or_refused() {
    let folder = folder();
    assert!(text(&run(folder.path(), &["devices"]).stdout).contains("cpu  CPU ("));
    let line = refused(folder.path(), &["render", "--resolution", "8", "--device", "voodoo"]);
    assert!(line.contains("--device voodoo: "), "{line}");
    let Some(_) = gpu() else { return };
    assert!(text(&run(folder.path(), &["devices"]).stdout).starts_with("0    "));
    assert!(run(folder.path(), &small(&["--device", "0"])).status.success());
    assert!(line.contains("there is no such adapter; name one of 0 ("), "{line}");
    assert!(line.contains("or cpu"), "{line}");
}

/// No driver at all, on a machine that may have one: everything works, and one line says how.
#[test]
fn without_a_driver_the_cores_render() {
    let folder = folder();
    let nowhere = |arguments: &[&str]| {
        let mut command = program::brdf(folder.path(), arguments);
        command.env("VK_DRIVER_FILES", "/nowhere.json").env("VK_ICD_FILENAMES", "/nowhere.json");
        command.output().unwrap()
    };
    if !cfg!(target_os = "linux") {
        return common::skip("drivers are hidden by variables of Linux's Vulkan loader");
    }
    let output = nowhere(&small(&["--export", "a"]));
    let error = text(&output.stderr);
    assert!(output.status.success(), "{error}");
    assert_eq!(error.matches("note: no graphics adapter here: running on the CPU (").count(), 1);
    assert!(text(&nowhere(&["devices"]).stdout).starts_with("cpu  CPU ("));
    let line = nowhere(&small(&["--device", "0"]));
    assert_eq!(line.status.code(), Some(2));
    assert!(text(&line.stderr).contains("write --device cpu"), "{}", text(&line.stderr));
    // Asked for by name, it is the same executor: the same bits, and nothing to tell.
    let output = run(folder.path(), &small(&["--device", "cpu", "--export", "b"]));
    assert!(!text(&output.stderr).contains("no graphics adapter"));
    assert!(
        fs::read(folder.path().join("a.png")).unwrap()
            == fs::read(folder.path().join("b.png")).unwrap()
    );
}

/// WGSL leaves `pow` of a negative base open, and a device gave 4 for pow(-2, 2): one line warns of it,
/// whatever the picture is rendered on.
#[test]
fn pow_of_a_negative_base_is_warned_of() {
    let folder = folder();
    fs::create_dir(folder.path().join("odd")).unwrap();
    let manifest = "kind = \"brdf\"\nname = \"Odd\"\nabout = \"For a test.\"\n";
    fs::write(folder.path().join("odd/plugin.toml"), manifest).unwrap();
    let eval = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    let fine = pow(max(wi.x, 0.0), 2.0);\n    return vec3f(fine + pow(wi.x, 2.0));\n}\n";
    fs::write(folder.path().join("odd/odd.wgsl"), eval).unwrap();
    for device in [&["--device", "cpu"][..], &[]] {
        let arguments = small(&[&["./odd", "--rendering", "uniform"], device].concat());
        let error = text(&run(folder.path(), &arguments).stderr);
        let note = "odd.wgsl:3:25: `pow` of a negative base: NaN here, and anything on a device";
        assert_eq!(error.matches(note).count(), 1, "{error}");
        assert_eq!(error.matches("negative base").count(), 1, "{error}");
    }
}

#[test]
fn f64_is_computed_on_the_cores_and_shows_its_digits() {
    let folder = folder();
    fs::write(folder.path().join("rows.txt"), "0 0 1 0.6 0 0.8\n").unwrap();
    let pdf = |arguments: &[&str]| -> String {
        let out = text(
            &run(folder.path(), &[&["eval", "lambert", "rows.txt"], arguments].concat()).stdout,
        );
        out.lines().nth(1).unwrap().split(',').nth(3).unwrap().to_owned()
    };
    // cos / pi, with 1 / pi rounded to f32 as all literals are. Rows come as f32, whose (0.6, 0, 0.8) is 2.4e-8 longer
    // than 1: in f64 its cosine is that of the unit vector along it, in f32 the number that stands in the row.
    let [x, z] = [0.6f32, 0.8f32].map(f64::from);
    let exact = |cosine: f64| cosine * f64::from(std::f32::consts::FRAC_1_PI);
    let wide: f64 = pdf(&["--precision", "f64"]).parse().unwrap();
    assert!((wide - exact(z / x.hypot(z))).abs() < 1e-15, "{wide}");
    assert_eq!(pdf(&["--device", "cpu"]).parse::<f32>().unwrap(), exact(z) as f32);
    let line = refused(folder.path(), &["render", "--device", "0", "--precision", "f64"]);
    assert!(line.contains("f64 runs on the CPU executor alone"), "{line}");
}
