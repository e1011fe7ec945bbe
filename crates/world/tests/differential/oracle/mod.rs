//! Which object a point of a ray belongs to, from the definitions of the primitives alone.
//!
//! Nothing here knows faces, surfaces, roots or octrees: the user's tree of solids is evaluated at
//! a point whose coordinates are exact. Clearances are computed in `f64`, again to about 100 bits
//! where that is too coarse, and a disagreement is only believed when whole numbers of any size
//! confirm it (see [`exact`]).

mod clearance;
mod exact;
mod frame;
mod implicit;
mod number;
mod plant;
mod proposals;
mod sight;

use std::cmp::Ordering;

use octray_geometry::surface::{PLACE_TOLERANCE, SURFACE_TOLERANCE};
use octray_geometry::{Primitive, SceneFrame, finite_box};
use octray_math::{Aabb, DAffine3, DVec3, Ray};
use octray_scene::{Scene, Shape};

use clearance::clearance;
use exact::ExactFrame;
use frame::Frame;
use implicit::Term;
use number::Number;
use plant::plant;

pub(crate) use sight::Sight;

/// What is known of a yes-or-no question: `None` where rounding may decide it.
pub(crate) type Answer = Option<bool>;

/// A primitive where it stands.
#[derive(Debug)]
struct Leaf {
    primitive: Primitive,
    chain: Vec<DAffine3>,
    frame: Frame,
    extent: f64,
    /// Of a primitive that a polynomial defines.
    terms: Option<Vec<Term>>,
}

impl Leaf {
    /// See [`clearance`].
    fn clearance<N: Number>(&self, q: [N; 3]) -> N {
        match &self.terms {
            Some(terms) => implicit::clearance(terms, q),
            None => clearance(&self.primitive, q),
        }
    }
}

#[derive(Debug)]
enum Node {
    Leaf(usize),
    All(Vec<Node>),
    Any(Vec<Node>),
    Not(Box<Node>),
}

/// An object in the order in which regions are decided.
#[derive(Debug)]
struct Owner {
    object: u32,
    root: Node,
    priority: i32,
    size: f64,
}

/// The region of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In this object, or in none.
    In(Option<u32>),
    /// So near to a boundary that rounding, or the surface table's tolerance, may decide.
    Near,
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Oracle {
    leaves: Vec<Leaf>,
    owners: Vec<Owner>,
    /// A ball around all that is bounded in the primitives.
    center: DVec3,
    radius: f64,
    /// The coordinates in which the tolerance is stated.
    scene: SceneFrame,
    /// How far the surface table may have moved boundaries, in units of the scene's size.
    tolerance: f64,
}

/// Two merged planes may differ by the tolerance in their distance from the origin and in each
/// component of their normals: four times that at a corner of the scene. Other surfaces get twice
/// as much.
const MERGED: f64 = 8.0;

impl Oracle {
    /// For the solids of a scene. `merged`: whether the surface table has made any surfaces one.
    pub(crate) fn new(scene: &Scene, merged: bool) -> Self {
        let mut leaves = Vec::new();
        let mut owners = Vec::new();
        for (index, object) in scene.objects().iter().enumerate() {
            let Shape::Solid(solid) = &object.shape else {
                panic!("only solids have an inside");
            };
            let bounds = object.shape.bounds();
            owners.push(Owner {
                object: index as u32,
                root: plant(solid, &mut Vec::new(), &mut leaves),
                priority: object.priority,
                size: if bounds.is_bounded() {
                    bounds.diagonal()
                } else {
                    f64::INFINITY
                },
            });
        }
        // Higher priority, then smaller, then later.
        owners.sort_by(|a, b| {
            (b.priority.cmp(&a.priority))
                .then(a.size.total_cmp(&b.size))
                .then(b.object.cmp(&a.object))
        });
        let around = |leaf: &Leaf| {
            let origin = leaf.frame.world_from_local.translation;
            let size = DVec3::splat(leaf.frame.stretch * leaf.extent);
            Aabb::new(origin - size, origin + size)
        };
        let all = leaves.iter().map(around).fold(Aabb::EMPTY, Aabb::union);
        let (center, radius) = if all.is_empty() {
            (DVec3::ZERO, 1.0)
        } else {
            (all.center(), all.diagonal())
        };
        let unbounded = scene.objects().iter().filter_map(|object| {
            let bounds = object.shape.bounds();
            match &object.shape {
                Shape::Solid(solid) if !bounds.is_empty() && !bounds.is_bounded() => Some(solid),
                _ => None,
            }
        });
        let frame = SceneFrame::new(&finite_box(scene.bounds(), &unbounded.collect::<Vec<_>>()));
        Self {
            leaves,
            owners,
            center,
            radius: radius.max(f64::MIN_POSITIVE),
            tolerance: if merged {
                let place = PLACE_TOLERANCE * (frame.largest() / frame.size);
                MERGED * (SURFACE_TOLERANCE + place)
            } else {
                0.0
            },
            scene: frame,
        }
    }

