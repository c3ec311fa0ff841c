//! The adapters of this machine, and the choice of one.

use brdf_sdk::{Problem, Result};

/// One adapter, as `brdf devices` lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterFacts {
    /// Its place in the list.
    pub index: usize,
    /// Its name.
    pub name: String,
    /// `vulkan`, `metal`, `dx12`.
    pub backend: String,
    /// `discrete GPU`, `CPU`, ...
    pub kind: &'static str,
    /// The driver and its version.
    pub driver: String,
}

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

fn all() -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::PRIMARY));
    adapters.sort_by_key(|adapter| preference(&adapter.get_info()));
    adapters
}

/// Hardware before software; within a kind, the driver's own order.
fn preference(info: &wgpu::AdapterInfo) -> u32 {
    match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn facts(index: usize, info: &wgpu::AdapterInfo) -> AdapterFacts {
    AdapterFacts {
        index,
        name: info.name.clone(),
        backend: info.backend.to_string(),
        kind: match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        },
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
    }
}

/// The interfaces to graphics drivers that are built in: `vulkan`, `metal`, `dx12`.
pub fn interfaces() -> Vec<&'static str> {
    let built = wgpu::Instance::enabled_backend_features() & wgpu::Backends::PRIMARY;
    wgpu::Backend::ALL
        .into_iter()
        .filter(|&backend| built.contains(backend.into()))
        .map(wgpu::Backend::to_str)
        .collect()
}

/// The adapters of this machine, the preferred one first.
pub fn list() -> Vec<AdapterFacts> {
    all().iter().enumerate().map(|(index, adapter)| facts(index, &adapter.get_info())).collect()
}

/// The adapter that `choice` names by its index or a part of its name; the preferred one without.
pub(super) fn choose(choice: Option<&str>) -> Result<wgpu::Adapter> {
    let adapters = all();
    if adapters.is_empty() {
        return Err(Problem::new(
            choice.map_or("the device".to_owned(), |choice| format!("--device {choice}")),
            "this machine has no graphics adapter that wgpu can use",
            "write --device cpu, or install a graphics driver",
        ));
    }
    let Some(choice) = choice else { return Ok(adapters[0].clone()) };
    let by_index = choice.parse::<usize>().ok().and_then(|index| adapters.get(index));
    let wanted = choice.to_lowercase();
    let by_name =
        || adapters.iter().find(|adapter| adapter.get_info().name.to_lowercase().contains(&wanted));
    by_index.or_else(by_name).cloned().ok_or_else(|| {
        let names: Vec<String> = adapters
            .iter()
            .enumerate()
            .map(|(index, adapter)| format!("{index} ({})", adapter.get_info().name))
            .collect();
        Problem::new(
            format!("--device {choice}"),
            "there is no such adapter",
            format!("name one of {}, or cpu", names.join(", ")),
        )
    })
}
