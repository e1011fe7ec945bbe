//! Do triangles cross?

use octray_math::DVec3;

use super::contact::{Contact, contact};
use super::exact_mesh::ExactMesh;
use super::report::{Flaw, FlawKind, MeshReport};

/// What is known of triangles that meet beyond their common corners and edges.
#[derive(Default)]
pub(super) struct Contacts {
    /// Triangles in crossings and overlaps, increasing.
    pub(super) crossed: Vec<u32>,
    /// Pairs that touch, with a common point.
    pub(super) touching: Vec<([u32; 2], DVec3)>,
}

/// So many pairs are looked at, and this many more for every triangle: those of ordinary meshes
/// are about ten per triangle.
const PAIRS: u64 = 2_000_000;
const PAIRS_PER_TRIANGLE: u64 = 40;
/// When so many crossings and overlaps have been found the search is over.
const ENOUGH: usize = 10_000;

/// Reports crossings, overlaps and folds.
pub(super) fn check(mesh: &ExactMesh, report: &mut MeshReport) -> Contacts {
    let budget = PAIRS + PAIRS_PER_TRIANGLE * u64::from(mesh.len());
    let mut looked_at = 0;
    let mut contacts = Contacts::default();
    let mut others = Vec::new();
    for triangle in 0..mesh.len() {
        others.clear();
        mesh.later_neighbours(triangle, |other| others.push(other));
        looked_at += others.len() as u64;
        let found = report.count(FlawKind::Crossing) + report.count(FlawKind::Overlap);
        if looked_at > budget || found > ENOUGH {
            report.add(Flaw {
                kind: FlawKind::Unchecked,
                places: vec![mesh.unscaled(mesh.corners(triangle)[0])],
                triangles: vec![mesh.source(triangle)],
                extent: others.len() + 1,
            });
            break;
        }
        others.sort_unstable();
        let (ids, corners) = (mesh.ids(triangle), mesh.corners(triangle));
        for &other in &others {
            let other_ids = mesh.ids(other);
            let shared = ids.map(|id| other_ids.iter().position(|&o| o == id));
            let (kind, place) = match contact(corners, mesh.corners(other), shared) {
                Contact::Apart => continue,
                Contact::Touching(place) => {
                    contacts.touching.push(([triangle, other], place));
                    continue;
                }
                Contact::Crossing(place) => (FlawKind::Crossing, place),
                Contact::Overlapping(place) => (FlawKind::Overlap, place),
                Contact::Folded(place) => (FlawKind::Fold, place),
            };
            if kind != FlawKind::Fold {
                contacts.crossed.extend([triangle, other]);
            }
            report.add(Flaw {
                kind,
                places: vec![mesh.unscaled(place)],
                triangles: vec![mesh.source(triangle), mesh.source(other)],
                extent: 2,
            });
        }
    }
    contacts.crossed.sort_unstable();
    contacts.crossed.dedup();
    contacts
}
