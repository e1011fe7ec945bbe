//! Any other surface: a layer of boxes that it may cross, found by halving.
//!
//! The layer's outer side is the circumscribed shell, its inner side the inscribed one. Every box is two
//! prisms, each the hull of a triangle on one side and one on the opposite side.

use octray_math::{Aabb, DVec3};

use super::ShellPatch;
use crate::profile::Formula;
use crate::surface::{Canonical, Side, Surface};
use crate::{Composite, CompositeFace};

/// The boxes in `region` for which `crosses` holds, halved until their diagonal is `size` or until there
/// are `limit`. `scale` are the lengths in the scene of the axes' units.
pub(super) fn boxes(
    region: &Aabb,
    scale: DVec3,
    size: f64,
    limit: usize,
    crosses: impl Fn(&Aabb) -> bool,
) -> Vec<Aabb> {
    let mut cells = vec![*region];
    if !crosses(region) {
        return Vec::new();
    }
    loop {
        let lengths = cells[0].size() * scale;
        if lengths.length() <= size {
            return cells;
        }
        let axis = (0..3).fold(0, |best, axis| {
            if lengths[axis] > lengths[best] {
                axis
            } else {
                best
            }
        });
        let mut halves = Vec::with_capacity(2 * cells.len());
        for cell in &cells {
            let middle = 0.5 * cell.min[axis] + 0.5 * cell.max[axis];
            let (mut lower, mut upper) = (*cell, *cell);
            lower.max[axis] = middle;
            upper.min[axis] = middle;
            if lower == *cell || upper == *cell {
                return cells;
            }
            halves.extend([lower, upper].into_iter().filter(|half| crosses(half)));
        }
        if halves.is_empty() || halves.len() > limit {
            return if halves.is_empty() { halves } else { cells };
        }
        cells = halves;
    }
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

/// Whether a surface may cross a box of its own frame.
pub(super) fn crosses(canonical: Canonical) -> impl Fn(&Aabb) -> bool {
    let surface = Surface::Curved {
        canonical,
        local_from_scene: octray_math::DAffine3::IDENTITY,
    };
    move |cell| surface.classify(cell) == Side::Both
}

/// Whether the boundary of a composite may pass through a box of its frame.
pub(super) fn composite_crosses(composite: &Composite) -> impl Fn(&Aabb) -> bool + '_ {
    let surfaces: Vec<Surface> = composite
        .faces()
        .iter()
        .map(|face| match face {
            CompositeFace::Plane { normal, point } => {
                let normal = normal.normalize();
                Surface::Plane {
                    normal,
                    offset: normal.dot(*point),
                }
            }
            CompositeFace::Curved {
                canonical,
                from_local,
            } => Surface::Curved {
                canonical: canonical.clone(),
                local_from_scene: from_local.inverse(),
            },
        })
        .collect();
    move |cell| truth(composite.formula(), &surfaces, cell).is_none()
}

/// What the formula is in all of a box, `None` where that is not known. Recurses as deep as the
/// formula, which is bounded.
fn truth(formula: &Formula, surfaces: &[Surface], cell: &Aabb) -> Option<bool> {
    let (parts, deciding) = match formula {
        Formula::Constant(value) => return Some(*value),
        Formula::Side { side, inside } => {
            return match surfaces[*side as usize].classify(cell) {
                Side::Negative => Some(*inside),
                Side::Positive => Some(!inside),
                Side::Both => None,
            };
        }
        Formula::All(parts) => (parts, false),
        Formula::Any(parts) => (parts, true),
    };
    let mut is_open = false;
    for part in parts {
        match truth(part, surfaces, cell) {
            Some(value) if value == deciding => return Some(deciding),
            Some(_) => {}
            None => is_open = true,
        }
    }
    (!is_open).then_some(!deciding)
}
