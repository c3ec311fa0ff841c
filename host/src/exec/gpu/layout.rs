//! What a program binds, in wgpu's words.

use crate::link::BindingKind;

pub(super) fn layout_entry(binding: u32, kind: BindingKind) -> wgpu::BindGroupLayoutEntry {
    let buffer =
        |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let texture = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: match kind {
            BindingKind::Uniform => buffer(wgpu::BufferBindingType::Uniform),
            BindingKind::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            BindingKind::ReadWrite => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
            BindingKind::Texture => texture(wgpu::TextureSampleType::Float { filterable: false }),
            BindingKind::WordTexture => texture(wgpu::TextureSampleType::Uint),
        },
        count: None,
    }
}

/// Four numbers a texel.
pub(super) fn texture_format(kind: BindingKind) -> wgpu::TextureFormat {
    match kind {
        BindingKind::WordTexture => wgpu::TextureFormat::Rgba32Uint,
        _ => wgpu::TextureFormat::Rgba32Float,
    }
}
