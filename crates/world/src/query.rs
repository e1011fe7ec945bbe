//! What is asked and what is answered.

use octray_geometry::mesh::SearchCost;
use octray_geometry::{FaceId, MaterialId};
use octray_math::{DVec2, DVec3, Ray};
use octray_scene::ObjectId;
use octray_tree::WalkCost;

/// Which solid a point of space belongs to: an object, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Region(u32);

impl Region {
    /// Empty space.
    pub const OUTSIDE: Self = Self(u32::MAX);

    /// The inside of an object.
    #[must_use]
    pub const fn of(object: ObjectId) -> Self {
        Self(object.0)
    }

    /// The object, `None` outside.
    #[must_use]
    pub const fn object(self) -> Option<ObjectId> {
        match self.0 {
            u32::MAX => None,
            index => Some(ObjectId(index)),
        }
    }
}

/// The surface that a spawned ray starts on, and to which side it goes.
///
/// It replaces the usual offset by an epsilon: on that surface the crossing at the origin is
/// removed by rank, everything else counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Departure {
    /// [`FaceId::NONE`] for a ray that starts in the open.
    pub face: FaceId,
    /// As [`Hit::instance`].
    pub instance: u32,
    /// Whether the ray goes to the side that the face's outward normal points to. It must agree with the
    /// ray's direction: which crossing is removed is undefined where it does not, and may then be
    /// another one with the same sense, farther along the ray.
    pub outward: bool,
}

impl Departure {
    /// A ray that starts in the open.
    pub const NONE: Self = Self {
        face: FaceId::NONE,
        instance: 0,
        outward: true,
    };
}

/// A ray with the part of it that counts: `0 < t < t_max`, the departed surface left out at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayQuery {
    /// Any length of direction; `t` in units of it.
    pub ray: Ray,
    /// `inf` for the whole half-line.
    pub t_max: f64,
    /// Where it starts.
    pub departure: Departure,
}

impl RayQuery {
    /// The whole half-line from a point in the open.
    #[must_use]
    pub const fn new(ray: Ray) -> Self {
        Self {
            ray,
            t_max: f64::INFINITY,
            departure: Departure::NONE,
        }
    }
}

/// The nearest surface on a ray, or a miss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// In units of the ray's direction; `inf` for a miss.
    pub t: f64,
    /// [`FaceId::NONE`] for a miss.
    pub face: FaceId,
    /// Which copy the face is of, among all copies of the scene, from 1; 0 where the object is not
    /// made of instances. See [`crate::World::instance`].
    pub instance: u32,
    /// Whether the ray comes from the side that the face's outward normal points to.
    pub entering: bool,
    /// Where the ray is before the hit. (Where no material lets light through, sheets and copies do
    /// not look for the solids around them.)
    pub from: Region,
    /// Where it is behind. For a sheet the same as `from`.
    pub to: Region,
}

impl Hit {
    /// No surface.
    pub const MISS: Self = Self {
        t: f64::INFINITY,
        face: FaceId::NONE,
        instance: 0,
        entering: false,
        from: Region::OUTSIDE,
        to: Region::OUTSIDE,
    };

    /// Whether there is no surface.
    #[must_use]
    pub fn is_miss(&self) -> bool {
        self.face == FaceId::NONE
    }

    /// The departure of a ray that leaves this hit to the outward side (or to the other).
    #[must_use]
    pub const fn departure(&self, outward: bool) -> Departure {
        Departure {
            face: self.face,
            instance: self.instance,
            outward,
        }
    }
}

/// Everything shading wants to know of a hit, computed only when it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// `origin + t * direction` of the original ray.
    pub position: DVec3,
    /// Unit normal, pointing out of the solid (out of the front of a sheet), whatever side the
    /// ray comes from; of a subtracted operand, out of the resulting solid.
    pub normal: DVec3,
    /// Unit normal for shading; the interpolated one of a smooth mesh, never on the other side of
    /// the surface than `normal`.
    pub shading_normal: DVec3,
    /// Texture coordinates, where the mesh has them.
    pub texcoord: Option<DVec2>,
    /// Whose surface.
    pub object: ObjectId,
    /// Material of the face.
    pub material: MaterialId,
    /// Whether the ray comes from the side `normal` points to.
    pub entering: bool,
    /// Index of refraction on the side the ray comes from.
    pub ior_from: f64,
    /// Index of refraction behind the surface. For a transparent sheet: as if its front bounded a
    /// solid.
    pub ior_to: f64,
    /// The material that fills the space the ray has just passed, `None` for empty space.
    pub medium: Option<MaterialId>,
}

/// What the queries cost. Sums do not depend on the order in which rays are traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays asked for.
    pub rays: u64,
    /// Cells of octrees and grids entered, and bounding volumes tested.
    pub cells: u64,
    /// Rows of a hash table and nodes of a tree looked at to find cells.
    pub lookups: u64,
    /// Nodes of the triangles' octree entered.
    pub nodes: u64,
    /// Surfaces of solids intersected with a line.
    pub surface_tests: u64,
    /// Triangles intersected with a line.
    pub triangle_tests: u64,
    /// Triangles not intersected again, because the ray had met them in an earlier cell.
    pub mailbox: u64,
    /// Copies of prototypes that a line was taken into.
    pub instances: u64,
}

impl Counters {
    pub(crate) fn add_walk(&mut self, cost: &WalkCost) {
        self.nodes += cost.nodes;
        self.triangle_tests += cost.items;
    }

    pub(crate) fn add_search(&mut self, cost: &SearchCost) {
        self.add_walk(&cost.walk);
        self.cells += cost.steps.cells;
        self.lookups += cost.steps.lookups;
        self.mailbox += cost.mailbox;
    }

    /// The walk over the boxes of copies.
    pub(crate) fn add_instances(&mut self, cost: &WalkCost) {
        self.nodes += cost.nodes;
        self.instances += cost.items;
    }

    /// The part of one of so many: together they are the whole.
    pub(crate) fn share(&self, index: usize, of: usize) -> Self {
        let (index, of) = (index as u64, of as u64);
        let part = |count: u64| count / of + u64::from(index < count % of);
        Self {
            rays: part(self.rays),
            cells: part(self.cells),
            lookups: part(self.lookups),
            mailbox: part(self.mailbox),
            nodes: part(self.nodes),
            surface_tests: part(self.surface_tests),
            triangle_tests: part(self.triangle_tests),
            instances: part(self.instances),
        }
    }
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.cells += other.cells;
        self.lookups += other.lookups;
        self.nodes += other.nodes;
        self.surface_tests += other.surface_tests;
        self.triangle_tests += other.triangle_tests;
        self.mailbox += other.mailbox;
        self.instances += other.instances;
    }
}
