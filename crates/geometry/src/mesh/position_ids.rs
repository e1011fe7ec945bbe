//! Vertices at one position are one vertex.

use octray_math::DVec3;

use super::TriangleMesh;

impl TriangleMesh {
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
