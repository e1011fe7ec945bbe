//! The materials of a scene: one for all objects that look the same.

use std::collections::BTreeMap;

use octray_geometry::MaterialId;
use octray_scene::{Material, Pigment, SceneBuilder};

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
        self.materials.id(material, &mut self.builder)
    }
}

/// The materials that were met.
#[derive(Debug, Default)]
pub(super) struct Materials {
    /// All of them by their text, every digit of it.
    known: BTreeMap<String, MaterialId>,
    /// Those that were used last, latest first: most objects look like one before them, and
    /// comparing is far cheaper than writing the text.
    recent: Vec<(Material, MaterialId)>,
}

/// How many materials are compared before the text is written.
const RECENT: usize = 8;

impl Materials {
    /// The id of a material, new or not.
    fn id(&mut self, material: Material, builder: &mut SceneBuilder) -> MaterialId {
        if let Some(place) = self.recent.iter().position(|(known, _)| *known == material) {
            self.recent[..=place].rotate_right(1);
            return self.recent[0].1;
        }
        let id = *self
            .known
            .entry(format!("{material:?}"))
            .or_insert_with(|| builder.add_material(material.clone()));
        self.recent.truncate(RECENT - 1);
        self.recent.insert(0, (material, id));
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

#[cfg(test)]
mod tests {
    use octray_scene::Color;

    use super::*;

    fn gray(value: f64) -> Material {
        Material {
            pigment: Pigment::Uniform(Color {
                rgb: octray_math::DVec3::splat(value),
                ..Color::default()
            }),
            ..Material::default()
        }
    }

    #[test]
    fn materials_that_look_the_same_have_one_id_however_many_come_between() {
        let (mut materials, mut builder) = (Materials::default(), SceneBuilder::new());
        let many = 3 * RECENT as u32;
        for round in 0..3 {
            for value in 0..many {
                // The first of every round is met again at once, the others after all of them.
                for _ in 0..=u32::from(value == 0) {
                    let id = materials.id(gray(f64::from(value)), &mut builder);
                    assert_eq!(id, MaterialId(value), "round {round}");
                }
            }
        }
        assert!(materials.recent.len() <= RECENT);
    }
}
