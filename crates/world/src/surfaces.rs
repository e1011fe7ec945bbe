//! What the surface table made of a scene, for whoever wants to know before rays are shot.

use std::collections::HashSet;
use std::sync::Arc;

use octray_geometry::csg::{Face, LoweredScene, Lowering};
use octray_geometry::surface::{NEAR, Surface};
use octray_geometry::{SceneFrame, Sheet};
use octray_math::DVec3;
use octray_scene::{ObjectId, Scene, Shape};

use crate::WorldError;
use crate::world::check_face_count;

/// The surfaces of a scene's solids: which were taken for one, and which nearly were. Those of
/// prototypes are compared among themselves, by a tolerance of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceReport {
    /// Distinct surfaces, triangles not counted.
    pub surfaces: usize,
    /// Faces that turned out to lie on another face's surface.
    pub merged: usize,
    /// Surfaces up to this distance apart are one; in the scene's unit of length.
    pub tolerance: f64,
    /// Surfaces farther apart than the tolerance and nearer than this are reported.
    pub near: f64,
    /// The surfaces that nearly coincide with an earlier one.
    pub pairs: Vec<NearCoincidence>,
}

/// Two surfaces of one kind so near to each other that they may be meant as one, and are two.
#[derive(Clone, Debug, PartialEq)]
pub struct NearCoincidence {
    /// The objects whose faces brought them.
    pub objects: [ObjectId; 2],
    /// Whether they are planes; else they are curved.
    pub planes: bool,
    /// How far they are apart at most within the scene's size.
    pub gap: f64,
    /// The point of the first plane that is nearest to the middle of its object, or the centre of
    /// the first curved surface. Of instances, in the coordinates of their prototype.
    pub position: DVec3,
}

impl SurfaceReport {
    /// Lowers the solids as [`crate::World::prepare`] does, but builds nothing.
    ///
    /// # Errors
    /// [`WorldError::TooManyFaces`].
    pub fn new(scene: &Scene) -> Result<Self, WorldError> {
        check_face_count(scene)?;
        let frame = SceneFrame::new(&scene.bounds());
        let mut lowering = Lowering::new(&frame);
        let mut owners: Vec<ObjectId> = Vec::new();
        for (index, object) in scene.objects().iter().enumerate() {
            let solids = match &object.shape {
                Shape::Solid(solid) => [Some(solid), None],
                Shape::Sheet(Sheet::Shell { solid, clip }) => [Some(solid), Some(clip)],
                Shape::Sheet(Sheet::Mesh { .. }) | Shape::Instances(_) => [None, None],
            };
            for solid in solids.into_iter().flatten() {
                // Only the surfaces are of interest, not the expression.
                let _expression = lowering.lower(solid);
            }
            owners.resize(lowering.face_count(), ObjectId(index as u32));
        }
        let near = lowering.near_pairs();
        let (merged, tolerance) = (lowering.merged_surfaces(), lowering.tolerance());
        let LoweredScene {
            faces, surfaces, ..
        } = lowering.finish();
        let owner = first_owners(&faces, &owners, surfaces.len());
        let pairs = near
            .iter()
            .map(|pair| {
                let surface = &surfaces[pair.first.0 as usize];
                let objects = [pair.first, pair.second].map(|id| owner[id.0 as usize]);
                let bounds = scene.objects()[objects[0].0 as usize].shape.bounds();
                let middle = if bounds.is_bounded() && !bounds.is_empty() {
                    bounds.center() - frame.origin
                } else {
                    DVec3::ZERO
                };
                NearCoincidence {
                    objects,
                    planes: matches!(surface, Surface::Plane { .. }),
                    gap: pair.gap * frame.size,
                    position: place(surface, middle) + frame.origin,
                }
            })
            .collect();
        let mut report = Self {
            surfaces: surfaces.len(),
            merged,
            tolerance: tolerance * frame.size,
            near: NEAR * frame.size,
            pairs,
        };
        report.add_prototypes(scene)?;
        Ok(report)
    }

    /// Adds the surfaces of prototypes, which have a table of their own each.
    fn add_prototypes(&mut self, scene: &Scene) -> Result<(), WorldError> {
        let mut known: HashSet<*const Scene> = HashSet::new();
        for (index, object) in scene.objects().iter().enumerate() {
            let Shape::Instances(instances) = &object.shape else {
                continue;
            };
            let parts = instances.prototype().parts();
            if known.insert(Arc::as_ptr(parts)) {
                let own = Self::new(parts)?;
                self.surfaces += own.surfaces;
                self.merged += own.merged;
                let objects = [ObjectId(index as u32); 2];
                let pairs = own.pairs.into_iter();
                self.pairs
                    .extend(pairs.map(|pair| NearCoincidence { objects, ..pair }));
            }
        }
        Ok(())
    }
}

/// The object of the first face of each surface.
fn first_owners(faces: &[Face], owners: &[ObjectId], surfaces: usize) -> Vec<ObjectId> {
    let mut first = vec![ObjectId(0); surfaces];
    for (face, owner) in faces.iter().zip(owners).rev() {
        if let Some(slot) = first.get_mut(face.surface.0 as usize) {
            *slot = *owner;
        }
    }
    first
}

fn place(surface: &Surface, middle: DVec3) -> DVec3 {
    match surface {
        Surface::Plane { normal, offset } => middle + *normal * (offset - normal.dot(middle)),
        Surface::Curved {
            local_from_scene, ..
        } => local_from_scene.inverse().translation,
    }
}
