//! How long an order waits for its first picture while another one is being rendered: what somebody feels who drags
//! a slider, for each integrator; and who saves a file, which needs a new program. Medians and quartiles over many
//! orders, on the default device and on the cores.
//!
//! `cargo bench -p brdf-host --bench live -- [INTEGRATOR...]`

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a benchmark prints, and stops where something is wrong"
)]

use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_host::live::{Live, Order};
use brdf_host::registry::Registry;
use brdf_host::session::{Chosen, Session};
use brdf_sdk::{Kind, ParamValue};

/// Orders of a measurement, and the time between them: a little more than a frame of a screen.
const ORDERS: usize = 41;
const BETWEEN: Duration = Duration::from_millis(17);

fn main() {
    let registry = Registry::new(&[]);
    let integrators: Vec<String> =
        registry.all(Kind::Integrator).into_iter().map(|found| found.id).collect();
    // Cargo adds `--bench`.
    let named: Vec<String> =
        std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for device in [None, Some("cpu".to_owned())] {
        for integrator in integrators.iter().filter(|id| named.is_empty() || named.contains(id)) {
            let mut session = Session::new(&registry).unwrap();
            session.integrator = Chosen::find(&registry, Kind::Integrator, integrator).unwrap();
            session.effort.passes = Some(1 << 16);
            measure(&registry, session, device.clone());
        }
        if named.is_empty() || named.iter().any(|word| word == "save") {
            save(&registry, device.clone());
        }
    }
}

fn measure(registry: &Registry, mut session: Session, device: Option<String>) {
    let live = Live::start(registry.clone(), device, Arc::new(|| ())).unwrap();
    let name = session.integrator.configured.plugin.id.clone();
    live.show(Order::new(session.clone()));
    // Until the whole picture is under way.
    wait(&live, |number, preview| number > 0 && !preview, Duration::from_secs(20));
    live.interact(true);
    let mut times: Vec<f64> = Vec::new();
    let mut before = live.status().frame.map_or(0, |frame| frame.number);
    for order in 0..ORDERS {
        std::thread::sleep(BETWEEN);
        let value = ParamValue::Float(0.05 + 0.01 * order as f64);
        session.brdf.configured.values.set("alpha_x", value.clone());
        let start = Instant::now();
        live.show(Order::new(session.clone()));
        let shows = |live: &Live| {
            let frame = live.status().frame?;
            let own = frame.session.brdf.configured.values.get("alpha_x") == Some(&value);
            (own && frame.number > before).then_some(frame.number)
        };
        before = loop {
            if let Some(number) = shows(&live) {
                break number;
            }
            std::thread::sleep(Duration::from_micros(200));
        };
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    tell(&live, &name, times);
}

/// Saves a BRDF's file again and again, and waits for the picture of each.
fn save(registry: &Registry, device: Option<String>) {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("mine");
    std::fs::create_dir(&folder).unwrap();
    let manifest = "kind = \"brdf\"\nname = \"Mine\"\nabout = \"A benchmark's.\"\n";
    std::fs::write(folder.join("plugin.toml"), manifest).unwrap();
    // A lobe of its own, so that it is no shorter than what people write.
    let write = |number: usize| {
        let source = format!(
            "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {{\n    let h = normalize(wo + wi);\n    \
             let lobe = pow(max(h.z, 0.0), {number}.0);\n    \
             return vec3f(0.2, 0.3, 0.5) * INV_PI + vec3f(lobe) * ({number}.0 + 2.0) / (8.0 * PI);\n}}\n"
        );
        std::fs::write(folder.join("mine.wgsl"), source).unwrap();
    };
    write(1);
    let mut session = Session::new(registry).unwrap();
    let reference = folder.display().to_string();
    session.brdf = Chosen::find(registry, Kind::Brdf, &reference).unwrap();
    session.effort.passes = Some(1 << 16);
    let live = Live::start(registry.clone(), device, Arc::new(|| ())).unwrap();
    live.show(Order::new(session.clone()));
    wait(&live, |number, preview| number > 0 && !preview, Duration::from_secs(20));
    let (mut first, mut link, mut compile) = (Vec::new(), Vec::new(), Vec::new());
    for number in 2..=ORDERS / 2 {
        std::thread::sleep(Duration::from_millis(300));
        write(number);
        let saved = std::time::SystemTime::now();
        let before = live.status().timing;
        session.brdf = session.brdf.reload(registry).unwrap();
        let mut order = Order::new(session.clone());
        order.saved = Some(saved);
        live.show(order);
        let timing = loop {
            match live.status().timing {
                Some(timing) if Some(timing) != before => break timing,
                _ => std::thread::sleep(Duration::from_micros(200)),
            }
        };
        first.push(timing.first_pixel * 1e3);
        link.push(timing.link * 1e3);
        compile.push(timing.compile * 1e3);
    }
    tell(&live, "save", first);
    tell(&live, "save: link", link);
    tell(&live, "save: compile", compile);
}

fn tell(live: &Live, name: &str, mut times: Vec<f64>) {
    times.sort_by(f64::total_cmp);
    let at = |part: f64| times[(part * (times.len() - 1) as f64) as usize];
    println!(
        "{:<40} {name:<16} median {:>6.1} ms, quartiles {:>6.1} to {:>6.1}, longest {:>6.1}",
        live.status().device,
        at(0.5),
        at(0.25),
        at(0.75),
        at(1.0)
    );
}

fn wait(live: &Live, reached: impl Fn(u64, bool) -> bool, patience: Duration) {
    let start = Instant::now();
    while start.elapsed() < patience {
        if live.status().frame.is_some_and(|frame| reached(frame.number, frame.preview)) {
            return;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}
