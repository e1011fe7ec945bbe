//! The materials of a scene: one for all objects that look the same.

use octray_geometry::MaterialId;
use octray_scene::{Material, Pigment};

use super::lower::{Context, Lowering};
use super::texture::Layer;
use crate::Span;

impl Lowering<'_> {
    /// The material of a context; one for all contexts that look the same.
    pub(super) fn material(&mut self, context: &Context, span: Span) -> MaterialId {
        if context.texture.layers.len() > 1 {
            self.warn(
                span,
                "layered textures are not supported: the highest opaque layer is taken",
            );
        }
        let layer = shown_layer(&context.texture.layers);
        let inverse = context.texture_world.inverse();
        let mut interior = context.interior.unwrap_or_default();
        if let (None, Some(ior)) = (context.interior, layer.finish.ior)
            && ior > 0.0
        {
            interior.ior = ior;
        }
        let name = context.texture.name.as_deref();
        let material = Material {
            name: name.unwrap_or("texture").to_owned(),
            pigment: match &layer.pigment {
                uniform @ Pigment::Uniform(_) => uniform.clone(),
                pattern => pattern.transformed(&inverse),
            },
            finish: layer.finish.terms,
            interior,
        };
        let key = format!("{material:?}");
        if let Some(id) = self.materials.get(&key) {
            return *id;
        }
        let id = self.builder.add_material(material);
        self.materials.insert(key, id);
        id
    }
}

/// The highest layer that hides those below, or the lowest.
fn shown_layer(layers: &[Layer]) -> &Layer {
    layers
        .iter()
        .rev()
        .find(|layer| !layer.pigment.is_transparent())
        .unwrap_or(&layers[0])
}
