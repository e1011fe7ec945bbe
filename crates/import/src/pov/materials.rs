//! The materials of a scene: one for all objects that look the same.

use std::rc::Rc;

use octray_geometry::MaterialId;
use octray_scene::{Interior, Material, Pigment};

use super::lower::{Context, Lowering};
use super::texture::{Layer, Texture};
use crate::Span;

/// A texture that looks the same wherever it is, with what it was taken with.
pub(super) struct RecentMaterial {
    texture: Rc<Texture>,
    interior: Option<Interior>,
    id: MaterialId,
}

/// How many of them are kept.
const RECENT: usize = 16;

impl Lowering {
    /// The material of a context; one for all contexts that look the same.
    pub(super) fn material(&mut self, context: &Context, span: Span) -> MaterialId {
        let recent = self.recent.iter().find(|recent| {
            Rc::ptr_eq(&recent.texture, &context.texture) && recent.interior == context.interior
        });
        if let Some(recent) = recent {
            return recent.id;
        }
        let id = self.described_material(context, span);
        let is_plain = context.texture.layers.len() == 1
            && matches!(context.texture.first().pigment, Pigment::Uniform(_));
        if is_plain {
            if self.recent.len() == RECENT {
                self.recent.remove(0);
            }
            self.recent.push(RecentMaterial {
                texture: Rc::clone(&context.texture),
                interior: context.interior,
                id,
            });
        }
        id
    }

    /// The same, found by what it says.
    fn described_material(&mut self, context: &Context, span: Span) -> MaterialId {
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
