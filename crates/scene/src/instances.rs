//! Many copies of one thing, each by an affine transform.

use std::sync::Arc;

use octray_geometry::{MaterialId, ShapeError, Sheet};
use octray_math::{Aabb, DAffine3, transform};
use thiserror::Error;

use crate::{Object, Scene, SceneBuilder, Shape};

/// What is copied: solids and sheets in coordinates of their own.
#[derive(Clone, Debug)]
pub struct Prototype {
    parts: Arc<Scene>,
    bounds: Aabb,
}

/// An object that is many copies of a prototype.
///
/// It takes 96 bytes for each copy; clones share them.
#[derive(Clone, Debug)]
pub struct Instances {
    prototype: Arc<Prototype>,
    world_from_prototype: Arc<[DAffine3]>,
    bounds: Aabb,
}

/// Why there are no such copies.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InstancesError {
    /// A prototype is made of solids and sheets alone.
    #[error("part {0} of the prototype is made of instances itself: one level is supported")]
    Nested(usize),
    /// Copies are found by their boxes.
    #[error("part {0} of the prototype has no end: only what is bounded can be copied")]
    Unbounded(usize),
    /// A part is too large to be worked on.
    #[error("part {part} of the prototype: {error}")]
    Part {
        /// Its number, from 0.
        part: usize,
        /// What is wrong.
        error: ShapeError,
    },
    /// A transform that flattens, or with a NaN or an infinity.
    #[error("transform {0} is not finite or cannot be inverted")]
    Transform(usize),
    /// The prototype is moved beyond the numbers.
    #[error("transform {0} moves the prototype beyond the range of numbers")]
    OutOfRange(usize),
    /// More than can be told apart.
    #[error("{0} copies; an object has at most 2^28")]
    TooMany(usize),
}

impl Prototype {
    /// The material of faces that take that of the copies' object.
    pub const INHERITED: MaterialId = MaterialId(u32::MAX);

    /// From solids and sheets. Faces without a material of their own, and the inside, have that of
    /// the object that the copies are.
    ///
    /// # Errors
    /// A part is unbounded, too large, or made of instances.
    pub fn new(parts: impl IntoIterator<Item = Shape>) -> Result<Self, InstancesError> {
        let mut builder = SceneBuilder::new();
        let mut bounds = Aabb::EMPTY;
        for (part, shape) in parts.into_iter().enumerate() {
            match &shape {
                Shape::Instances(_) => return Err(InstancesError::Nested(part)),
                Shape::Solid(solid) => solid.check_size(),
                Shape::Sheet(Sheet::Shell { solid, clip }) => {
                    solid.check_size().and_then(|()| clip.check_size())
                }
                Shape::Sheet(Sheet::Mesh { .. }) => Ok(()),
            }
            .map_err(|error| InstancesError::Part { part, error })?;
            let own = shape.bounds();
            if !own.is_bounded() {
                return Err(InstancesError::Unbounded(part));
            }
            bounds = bounds.union(own);
            builder.add_object(Object::new("", shape, Self::INHERITED));
        }
        Ok(Self {
            parts: Arc::new(builder.into_scene()),
            bounds,
        })
    }

    /// The parts as a scene of their own, without anything but objects. Their material is
    /// [`Prototype::INHERITED`].
    #[must_use]
    pub const fn parts(&self) -> &Arc<Scene> {
        &self.parts
    }

    /// A box around all parts.
    #[must_use]
    pub const fn bounds(&self) -> &Aabb {
        &self.bounds
    }
}

impl Instances {
    /// The copies of a prototype, one for each transform; none at all are allowed.
    ///
    /// # Errors
    /// A transform cannot be inverted or leads beyond the range of numbers; there are too many.
    pub fn new(
        prototype: Arc<Prototype>,
        world_from_prototype: impl Into<Arc<[DAffine3]>>,
    ) -> Result<Self, InstancesError> {
        let world_from_prototype = world_from_prototype.into();
        if world_from_prototype.len() > 1 << 28 {
            return Err(InstancesError::TooMany(world_from_prototype.len()));
        }
        let mut bounds = Aabb::EMPTY;
        for (index, placed) in world_from_prototype.iter().enumerate() {
            if !transform::is_invertible(placed) {
                return Err(InstancesError::Transform(index));
            }
            let own = prototype.bounds.transformed(placed);
            if !own.is_bounded() || !own.size().is_finite() && !own.is_empty() {
                return Err(InstancesError::OutOfRange(index));
            }
            bounds = bounds.union(own);
        }
        Ok(Self {
            prototype,
            world_from_prototype,
            bounds,
        })
    }

    /// What is copied.
    #[must_use]
    pub const fn prototype(&self) -> &Arc<Prototype> {
        &self.prototype
    }

    /// For every copy where it stands, invertible.
    #[must_use]
    pub const fn world_from_prototype(&self) -> &Arc<[DAffine3]> {
        &self.world_from_prototype
    }

    /// A box around the transformed boxes of all copies.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }
}

#[cfg(test)]
mod tests {
    use octray_geometry::Solid;
    use octray_math::DVec3;

    use super::*;

    fn ball() -> Arc<Prototype> {
        let ball = Solid::sphere(1.0).expect("a ball");
        Arc::new(Prototype::new([Shape::Solid(ball)]).expect("a prototype"))
    }

    #[test]
    fn what_cannot_be_copied_is_refused() {
        let floor = Solid::half_space(DVec3::Z, 0.0).expect("valid");
        let unbounded = Prototype::new([Shape::Solid(Solid::empty()), Shape::Solid(floor)]);
        assert_eq!(unbounded.err(), Some(InstancesError::Unbounded(1)));
        let copies = Instances::new(ball(), [DAffine3::IDENTITY]).expect("copies");
        let nested = Prototype::new([Shape::Instances(copies)]);
        assert_eq!(nested.err(), Some(InstancesError::Nested(0)));
    }

    #[test]
    fn transforms_that_lead_nowhere_are_refused_by_their_number() {
        let good = DAffine3::from_translation(DVec3::X);
        let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
        let lost = DAffine3::from_translation(DVec3::new(0.0, f64::NAN, 0.0));
        let far = DAffine3::from_translation(DVec3::splat(f64::INFINITY));
        for bad in [flat, lost, far] {
            let copies = Instances::new(ball(), vec![good, bad]);
            assert_eq!(copies.err(), Some(InstancesError::Transform(1)));
        }
        let huge = DAffine3 {
            translation: DVec3::splat(f64::MAX),
            ..DAffine3::from_scale(DVec3::splat(1e300))
        };
        let copies = Instances::new(ball(), vec![good, good, huge]);
        assert!(matches!(
            copies.err(),
            Some(InstancesError::OutOfRange(2) | InstancesError::Transform(2))
        ));
    }

    #[test]
    fn the_box_is_around_all_copies() {
        let at = |x: f64| DAffine3::from_translation(DVec3::X * x);
        let copies = Instances::new(ball(), vec![at(-3.0), at(8.0)]).expect("copies");
        let (low, high) = (DVec3::new(-4.0, -1.0, -1.0), DVec3::new(9.0, 1.0, 1.0));
        assert_eq!(copies.bounds(), Aabb::new(low, high));
        let none = Instances::new(ball(), Vec::new()).expect("no copies");
        assert!(none.bounds().is_empty());
    }
}
