//! A closed mesh as an operand of set operations.

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3, Interval, Ray};
use octray_tree::{WalkCost, WideTreeConfig};

use super::{
    FacetPlanes, MeshCrossing, MeshError, Placement, SearchCost, SearchMemory, TriangleHit,
    TriangleMesh, TrianglePoint, TriangleSearch, TriangleTree,
};
use crate::MaterialId;
use crate::surface::Side;

/// A closed mesh in world coordinates.
///
/// A point is inside where its winding number is not zero. For an ordinary mesh that is what one
/// expects; shells that overlap are united, a shell that faces inwards within another is a cavity,
/// and a mesh that is inside out has the same inside as its reverse.
#[derive(Clone, Debug)]
pub struct MeshSolid {
    mesh: Arc<TriangleMesh>,
    placement: Placement,
    triangles: TriangleTree,
    planes: FacetPlanes,
}

impl MeshSolid {
    /// Places a mesh, with an octree over its triangles if there is a configuration.
    ///
    /// # Errors
    /// The mesh is not closed, or the octree would be too large.
    pub fn new(
        mesh: &Arc<TriangleMesh>,
        world_from_mesh: &DAffine3,
        config: Option<&WideTreeConfig>,
    ) -> Result<Self, MeshError> {
        mesh.check_closed()?;
        let placement = Placement::new(world_from_mesh);
        let positions = placement.positions(mesh).collect();
        let wound = mesh.triangles().iter().map(|&t| placement.wound(t));
        let search = config.map_or(TriangleSearch::All, |c| TriangleSearch::Wide(*c));
        let triangles = TriangleTree::new(positions, wound.collect(), &[0], &search)?;
        Ok(Self {
            mesh: Arc::clone(mesh),
            placement,
            triangles,
            planes: FacetPlanes::default(),
        })
    }

    /// The same with triangles in planes that they share with other operands.
    #[must_use]
    pub fn with_planes(mut self, planes: FacetPlanes) -> Self {
        self.planes = planes;
        self
    }

    /// How many triangles it has.
    #[must_use]
    pub fn triangle_count(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// The triangles in world coordinates.
    #[must_use]
    pub const fn triangles(&self) -> &TriangleTree {
        &self.triangles
    }

    /// The material of one triangle, where the mesh has materials.
    #[must_use]
    pub fn material(&self, triangle: u32) -> Option<MaterialId> {
        self.mesh.materials().map(|all| all[triangle as usize])
    }

    /// Appends the changes between outside and inside along the whole line: sorted, entering and
    /// leaving in turn, as many of one as of the other.
    ///
    /// Of the triangles that the line crosses at one `t` only the change counts that they make
    /// together; the lowest of those that face accordingly stands for them.
    pub fn crossings(&self, ray: &Ray, out: &mut Vec<MeshCrossing>, cost: &mut WalkCost) {
        let start = out.len();
        self.for_all(ray, Interval::ALL, cost, |triangle, hit| {
            let bounds = || self.triangles.bounds(triangle);
            out.push(MeshCrossing {
                t: self.planes.parameter(ray, triangle, hit, bounds),
                triangle,
                entering: hit.entering,
            });
        });
        out[start..].sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        let (mut read, mut kept, mut winding) = (start, start, 0i64);
        while read < out.len() {
            let first = out[read];
            let group = out[read..]
                .iter()
                .take_while(|c| c.t == first.t)
                .count()
                .max(1);
            let members = &out[read..read + group];
            let entries = members.iter().filter(|c| c.entering).count() as i64;
            let change = 2 * entries - group as i64;
            let was_inside = winding != 0;
            winding += change;
            let is_inside = winding != 0;
            read += group;
            if was_inside != is_inside {
                let facing = members.iter().find(|c| c.entering == (change > 0));
                out[kept] = MeshCrossing {
                    entering: is_inside,
                    ..*facing.unwrap_or(&first)
                };
                kept += 1;
            }
        }
        out.truncate(kept);
    }

    /// Whether a point is inside. On the boundary itself, either.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let mut winding = 0i64;
        let behind = Interval::new(f64::NEG_INFINITY, 0.0);
        let mut cost = WalkCost::default();
        self.for_all(&Ray::new(point, DVec3::X), behind, &mut cost, |_, hit| {
            winding += if hit.entering { 1 } else { -1 };
        });
        winding != 0
    }

    /// Every triangle that the line crosses in `span`.
    #[inline]
    fn for_all(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut WalkCost,
        visit: impl FnMut(u32, &TriangleHit),
    ) {
        // Only cells need memory.
        let (mut memory, mut all) = (SearchMemory::default(), SearchCost::default());
        self.triangles.all(ray, span, &mut memory, &mut all, visit);
        *cost += all.walk;
    }

    /// On which side of the boundary a box lies; the inside is negative.
    #[must_use]
    pub fn classify(&self, bounds: &Aabb) -> Side {
        if self.triangles.overlaps(bounds) {
            Side::Both
        } else if self.contains(bounds.center()) {
            Side::Negative
        } else {
            Side::Positive
        }
    }

    /// Normals where the line crosses one of the triangles, turned against the line if it enters
    /// there: a triangle that is wound the wrong way has them turned round.
    #[must_use]
    pub fn point(&self, ray: &Ray, triangle: u32, entering: bool) -> Option<TrianglePoint> {
        let (point, from_front) = self.placement.point(&self.mesh, triangle, ray)?;
        Some(if from_front == entering {
            point
        } else {
            point.flipped()
        })
    }
}
