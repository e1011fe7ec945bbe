//! The flat methods: a volume around every object is tested first (Weghorst, Hooper and Greenberg,
//! *Improved Computational Methods for Ray Tracing*, 1984).

use octray_math::{Aabb, DVec3, Interval, Ray};
use octray_tree::CellTree;

use super::leaf::LeafObject;
use super::{LeafVisit, Scratch, Solids};
use crate::Counters;
use crate::line::Line;

/// The volumes, by the objects' ranks.
#[derive(Debug)]
pub(super) struct Volumes(Vec<Volume>);

#[derive(Clone, Copy, Debug)]
enum Volume {
    Everything,
    Nothing,
    Box(Aabb),
    Sphere { center: DVec3, radius: f64 },
}

/// What matters on one line: working memory.
#[derive(Debug, Default)]
pub(super) struct LeafHits {
    pub(super) objects: Vec<LeafObject>,
    pub(super) surfaces: Vec<u32>,
}

/// A box a little larger: more than rounding, less than anything that costs.
pub(super) fn grown(bounds: &Aabb) -> Aabb {
    bounds.inflated(bounds.diagonal() * CellTree::CONTENT_MARGIN)
}

impl Volumes {
    /// Around boxes of objects, by rank; `spheres` or boxes.
    pub(super) fn new(bounds: &[Aabb], spheres: bool) -> Self {
        let volume = |bounds: &Aabb| {
            if bounds.is_empty() {
                return Volume::Nothing;
            }
            if !bounds.is_bounded() {
                return Volume::Everything;
            }
            let grown = grown(bounds);
            if spheres {
                Volume::Sphere {
                    center: grown.center(),
                    radius: 0.5 * grown.diagonal(),
                }
            } else {
                Volume::Box(grown)
            }
        };
        Self(bounds.iter().map(volume).collect())
    }
}

impl Volume {
    fn meets(&self, ray: &Ray, within: &Interval) -> bool {
        match self {
            Self::Everything => true,
            Self::Nothing => false,
            Self::Box(bounds) => !bounds.clip(ray).intersection(within).is_empty(),
            Self::Sphere { center, radius } => {
                let near = ray.at(ray
                    .closest_approach(*center)
                    .clamp(within.start, within.end));
                near.distance_squared(*center) <= radius * radius
            }
        }
    }
}

impl Solids {
    /// Visits one leaf: the objects whose volumes the line meets.
    #[expect(
        clippy::too_many_arguments,
        reason = "one hot function with its working memory"
    )]
    pub(super) fn visit_volumes(
        &self,
        volumes: &Volumes,
        line: &Line,
        span: Interval,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        visit: &mut impl FnMut(LeafVisit<'_>) -> f64,
    ) {
        let Some(leaf) = self.outer else { return };
        let whole = self.leaves.get(leaf);
        counters.cells += whole.objects.len() as u64;
        let LeafHits {
            mut objects,
            mut surfaces,
        } = std::mem::take(&mut scratch.leaf_hits);
        objects.clear();
        let met = |o: &&LeafObject| volumes.0[o.rank as usize].meets(&line.ray, &span);
        objects.extend(whole.objects.iter().filter(met));
        visit(LeafVisit {
            index: None,
            view: &whole.only(&objects, &mut surfaces, &self.faces),
            span,
            limit,
            scratch,
            counters,
        });
        scratch.leaf_hits = LeafHits { objects, surfaces };
    }
}
