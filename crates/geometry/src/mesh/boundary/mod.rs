//! Is a mesh the boundary of a solid, and if not, what is wrong where?
//!
//! A mesh has a *winding number* at every point beside it if its directed edges cancel: the number
//! of times it runs round the point. It bounds a solid in the strict sense if, besides,
//!
//! * every edge has two triangles,
//! * the winding number is 0 or 1 everywhere: 0 outside, 1 inside.
//!
//! Where two triangles cross, or lie upon one another facing the same way, the winding number takes
//! three values, so one of them is neither. Where a shell faces the wrong way it is negative, and
//! where one stands in another of the same sense it is 2. Touching is allowed: a vertex that stands
//! on a face, or two shells whose faces meet from opposite sides, change no winding number.
//! Neighbours that are folded onto each other do not either, but they enclose nothing and are
//! refused.
//!
//! All decisions are exact for the coordinates as they are, after those smaller than 2^-600 of the
//! largest have been taken for 0.

mod contact;
mod edges;
mod exact_mesh;
mod pairs;
mod report;
mod shells;

pub use report::{Flaw, FlawKind, MeshReport};

use super::{MeshError, TriangleMesh};
use exact_mesh::ExactMesh;

/// What is asked of a mesh that is to be a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshRule {
    /// It must be the boundary of a solid without any doubt: see [`TriangleMesh::check`].
    #[default]
    Strict,
    /// Inside is where the winding number is not 0, whatever crosses or overlaps and however the
    /// mesh is turned. It must have a winding number: every directed edge has its reverse.
    Winding,
}

impl TriangleMesh {
    /// What keeps the mesh from being the boundary of a solid: nothing, or the first places of each
    /// kind and how many there are.
    ///
    /// Vertices at equal positions count as one, so a soup read from STL may be closed. Triangles
    /// that name one position twice have no area and are passed over.
    #[must_use]
    pub fn check(&self) -> MeshReport {
        let mut report = MeshReport::new(self.triangles().len());
        let ids = self.position_ids();
        let edges = edges::check(self, &ids, &mut report);
        let exact = ExactMesh::new(self, &ids);
        let contacts = pairs::check(&exact, &mut report);
        if report.is_closed() && report.count(FlawKind::Unchecked) == 0 {
            shells::check(&exact, &edges, &contacts, &mut report);
            let crossings = report.count(FlawKind::Crossing) + report.count(FlawKind::Overlap);
            if crossings > 0 && report.count(FlawKind::InsideOut) == 0 && self.is_inside_out() {
                report.add(Flaw {
                    kind: FlawKind::InsideOut,
                    places: self.used_positions().take(1).collect(),
                    triangles: vec![0],
                    extent: self.triangles().len(),
                });
            }
        }
        report
    }

    /// Checks that the mesh has a winding number: every directed edge is matched by its reverse.
    ///
    /// # Errors
    /// [`MeshError::Empty`] or [`MeshError::NoInside`].
    pub fn check_closed(&self) -> Result<(), MeshError> {
        if self.triangles().is_empty() {
            return Err(MeshError::Empty);
        }
        let mut report = MeshReport::new(self.triangles().len());
        edges::check(self, &self.position_ids(), &mut report);
        if report.is_closed() {
            Ok(())
        } else {
            Err(MeshError::NoInside(Box::new(report)))
        }
    }

    /// Checks that the mesh can be a solid under `rule`.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::NoInside`] or [`MeshError::NotASolid`].
    pub fn check_solid(&self, rule: MeshRule) -> Result<(), MeshError> {
        match rule {
            MeshRule::Winding => self.check_closed(),
            MeshRule::Strict if self.triangles().is_empty() => Err(MeshError::Empty),
            MeshRule::Strict => {
                let report = self.check();
                if report.is_sound() {
                    Ok(())
                } else {
                    Err(MeshError::NotASolid(Box::new(report)))
                }
            }
        }
    }
}
