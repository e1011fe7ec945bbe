//! Colours that a mesh file gives to vertices or faces, as materials.

use std::collections::BTreeMap;

use octray_math::DVec3;
use octray_scene::{Color, Material, MaterialId, Pigment, SceneBuilder};

use crate::dress::default_material;

/// More colours than this are no palette of parts but a picture.
const MOST_COLORS: usize = 4096;

/// What the colours of a mesh come to.
#[derive(Debug, PartialEq)]
pub(crate) enum Painted {
    /// None are given.
    Plain,
    /// One for all faces.
    Whole(MaterialId),
    /// One for each face.
    Faces {
        /// That of the first face.
        first: MaterialId,
        /// All.
        each: Vec<MaterialId>,
    },
    /// They vary within a face, or there are too many.
    Varied,
}

/// Makes a material for every colour; `faces` gives each face's, `None` where it varies.
pub(crate) fn paint(
    faces: impl Iterator<Item = Option<DVec3>>,
    builder: &mut SceneBuilder,
) -> Painted {
    let mut palette: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut colors = Vec::new();
    let mut each = Vec::new();
    for color in faces {
        let Some(color) = color else {
            return Painted::Varied;
        };
        let next = colors.len() as u32;
        let key = (color + DVec3::ZERO).to_array().map(f64::to_bits);
        let index = *palette.entry(key).or_insert(next);
        if index == next {
            if colors.len() == MOST_COLORS {
                return Painted::Varied;
            }
            colors.push(color);
        }
        each.push(index);
    }
    let ids: Vec<MaterialId> = colors
        .iter()
        .map(|&rgb| builder.add_material(colored(rgb)))
        .collect();
    match ids[..] {
        [] => Painted::Plain,
        [only] => Painted::Whole(only),
        [first, ..] => Painted::Faces {
            first,
            each: each.into_iter().map(|i| ids[i as usize]).collect(),
        },
    }
}

/// The default material in another colour.
pub(crate) fn colored(rgb: DVec3) -> Material {
    let part = |x: f64| (x * 255.0).clamp(0.0, 255.0) as u8;
    Material {
        name: format!("#{:02x}{:02x}{:02x}", part(rgb.x), part(rgb.y), part(rgb.z)),
        pigment: Pigment::Uniform(Color::rgb(rgb.x, rgb.y, rgb.z)),
        ..default_material()
    }
}
