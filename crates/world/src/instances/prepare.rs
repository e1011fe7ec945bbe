//! From the scene's objects to prototypes, and the octree over their copies.

use std::collections::HashMap;
use std::sync::Arc;

use octray_geometry::SceneFrame;
use octray_math::{Aabb, DAffine3};
use octray_scene::{ObjectId, Scene, Shape};
use octray_tree::{WideTree, WideTreeConfig, WideTreeError};
use rayon::prelude::*;

use super::boxes::copy_box;
use super::{Copies, Instances};
use crate::solids::slack;
use crate::{Method, World, WorldConfig, WorldError};

impl Instances {
    /// The copies in the scene; their faces are numbered from `first_face`.
    ///
    /// # Errors
    /// A prototype cannot be prepared, or the octree over the copies would be too large.
    pub(crate) fn prepare(
        scene: &Scene,
        frame: &SceneFrame,
        first_face: u32,
        config: &WorldConfig,
    ) -> Result<Self, WorldError> {
        let mut all = Self {
            origin: frame.origin,
            ..Self::default()
        };
        // Objects may share a prototype.
        let mut known: HashMap<*const Scene, usize> = HashMap::new();
        let mut count = 0_u64;
        let mut next_face = first_face;
        for (index, object) in scene.objects().iter().enumerate() {
            let Shape::Instances(instances) = &object.shape else {
                continue;
            };
            let parts = instances.prototype().parts();
            let place = known.entry(Arc::as_ptr(parts));
            let new = all.prototypes.len();
            let prototype = *place.or_insert(new);
            if prototype == new {
                let made = World::prepare(Arc::clone(parts), config);
                all.prototypes
                    .push(made.map_err(|e| named(e, &object.name))?);
            }
            let copies = Copies {
                object: ObjectId(index as u32),
                priority: object.priority,
                prototype,
                first_copy: count as u32,
                first_face: next_face,
                world_from_prototype: Arc::clone(instances.world_from_prototype()),
            };
            count += copies.world_from_prototype.len() as u64;
            if count > u64::from(u32::MAX) - 1 {
                return Err(WorldError::Instances(WideTreeError::TooMany(
                    count as usize,
                )));
            }
            next_face += all.prototypes[prototype].own_face_count();
            all.objects.push(copies);
        }
        all.count = count as u32;
        all.have_insides = (all.prototypes.iter()).any(World::has_solids);
        all.priorities_differ = priorities_differ(scene);
        if config.method != Method::Brute && count > 0 {
            all.tree = Some(all.build_tree(frame, &config.triangles)?);
        }
        Ok(all)
    }

    fn build_tree(
        &self,
        frame: &SceneFrame,
        config: &WideTreeConfig,
    ) -> Result<WideTree, WorldError> {
        let items = self.count as usize;
        let own = (items * size_of::<Aabb>()) as u64;
        let limit = config.memory_limit;
        let Some(left) = limit.checked_sub(own) else {
            let needed = own;
            return Err(WorldError::Instances(WideTreeError::Memory {
                items,
                needed,
                limit,
            }));
        };
        let scene_from_world = frame.scene_from_world();
        let mut boxes: Vec<Aabb> = Vec::with_capacity(items);
        for copies in &self.objects {
            let prototype = &self.prototypes[copies.prototype];
            let bounds = prototype.enclosure();
            let largest = prototype.place.frame.largest();
            let placed = copies.world_from_prototype.par_iter();
            boxes.par_extend(placed.map(|world_from_prototype: &DAffine3| {
                let placed = scene_from_world * *world_from_prototype;
                copy_box(&bounds, &placed, frame.size, largest)
            }));
        }
        let config = WideTreeConfig {
            // Taking a line into a prototype costs more than a node of boxes.
            leaf_size: 1,
            memory_limit: left,
            ..*config
        };
        WideTree::build(&boxes, &config)
            .map_err(|error| match error {
                WideTreeError::Memory { items, needed, .. } => WideTreeError::Memory {
                    items,
                    needed: needed.saturating_add(own),
                    limit,
                },
                other => other,
            })
            .map_err(WorldError::Instances)
    }
}

/// The error of a prototype, whose parts have no names.
fn named(error: WorldError, name: &str) -> WorldError {
    match error {
        WorldError::Mesh { error, .. } => WorldError::Mesh {
            object: name.to_owned(),
            error,
        },
        other => other,
    }
}

/// Whether any two things with an inside have different priorities, copies among them.
fn priorities_differ(scene: &Scene) -> bool {
    let is_solid = |shape: &Shape| matches!(shape, Shape::Solid(_));
    let mut all = scene.objects().iter().filter_map(|object| {
        let has_inside = match &object.shape {
            Shape::Instances(instances) => {
                let mut parts = instances.prototype().parts().objects().iter();
                parts.any(|part| is_solid(&part.shape))
            }
            shape => is_solid(shape),
        };
        has_inside.then_some(object.priority)
    });
    let first = all.next();
    all.any(|priority| Some(priority) != first)
}

impl World {
    /// A box around everything, and what rounding moves, in its own coordinates; what is unbounded
    /// does not count.
    fn enclosure(&self) -> Aabb {
        let frame = &self.place.frame;
        let meshes = self.scene.objects().iter().filter_map(|object| {
            let bounds = object.shape.bounds();
            matches!(object.shape, Shape::Sheet(_)).then_some(bounds)
        });
        let solids = self.solids.bounds();
        let solids = Aabb::new(solids.min + frame.origin, solids.max + frame.origin);
        let all = meshes.fold(solids, Aabb::union);
        if all.is_empty() {
            Aabb::EMPTY
        } else {
            all.inflated(slack(frame))
        }
    }

    /// How many ids the faces of its own objects use, copies aside.
    pub(crate) fn own_face_count(&self) -> u32 {
        self.solids.face_count() + self.sheets.triangle_count() as u32
    }

    /// Whether any object has an inside, copies aside.
    fn has_solids(&self) -> bool {
        let mut objects = self.scene.objects().iter();
        objects.any(|object| matches!(object.shape, Shape::Solid(_)))
    }
}
