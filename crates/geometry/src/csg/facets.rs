//! Finds the planes that triangles of mesh operands share with other operands.
//!
//! A triangle lies in a plane if all its corners are as close to it as surfaces must be to count as
//! one. Candidates are found by the triangle's own plane, coarsely: its normal is inaccurate for a
//! thin triangle, so cells are wide and only the corners decide. (A triangle thinner than about
//! 2^-30 of the scene is not recognised.)

use std::collections::HashMap;

use octray_math::DVec3;

use super::lower::MeshOperand;
use crate::mesh::{FacetPlanes, Placement};
use crate::surface::Surface;

/// Width of a cell, of unit normals and of offsets in units of the scene's size.
const NORMAL_CELL: f64 = 1.0 / 256.0;
const OFFSET_CELL: f64 = 1.0 / 16384.0;
/// Inaccuracy of a triangle's plane that is looked for: 2^-18, of normals and offsets alike.
const INACCURACY: f64 = 1.0 / 262_144.0;
/// A crossing may lie outside of its triangle by this much, in units of the scene's size.
const SLACK: f64 = 1.0 / (1u64 << 26) as f64;

/// Planes that can be found by others like them.
struct PlaneIndex {
    scale: f64,
    tolerance: f64,
    planes: Vec<(DVec3, f64)>,
    cells: HashMap<[i32; 4], Vec<u32>>,
}

/// A triangle of a mesh.
struct Facet {
    corners: [DVec3; 3],
    normal: DVec3,
    offset: f64,
    area: f64,
}

impl Facet {
    /// `None` without area.
    fn new(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let size = u.abs().max(v.abs()).max_element();
        let cross = (u / size).cross(v / size);
        let normal = cross.try_normalize()?;
        Some(Self {
            corners,
            normal,
            offset: normal.dot(a),
            area: cross.length() * size * size,
        })
    }
}

impl PlaneIndex {
    fn new(scene_size: f64, tolerance: f64) -> Self {
        Self {
            scale: 1.0 / scene_size,
            tolerance,
            planes: Vec::new(),
            cells: HashMap::new(),
        }
    }

    fn insert(&mut self, normal: DVec3, offset: f64) -> u32 {
        let id = self.planes.len() as u32;
        self.planes.push((normal, offset));
        let home = self
            .coordinates(normal, offset)
            .map(|x| libm::floor(x) as i32);
        self.cells.entry(home).or_default().push(id);
        id
    }

    /// In units of cells.
    fn coordinates(&self, normal: DVec3, offset: f64) -> [f64; 4] {
        let n = normal / NORMAL_CELL;
        [n.x, n.y, n.z, offset * self.scale / OFFSET_CELL]
    }

    /// The first plane that holds all corners.
    fn find(&self, facet: &Facet) -> Option<u32> {
        let holds = |&id: &u32| {
            let (normal, offset) = self.planes[id as usize];
            let off = |p: DVec3| (normal.dot(p) - offset).abs();
            facet.corners.into_iter().all(|p| off(p) <= self.tolerance)
        };
        let mut found: Option<u32> = None;
        for side in [1.0, -1.0] {
            let at = self.coordinates(facet.normal * side, facet.offset * side);
            let width = [NORMAL_CELL, NORMAL_CELL, NORMAL_CELL, OFFSET_CELL];
            let ends: [[i32; 2]; 4] = std::array::from_fn(|i| {
                let reach = INACCURACY / width[i];
                [at[i] - reach, at[i] + reach].map(|x| libm::floor(x) as i32)
            });
            for which in 0..16 {
                let bit = |i: usize| which >> i & 1;
                // Nearly always both ends lie in one cell.
                if (0..4).any(|i| bit(i) == 1 && ends[i][0] == ends[i][1]) {
                    continue;
                }
                let cell = std::array::from_fn(|i| ends[i][bit(i)]);
                let here = self.cells.get(&cell).into_iter().flatten();
                let first = here.copied().filter(|id| holds(id)).min();
                found = match (found, first) {
                    (Some(a), Some(b)) => Some(a.min(b)),
                    (a, b) => a.or(b),
                };
            }
        }
        found
    }
}

