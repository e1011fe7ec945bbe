//! A surface without a parametrisation: a layer of boxes that it may cross, found by halving.
//!
//! The layer's outer side is the circumscribed shell, its inner side the inscribed one. Every box is two
//! prisms, each the hull of a triangle on one side and one on the opposite side.

use octray_math::{Aabb, DAffine3, DVec3};

use super::ShellPatch;
use crate::surface::{Canonical, Side, Surface};

/// The boxes in `region` that a surface of that frame may cross, halved until their diagonal is `size` or
/// until there are `limit`. `scale` are the lengths in the scene of the axes' units.
pub(super) fn boxes(
    region: &Aabb,
    scale: DVec3,
    size: f64,
    limit: usize,
    canonical: Canonical,
) -> Vec<Aabb> {
    let surface = Surface::Curved {
        canonical,
        local_from_scene: DAffine3::IDENTITY,
    };
    let is_crossed = |cell: &Aabb| surface.classify(cell) == Side::Both;
    if !is_crossed(region) {
        return Vec::new();
    }
    let mut cells = vec![*region];
    loop {
        let lengths = cells[0].size() * scale;
        if lengths.length() <= size {
            break;
        }
        let axis = (0..3).fold(0, |best, axis| {
            if lengths[axis] > lengths[best] {
                axis
            } else {
                best
            }
        });
        let mut halves = Vec::with_capacity(2 * cells.len());
        let mut is_divisible = true;
        for cell in &cells {
            let middle = 0.5 * cell.min[axis] + 0.5 * cell.max[axis];
            let (mut lower, mut upper) = (*cell, *cell);
            lower.max[axis] = middle;
            upper.min[axis] = middle;
            is_divisible &= lower != *cell && upper != *cell;
            halves.extend([lower, upper].into_iter().filter(is_crossed));
            if halves.len() > limit {
                break;
            }
        }
        if !is_divisible || halves.len() > limit {
            break;
        }
        if halves.is_empty() {
            return Vec::new();
        }
        cells = halves;
    }
    cells
}

/// Both prisms of a box.
pub(super) fn prisms(cell: &Aabb) -> [ShellPatch; 2] {
    let (a, b) = (cell.min, cell.max);
    let triangle = |z: f64, (x, y): (f64, f64)| {
        [
            DVec3::new(a.x, a.y, z),
            DVec3::new(x, y, z),
            DVec3::new(b.x, b.y, z),
        ]
    };
    [(b.x, a.y), (a.x, b.y)].map(|third| ShellPatch {
        inner: triangle(a.z, third),
        outer: triangle(b.z, third),
    })
}
