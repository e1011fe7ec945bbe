//! The objects of a scene that are made of faces, and their expressions.

use std::cmp::Ordering;

use octray_geometry::csg::{Constant, LoweredScene, Lowering};
use octray_geometry::surface::{PLACE_TOLERANCE, SURFACE_TOLERANCE};
use octray_geometry::{SceneFrame, Sheet, Solid};
use octray_math::Aabb;
use octray_scene::{Object, ObjectId, Scene, Shape};

use super::Ranked;
use super::listed_cells::fingerprint;

/// An object before its rank is known.
pub(super) struct Candidate<'a> {
    pub(super) id: ObjectId,
    pub(super) object: &'a Object,
    pub(super) boundary: &'a Solid,
    pub(super) clip: Option<&'a Solid>,
    /// In the coordinates of the scene.
    pub(super) bounds: Aabb,
    /// How large it counts as where solids overlap.
    pub(super) size: f64,
}

/// What merged surfaces and rounding move, many times over.
pub(crate) fn slack(frame: &SceneFrame) -> f64 {
    64.0 * (SURFACE_TOLERANCE * frame.size + PLACE_TOLERANCE * frame.largest())
}

impl<'a> Candidate<'a> {
    pub(super) fn new(index: usize, object: &'a Object, frame: &SceneFrame) -> Option<Self> {
        let (boundary, clip) = match &object.shape {
            Shape::Solid(solid) => (solid, None),
            Shape::Sheet(Sheet::Shell { solid, clip }) => (solid, Some(clip)),
            Shape::Sheet(Sheet::Mesh { .. }) | Shape::Instances(_) => return None,
        };
        // By the same transforms as the faces, so that rounding far from the origin moves both.
        let scene_from_world = frame.scene_from_world();
        let slack = slack(frame);
        let bounds = [Some(boundary), clip]
            .into_iter()
            .flatten()
            .map(|solid| solid.enclosure_in(&scene_from_world, slack))
            .fold(Aabb::ALL, Aabb::intersection);
        let bounds = if bounds.is_empty() {
            Aabb::EMPTY
        } else {
            bounds
        };
        Some(Self {
            id: ObjectId(index as u32),
            object,
            boundary,
            clip,
            bounds,
            size: if bounds.is_bounded() {
                bounds.diagonal()
            } else {
                f64::INFINITY
            },
        })
    }

    /// Higher priority, then smaller, then later: what is inside something else is seen there.
    pub(super) fn rank(&self, other: &Self) -> Ordering {
        (other.object.priority.cmp(&self.object.priority))
            .then(self.size.total_cmp(&other.size))
            .then(other.id.cmp(&self.id))
    }
}

/// The expressions of one object.
pub(super) struct LoweredObject {
    pub(super) id: ObjectId,
    pub(super) boundary: Expression,
    /// Of a solid, what is true everywhere.
    pub(super) clip: Expression,
}

/// An expression as a range of words, or what it always is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Expression {
    Constant(Constant),
    Words([u32; 2]),
}

impl Expression {
    fn lower(solid: &Solid, lowering: &mut Lowering, words: &mut Vec<u32>) -> Self {
        let start = words.len() as u32;
        match lowering.lower_into(solid, words) {
            Some(constant) => Self::Constant(constant),
            None => Self::Words([start, words.len() as u32]),
        }
    }

    /// Its words, or what it always is.
    pub(super) fn words(self, all: &[u32]) -> Result<&[u32], Constant> {
        match self {
            Self::Constant(constant) => Err(constant),
            Self::Words([start, end]) => Ok(&all[start as usize..end as usize]),
        }
    }
}

/// The objects' expressions.
pub(super) struct Expressions {
    /// For each object its expressions.
    pub(super) lowered: Vec<LoweredObject>,
    /// The words of all expressions.
    pub(super) words: Vec<u32>,
    /// The object of each face.
    pub(super) owners: Vec<ObjectId>,
    pub(super) merged_surfaces: usize,
    pub(super) scene: LoweredScene,
}

impl Expressions {
    /// Faces are numbered in the order of the objects.
    pub(super) fn new(
        candidates: &[Candidate<'_>],
        frame: &SceneFrame,
        with_operands: bool,
    ) -> Self {
        let mut lowering = Lowering::new(frame);
        if with_operands {
            lowering = lowering.with_operands();
        }
        let mut lowered = Vec::with_capacity(candidates.len());
        let mut owners = Vec::new();
        let mut words = Vec::new();
        for candidate in candidates {
            let mut lower = |solid| Expression::lower(solid, &mut lowering, &mut words);
            let boundary = lower(candidate.boundary);
            let everywhere = Expression::Constant(Constant::True);
            let clip = candidate.clip.map_or(everywhere, lower);
            owners.resize(lowering.face_count(), candidate.id);
            lowered.push(LoweredObject {
                id: candidate.id,
                boundary,
                clip,
            });
        }
        Self {
            lowered,
            words,
            owners,
            merged_surfaces: lowering.merged_surfaces(),
            scene: lowering.finish(),
        }
    }

    /// Tells these objects from others.
    pub(super) fn fingerprint(&self) -> u64 {
        let words = self.lowered.iter().flat_map(|object| {
            // A clip that is true everywhere is none.
            let clip = Some(object.clip).filter(|c| *c != Expression::Constant(Constant::True));
            let expressions = std::iter::once(object.boundary).chain(clip);
            std::iter::once(object.id.0).chain(expressions.flat_map(|expression| {
                match expression.words(&self.words) {
                    Ok(words) => words,
                    Err(Constant::True) => &[u32::MAX],
                    Err(Constant::False) => &[],
                }
                .iter()
                .copied()
            }))
        });
        fingerprint(&self.scene.operands, words)
    }
}

pub(super) fn candidates<'a>(scene: &'a Scene, frame: &SceneFrame) -> Vec<Candidate<'a>> {
    let objects = scene.objects().iter().enumerate();
    objects
        .filter_map(|(index, object)| Candidate::new(index, object, frame))
        .collect()
}

impl Ranked {
    pub(super) fn new(candidate: &Candidate<'_>) -> Self {
        Self {
            object: candidate.id,
            priority: candidate.object.priority,
            shell: matches!(candidate.object.shape, Shape::Sheet(_)),
        }
    }
}