/// Sets the facet planes of the meshes: planes among `surfaces` first, then those of larger
/// triangles of other meshes. `tolerance` is a length.
pub(super) fn share_planes(
    surfaces: &[Surface],
    meshes: &mut [MeshOperand],
    scene_size: f64,
    tolerance: f64,
) {
    let mut index = PlaneIndex::new(scene_size, tolerance);
    for surface in surfaces {
        if let Surface::Plane { normal, offset } = surface {
            index.insert(*normal, *offset);
        }
    }
    let exact = index.planes.len() as u32;
    if meshes.is_empty() || (exact == 0 && meshes.len() == 1) {
        return;
    }
    let facets: Vec<Vec<Option<Facet>>> = meshes.iter().map(facets_of).collect();
    let mut plane_of: Vec<Vec<u32>> = Vec::with_capacity(meshes.len());
    let mut rest: Vec<(usize, usize)> = Vec::new();
    for (mesh, facets) in facets.iter().enumerate() {
        let find = |(triangle, facet): (usize, &Option<Facet>)| {
            let facet = facet.as_ref()?;
            let found = index.find(facet);
            if found.is_none() && meshes.len() > 1 {
                rest.push((mesh, triangle));
            }
            found
        };
        let found = facets.iter().enumerate().map(find);
        plane_of.push(found.map(|id| id.map_or(0, |id| id + 1)).collect());
    }
    // The planes of large triangles are the most accurate.
    let facet = |(mesh, triangle): (usize, usize)| facets[mesh][triangle].as_ref();
    let area = |at: &(usize, usize)| facet(*at).map_or(0.0, |f| f.area);
    rest.sort_by(|a, b| area(b).total_cmp(&area(a)).then(a.cmp(b)));
    // Which mesh uses a plane, and whether another does too.
    let mut users: Vec<(usize, bool)> = Vec::new();
    for &(mesh, triangle) in &rest {
        let Some(facet) = facet((mesh, triangle)) else {
            continue;
        };
        let id = match index.find(facet) {
            Some(id) => id,
            None => index.insert(facet.normal, facet.offset),
        };
        plane_of[mesh][triangle] = id + 1;
        let user = (id - exact) as usize;
        match users.get_mut(user) {
            Some((first, shared)) => *shared |= *first != mesh,
            None => users.push((mesh, false)),
        }
    }
    let is_shared = |id: u32| id < exact || users[(id - exact) as usize].1;
    for (operand, planes) in meshes.iter_mut().zip(plane_of) {
        operand.planes = used_planes(&index, planes, is_shared, scene_size * SLACK);
    }
}

/// Keeps the planes that are shared, numbered anew.
fn used_planes(
    index: &PlaneIndex,
    mut of_triangle: Vec<u32>,
    is_shared: impl Fn(u32) -> bool,
    slack: f64,
) -> FacetPlanes {
    let mut used: Vec<u32> = of_triangle
        .iter()
        .filter_map(|next| next.checked_sub(1))
        .collect();
    used.sort_unstable();
    used.dedup();
    used.retain(|&id| is_shared(id));
    for next in &mut of_triangle {
        let place = next
            .checked_sub(1)
            .and_then(|id| used.binary_search(&id).ok());
        *next = place.map_or(0, |place| place as u32 + 1);
    }
    let plane = |&id: &u32| {
        let (normal, offset) = index.planes[id as usize];
        Surface::Plane { normal, offset }
    };
    if used.is_empty() {
        return FacetPlanes::default();
    }
    FacetPlanes::new(used.iter().map(plane).collect(), of_triangle, slack)
}

fn facets_of(operand: &MeshOperand) -> Vec<Option<Facet>> {
    let placement = Placement::new(&operand.scene_from_mesh);
    let positions: Vec<DVec3> = placement.positions(&operand.mesh).collect();
    let triangles = operand.mesh.triangles().iter();
    triangles
        .map(|corners| Facet::new(corners.map(|i| positions[i as usize])))
        .collect()
}
