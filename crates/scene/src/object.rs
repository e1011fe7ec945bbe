use std::sync::Arc;

use octray_geometry::{MaterialId, Sheet, Solid};
use octray_math::Aabb;

use crate::Instances;

/// The index of an object in [`crate::Scene::objects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// What an object is made of.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Has an inside.
    Solid(Solid),
    /// Has two sides.
    Sheet(Sheet),
    /// Many copies of solids and sheets.
    Instances(Instances),
}

impl Shape {
    /// A box around it, possibly unbounded.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Solid(solid) => solid.bounds(),
            Self::Sheet(sheet) => sheet.bounds(),
            Self::Instances(instances) => instances.bounds(),
        }
    }
}

/// A thing in the scene.
#[derive(Clone, Debug)]
pub struct Object {
    /// For messages, listings and queries; need not be unique. Shared by those that have the same.
    pub name: Arc<str>,
    /// Geometry in world coordinates; of instances, transforms into them.
    pub shape: Shape,
    /// For every face that has no material of its own, and for the inside.
    pub material: MaterialId,
    /// Where solids overlap, the one of higher priority is there and the other is not.
    pub priority: i32,
    /// `false`: light passes as if it were not there.
    pub casts_shadows: bool,
}

impl Object {
    /// A solid with the usual settings.
    #[must_use]
    pub fn solid(name: impl Into<Arc<str>>, solid: Solid, material: MaterialId) -> Self {
        Self::new(name, Shape::Solid(solid), material)
    }

    /// A sheet with the usual settings.
    #[must_use]
    pub fn sheet(name: impl Into<Arc<str>>, sheet: Sheet, material: MaterialId) -> Self {
        Self::new(name, Shape::Sheet(sheet), material)
    }

    /// Copies of a prototype with the usual settings.
    #[must_use]
    pub fn instances(
        name: impl Into<Arc<str>>,
        instances: Instances,
        material: MaterialId,
    ) -> Self {
        Self::new(name, Shape::Instances(instances), material)
    }

    pub(crate) fn new(name: impl Into<Arc<str>>, shape: Shape, material: MaterialId) -> Self {
        Self {
            name: name.into(),
            shape,
            material,
            priority: 0,
            casts_shadows: true,
        }
    }
}
