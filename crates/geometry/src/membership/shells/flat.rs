//! Plane boundaries are triangulated as they are: one triangle is both shells.

use octray_math::{DAffine3, DVec3};

use super::ShellPatch;
use crate::{ConvexPolyhedron, TriangleMesh};

/// The polygon's fan.
fn fan(corners: &[DVec3], patches: &mut Vec<ShellPatch>) {
    let rest = corners.windows(2).skip(1);
    patches.extend(rest.map(|pair| ShellPatch::flat([corners[0], pair[0], pair[1]])));
}

/// The six faces of a box.
pub(super) fn cuboid(min: DVec3, max: DVec3) -> Vec<ShellPatch> {
    let corner = |bits: usize| {
        let pick = |axis: usize| {
            if bits >> axis & 1 == 1 {
                max[axis]
            } else {
                min[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    let mut patches = Vec::with_capacity(12);
    for axis in 0..3 {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        for side in [0, 1 << axis] {
            let face = [side, side | u, side | u | v, side | v].map(corner);
            fan(&face, &mut patches);
        }
    }
    patches
}

/// Around the part of a plane that a ball about `center` cuts out, in the plane's own frame.
pub(super) fn plane(normal: DVec3, offset: f64, center: DVec3, radius: f64) -> Vec<ShellPatch> {
    let height = normal.dot(center) - offset;
    if height.abs() > radius {
        return Vec::new();
    }
    let foot = center - normal * height;
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let reach = 1.001 * radius;
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(a, b)| foot + (u * a + v * b) * reach);
    let mut patches = Vec::new();
    fan(&corners, &mut patches);
    patches
}

/// The faces of a convex polyhedron: the corners on each plane, in order round their middle.
pub(super) fn convex(polyhedron: &ConvexPolyhedron) -> Vec<ShellPatch> {
    let tolerance = polyhedron.bounds().diagonal() * 2e-9;
    let mut patches = Vec::new();
    for (normal, offset) in &polyhedron.planes {
        let on_plane = |p: &&DVec3| (normal.dot(**p) - offset).abs() <= tolerance;
        let mut corners: Vec<DVec3> = polyhedron
            .vertices
            .iter()
            .filter(on_plane)
            .copied()
            .collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        let angle = |p: &DVec3| libm::atan2(v.dot(*p - middle), u.dot(*p - middle));
        corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        fan(&corners, &mut patches);
    }
    patches
}

/// The triangles of a mesh, in the scene.
pub(super) fn mesh(mesh: &TriangleMesh, scene_from_local: &DAffine3) -> Vec<ShellPatch> {
    let positions: Vec<DVec3> = mesh
        .positions()
        .iter()
        .map(|p| scene_from_local.transform_point3(*p))
        .collect();
    let corners = |t: &[u32; 3]| t.map(|i| positions[i as usize]);
    mesh.triangles()
        .iter()
        .map(|t| ShellPatch::flat(corners(t)))
        .collect()
}
