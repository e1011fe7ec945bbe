//! Is a mesh the boundary of a solid?

use octray_math::DVec3;

use super::{MeshError, TriangleMesh};

impl TriangleMesh {
    /// Checks that the mesh bounds a solid: every directed edge is matched by its reverse.
    ///
    /// Vertices at equal positions count as one, so a soup read from STL may be closed. Triangles
    /// that name one position twice have no area and are passed over.
    ///
    /// # Errors
    /// [`MeshError::Empty`] or [`MeshError::Open`] with the first unmatched edge.
    pub fn check_closed(&self) -> Result<(), MeshError> {
        if self.triangles().is_empty() {
            return Err(MeshError::Empty);
        }
        let ids = self.position_ids();
        let mut edges: Vec<(u32, u32, i32)> = Vec::with_capacity(3 * self.triangles().len());
        for corners in self.triangles() {
            let [a, b, c] = corners.map(|i| ids[i as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges.push(if from < to {
                    (from, to, 1)
                } else {
                    (to, from, -1)
                });
            }
        }
        edges.sort_unstable();
        let mut count = 0;
        let mut first = None;
        for run in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let balance: i32 = run.iter().map(|e| e.2).sum();
            if balance != 0 {
                count += balance.unsigned_abs() as usize;
                let ends = if balance > 0 {
                    (run[0].0, run[0].1)
                } else {
                    (run[0].1, run[0].0)
                };
                first.get_or_insert(ends);
            }
        }
        match first {
            None => Ok(()),
            Some((from, to)) => {
                let [from, to] = [from, to].map(|i| self.positions()[i as usize]);
                Err(MeshError::Open { count, from, to })
            }
        }
    }

    /// For every vertex the lowest vertex at the same position (-0 and 0 are the same).
    #[must_use]
    pub fn position_ids(&self) -> Vec<u32> {
        let key = |i: u32| {
            let p = self.positions()[i as usize] + DVec3::ZERO;
            (p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), i)
        };
        let mut order: Vec<u32> = (0..self.positions().len() as u32).collect();
        order.sort_unstable_by_key(|&i| key(i));
        let mut ids = vec![0; order.len()];
        for run in order.chunk_by(|&a, &b| {
            let (a, b) = (key(a), key(b));
            (a.0, a.1, a.2) == (b.0, b.1, b.2)
        }) {
            for &i in run {
                ids[i as usize] = run[0];
            }
        }
        ids
    }
}
