//! Planes that are found by the triangles that lie in them.
//!
//! A triangle lies in a plane if all its corners are as close to it as surfaces must be to count as
//! one. Candidates are found by the triangle's own plane, which is as uncertain as the triangle is
//! thin: so every plane is hashed with several widths of cells, and of each only so many as can be
//! looked through. A triangle thinner than about 2^-28 of the scene finds no plane.

use std::collections::HashMap;

use octray_math::DVec3;

/// Widths of cells, of unit normals and of offsets in units of the scene's size.
const WIDTHS: [f64; 3] = [
    1.0 / (1u64 << 8) as f64,
    1.0 / (1u64 << 14) as f64,
    1.0 / (1u64 << 20) as f64,
];
/// So many planes are kept in a cell.
const CROWD: usize = 256;
/// Planes that can be found by others like them.
pub(super) struct PlaneIndex {
    scale: f64,
    tolerance: f64,
    pub(super) planes: Vec<(DVec3, f64)>,
    cells: HashMap<(usize, [i64; 4]), Vec<u32>>,
}

/// A triangle of a mesh.
pub(super) struct Facet {
    pub(super) corners: [DVec3; 3],
    pub(super) normal: DVec3,
    pub(super) offset: f64,
    pub(super) area: f64,
    /// Over the longest edge.
    height: f64,
}

impl Facet {
    /// `None` without area.
    pub(super) fn new(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let size = u.abs().max(v.abs()).max_element();
        let cross = (u / size).cross(v / size);
        let normal = cross.try_normalize()?;
        let area = cross.length() * size * size;
        let longest = u.length().max(v.length()).max((c - b).length());
        Some(Self {
            corners,
            normal,
            offset: normal.dot(a),
            area,
            height: area / longest,
        })
    }
}

impl PlaneIndex {
    pub(super) fn new(scene_size: f64, tolerance: f64) -> Self {
        Self {
            scale: 1.0 / scene_size,
            tolerance,
            planes: Vec::new(),
            cells: HashMap::new(),
        }
    }

    pub(super) fn insert(&mut self, normal: DVec3, offset: f64) -> u32 {
        let id = self.planes.len() as u32;
        self.planes.push((normal, offset));
        let at = [normal.x, normal.y, normal.z, offset * self.scale];
        for (level, width) in WIDTHS.into_iter().enumerate() {
            let home = at.map(|x| libm::floor(x / width) as i64);
            let cell = self.cells.entry((level, home)).or_default();
            if cell.len() < CROWD {
                cell.push(id);
            }
        }
        id
    }

    /// The first plane that holds all corners.
    pub(super) fn find(&self, facet: &Facet) -> Option<u32> {
        // Corners off by the tolerance tilt the plane about the longest edge.
        let tilt = 4.0 * self.tolerance / facet.height;
        // Positions are at most sqrt(3) from the origin.
        let reaches = [tilt, tilt, tilt, 2.0 * tilt];
        let level = WIDTHS.iter().rposition(|width| 4.0 * tilt <= *width)?;
        let holds = |&id: &u32| {
            let (normal, offset) = self.planes[id as usize];
            let off = |p: DVec3| (normal.dot(p) - offset).abs();
            facet.corners.into_iter().all(|p| off(p) <= self.tolerance)
        };
        let mut found: Option<u32> = None;
        for side in [1.0, -1.0] {
            let normal = facet.normal * side;
            let offset = facet.offset * side * self.scale;
            let at = [normal.x, normal.y, normal.z, offset];
            let ends: [[i64; 2]; 4] = std::array::from_fn(|i| {
                [at[i] - reaches[i], at[i] + reaches[i]]
                    .map(|x| libm::floor(x / WIDTHS[level]) as i64)
            });
            for which in 0..16 {
                let bit = |i: usize| which >> i & 1;
                // Nearly always both ends lie in one cell.
                if (0..4).any(|i| bit(i) == 1 && ends[i][0] == ends[i][1]) {
                    continue;
                }
                let cell = std::array::from_fn(|i| ends[i][bit(i)]);
                let here = self.cells.get(&(level, cell)).into_iter().flatten();
                let first = here.copied().find(|id| holds(id));
                found = match (found, first) {
                    (Some(a), Some(b)) => Some(a.min(b)),
                    (a, b) => a.or(b),
                };
            }
        }
        found
    }
}
