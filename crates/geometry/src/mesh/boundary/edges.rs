//! Do the directed edges cancel?

use super::report::{Flaw, FlawKind, MeshReport};
use crate::mesh::TriangleMesh;

/// One use of an edge: its ends in ascending order, the triangle, and whether it runs upwards.
type Use = (u32, u32, u32, bool);

/// Pairs of triangles that share an edge with each other and with nobody else.
pub(super) struct Neighbours(pub(super) Vec<[u32; 2]>);

/// Reports every edge that has not exactly two triangles in opposite directions.
pub(super) fn check(mesh: &TriangleMesh, ids: &[u32], report: &mut MeshReport) -> Neighbours {
    let mut uses: Vec<Use> = Vec::with_capacity(3 * mesh.triangles().len());
    for (triangle, corners) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = corners.map(|i| ids[i as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            uses.push((from.min(to), from.max(to), triangle as u32, from < to));
        }
    }
    uses.sort_unstable();
    let mut neighbours = Vec::with_capacity(uses.len() / 2);
    for edge in uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let upwards = edge.iter().filter(|u| u.3).count();
        let kind = match (edge.len(), 2 * upwards == edge.len()) {
            (2, true) => {
                neighbours.push([edge[0].2, edge[1].2]);
                continue;
            }
            (1, _) => FlawKind::OpenEdge,
            (2, false) => FlawKind::MisorientedEdge,
            (_, false) => FlawKind::UnbalancedEdge,
            (_, true) => FlawKind::CrowdedEdge,
        };
        let (low, high, _, up) = edge[0];
        let ends = if up { [low, high] } else { [high, low] };
        report.add(Flaw {
            kind,
            places: ends.map(|i| mesh.positions()[i as usize]).to_vec(),
            triangles: edge.iter().take(5).map(|u| u.2).collect(),
            extent: edge.len(),
        });
    }
    Neighbours(neighbours)
}