    /// The unit of the surface table's tolerance.
    pub(crate) fn scene_size(&self) -> f64 {
        self.scene.size
    }

    /// How unevenly space is stretched for a primitive, at most.
    pub(crate) fn worst_condition(&self) -> f64 {
        let leaves = self.leaves.iter();
        leaves.fold(1.0, |worst, leaf| leaf.frame.condition.max(worst))
    }

    /// Whether a boundary may touch others so closely that they are one over a stretch, as far as
    /// the tolerance tells: the poles of superellipsoids are flat, to any order.
    pub(crate) fn may_osculate(&self) -> bool {
        let is_smooth = |leaf: &Leaf| {
            matches!(leaf.primitive, Primitive::Superellipsoid { .. }) || leaf.terms.is_some()
        };
        self.leaves.iter().any(is_smooth)
    }

    /// The primitives, each with where it is, rounded.
    pub(crate) fn primitives(&self) -> impl Iterator<Item = (&Primitive, DAffine3)> {
        let leaves = self.leaves.iter();
        leaves.map(|leaf| (&leaf.primitive, leaf.frame.world_from_local))
    }

    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// Whether each object holds a point, by rank.
    fn answers(&self, answers: &mut Vec<Answer>, is_inside: &mut impl FnMut(usize) -> Answer) {
        answers.clear();
        answers.extend(self.owners.iter().map(|o| evaluate(&o.root, is_inside)));
    }

    /// The objects by rank.
    pub(crate) fn objects(&self) -> impl Iterator<Item = u32> {
        self.owners.iter().map(|owner| owner.object)
    }

    /// The region of a point, given which objects hold it.
    ///
    /// Which of two objects is the smaller one is not known where rounding decides it.
    pub(crate) fn place(&self, answers: &[Answer]) -> Place {
        let holding = |(_, answer): &(&Owner, &Answer)| **answer != Some(false);
        let mut holding = self.owners.iter().zip(answers).filter(holding);
        let Some((first, answer)) = holding.next() else {
            return Place::In(None);
        };
        let alike = |other: &Owner| {
            let apart = (other.size - first.size).abs();
            other.priority == first.priority && apart <= 1e-9 * first.size
        };
        let rivals = holding.any(|(other, _)| first.size.is_finite() && alike(other));
        match answer {
            Some(true) if !rivals => Place::In(Some(first.object)),
            _ => Place::Near,
        }
    }

    /// Whether each object holds a point, by rank, without any rounding or margin; not known means
    /// on a boundary.
    pub(crate) fn exact_answers(&self, ray: &Ray, t: f64) -> Vec<Answer> {
        let point = exact::point_at(ray, t);
        let mut answers = Vec::new();
        self.answers(&mut answers, &mut |index| {
            let leaf = &self.leaves[index];
            let frame = ExactFrame::product(&leaf.chain);
            match exact::side(&leaf.primitive, &frame, &point) {
                Ordering::Less => Some(true),
                Ordering::Equal => None,
                Ordering::Greater => Some(false),
            }
        });
        answers
    }
}

/// Three-valued: one operand that decides is enough.
fn evaluate(node: &Node, is_inside: &mut impl FnMut(usize) -> Answer) -> Answer {
    let mut first_that = |nodes: &[Node], decides: bool| {
        let mut result = Some(!decides);
        for node in nodes {
            match evaluate(node, is_inside) {
                Some(value) if value == decides => return Some(decides),
                Some(_) => {}
                None => result = None,
            }
        }
        result
    };
    match node {
        Node::Leaf(index) => is_inside(*index),
        Node::Not(node) => evaluate(node, is_inside).map(|value| !value),
        Node::All(nodes) => first_that(nodes, false),
        Node::Any(nodes) => first_that(nodes, true),
    }
}
