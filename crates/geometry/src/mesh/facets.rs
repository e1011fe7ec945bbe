//! Triangles that lie in planes of other operands.

use octray_math::{Aabb, Ray};

use super::TriangleHit;
use crate::surface::Surface;

/// For each triangle of a mesh operand the plane that it shares with other operands, if any.
///
/// The parameter at which a line crosses a triangle comes from its corners, that of a plane from
/// its normal: they agree but for the last bits, and so two faces that coincide would be crossed one
/// after the other. On a shared plane the plane's parameter counts. Whether the triangle is crossed
/// at all remains the matter of its edges.
#[derive(Clone, Debug, Default)]
pub struct FacetPlanes {
    /// All of the kind [`Surface::Plane`].
    planes: Vec<Surface>,
    /// One more than the index of each triangle's plane, 0 for none.
    of_triangle: Vec<u32>,
    /// How far outside of the triangle's box the crossing may lie.
    slack: f64,
}

impl FacetPlanes {
    /// `of_triangle` holds one more than the index of each triangle's plane, 0 for none.
    pub(crate) fn new(planes: Vec<Surface>, of_triangle: Vec<u32>, slack: f64) -> Self {
        Self {
            planes,
            of_triangle,
            slack,
        }
    }

    /// How many planes are shared.
    #[must_use]
    pub fn len(&self) -> usize {
        self.planes.len()
    }

    /// Whether no triangle lies in a shared plane.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.planes.is_empty()
    }

    /// Where the line crosses the triangle: on its shared plane, where it has one.
    ///
    /// A line that runs nearly in the plane may meet it far away; it is taken for crossing the
    /// triangle where its corners say.
    pub(super) fn parameter(
        &self,
        ray: &Ray,
        triangle: u32,
        hit: &TriangleHit,
        bounds: impl FnOnce() -> Aabb,
    ) -> f64 {
        let plane = match self.of_triangle.get(triangle as usize) {
            None | Some(0) => return hit.t,
            Some(&next) => &self.planes[next as usize - 1],
        };
        let mut t = hit.t;
        plane.crossings(ray, |at| t = at);
        let near = bounds().inflated(self.slack);
        if near.contains(ray.at(t)) { t } else { hit.t }
    }
}
