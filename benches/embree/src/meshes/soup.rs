//! Triangles put together piece by piece.

use std::f64::consts::TAU;

use octray::math::{DMat3, DVec3};

/// Triangles over shared corners, to which pieces are added.
#[derive(Clone, Debug, Default)]
pub struct Soup {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// A lattice of corners, `rows` of `columns`; with `closed` the last column is joined to the first.
    /// Squares become two triangles each.
    pub fn lattice(
        &mut self,
        (rows, columns): (usize, usize),
        closed: bool,
        at: impl Fn(usize, usize) -> DVec3,
    ) {
        let first = self.positions.len() as u32;
        let corner = |i: usize, j: usize| first + (i * columns + j % columns) as u32;
        self.positions.extend(
            (0..rows)
                .flat_map(|i| (0..columns).map(move |j| (i, j)))
                .map(|(i, j)| at(i, j)),
        );
        for i in 0..rows - 1 {
            for j in 0..if closed { columns } else { columns - 1 } {
                let (a, b) = (corner(i, j), corner(i, j + 1));
                let (c, d) = (corner(i + 1, j), corner(i + 1, j + 1));
                self.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
    }

    /// A box from corner to corner, two triangles to a side however long it is.
    pub fn block(&mut self, min: DVec3, max: DVec3) {
        let corner = |k: usize| {
            let [x, y, z] = [k & 1, k >> 1 & 1, k >> 2].map(|bit| bit as f64);
            min + (max - min) * DVec3::new(x, y, z)
        };
        const SIDES: [[usize; 4]; 6] = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let first = self.positions.len() as u32;
        self.positions.extend((0..8).map(corner));
        for side in SIDES {
            let [a, b, c, d] = side.map(|k| first + k as u32);
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// A body of revolution about the vertical through `foot`: `profile` lists radii and heights,
    /// from below; `shape` changes the radius by the angle.
    pub fn lathe(
        &mut self,
        foot: DVec3,
        profile: &[[f64; 2]],
        sectors: usize,
        shape: impl Fn(f64, f64) -> f64,
    ) {
        self.lattice((profile.len(), sectors), true, |i, j| {
            let angle = TAU * j as f64 / sectors as f64;
            let [radius, height] = profile[i];
            let radius = radius * shape(angle, height);
            foot + DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
        });
    }

    /// A sphere of `20 * 4^level` triangles.
    pub fn sphere(&mut self, center: DVec3, radius: f64, (corners, triangles): &Sphere) {
        let first = self.positions.len() as u32;
        self.positions
            .extend(corners.iter().map(|&p| center + p * radius));
        self.triangles
            .extend(triangles.iter().map(|t| t.map(|i| first + i)));
    }

    /// The corners rotated and rounded, and the triangles.
    pub fn finish(self, turn: &DMat3) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let rounded = |p: &DVec3| (*turn * *p).to_array().map(|x| x as f32);
        (self.positions.iter().map(rounded).collect(), self.triangles)
    }
}

/// Corners of a unit sphere and its triangles.
pub type Sphere = (Vec<DVec3>, Vec<[u32; 3]>);

/// An icosahedron whose triangles are halved edge by edge, `level` times.
pub fn sphere(level: usize) -> Sphere {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut corners = Vec::new();
    for (a, b) in [
        (-1.0, -golden),
        (1.0, -golden),
        (-1.0, golden),
        (1.0, golden),
    ] {
        corners.extend([
            DVec3::new(0.0, a, b),
            DVec3::new(a, b, 0.0),
            DVec3::new(b, 0.0, a),
        ]);
    }
    for corner in &mut corners {
        *corner = corner.normalize();
    }
    // Neighbours of an icosahedron's corner are the five nearest; triangles are triples of them.
    let near = |a: usize, b: usize| corners[a].dot(corners[b]) > 0.4;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in (a + 1..12).filter(|&b| near(a, b)) {
            for c in (b + 1..12).filter(|&c| near(a, c) && near(b, c)) {
                let outward = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
                let turned = outward.dot(corners[a]) < 0.0;
                let (b, c) = if turned { (c, b) } else { (b, c) };
                triangles.push([a, b, c].map(|i| i as u32));
            }
        }
    }
    for _ in 0..level {
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(a, b): (u32, u32)| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum = corners[a as usize] + corners[b as usize];
                    corners.push(sum.normalize());
                    corners.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    (corners, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_closed_and_has_its_area() {
        let (corners, triangles) = sphere(3);
        assert_eq!(triangles.len(), 20 * 64);
        assert_eq!(corners.len(), 2 + 10 * 64);
        let mut edges = std::collections::BTreeSet::new();
        let mut area = 0.0;
        for [a, b, c] in triangles {
            assert!(
                [(a, b), (b, c), (c, a)]
                    .into_iter()
                    .all(|edge| edges.insert(edge))
            );
            let [a, b, c] = [a, b, c].map(|i| corners[i as usize]);
            area += (b - a).cross(c - a).length() / 2.0;
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        assert!((0.99..1.0).contains(&(area / (2.0 * TAU))));
    }
}
