//! Any other surface: a layer of boxes that it may cross, found by halving.
//!
//! The layer's outer side is the circumscribed shell, its inner side the inscribed one. Every box is two
//! prisms, each the hull of a triangle on one side and one on the opposite side.

use octray_math::{Aabb, DVec3};

use super::ShellPatch;
use crate::profile::Formula;
use crate::surface::{Canonical, Side, Surface};
use crate::{Composite, CompositeFace};

/// The boxes in `region` that the boundary may cross, halved until their diagonal is `size` or until
/// there are `limit`. `scale` are the lengths in the scene of the axes' units. `narrow` says what is open
/// in a box of what is open around it, `None` where the boundary cannot be.
pub(super) fn boxes<Open>(
    region: &Aabb,
    scale: DVec3,
    size: f64,
    limit: usize,
    whole: &Open,
    narrow: impl Fn(&Open, &Aabb) -> Option<Open>,
) -> Vec<Aabb> {
    let Some(open) = narrow(whole, region) else {
        return Vec::new();
    };
    let mut cells = vec![(*region, open)];
    loop {
        let lengths = cells[0].0.size() * scale;
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
        for (cell, open) in &cells {
            let middle = 0.5 * cell.min[axis] + 0.5 * cell.max[axis];
            let (mut lower, mut upper) = (*cell, *cell);
            lower.max[axis] = middle;
            upper.min[axis] = middle;
            is_divisible &= lower != *cell && upper != *cell;
            let of_half = |half: Aabb| Some((half, narrow(open, &half)?));
            halves.extend([lower, upper].into_iter().filter_map(of_half));
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
    cells.into_iter().map(|(cell, _)| cell).collect()
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

/// For [`boxes`]: a surface of its own frame may cross a box.
pub(super) fn crosses(canonical: Canonical) -> impl Fn(&Formula, &Aabb) -> Option<Formula> {
    let surface = Surface::Curved {
        canonical,
        local_from_scene: octray_math::DAffine3::IDENTITY,
    };
    composite_of(vec![surface])
}

/// For [`boxes`]: the boundary of a composite may pass through a box of its frame.
pub(super) fn composite_crosses(
    composite: &Composite,
) -> impl Fn(&Formula, &Aabb) -> Option<Formula> {
    let surface = |face: &CompositeFace| match face {
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
    };
    composite_of(composite.faces().iter().map(surface).collect())
}

fn composite_of(surfaces: Vec<Surface>) -> impl Fn(&Formula, &Aabb) -> Option<Formula> {
    move |formula, cell| match narrowed(formula, &surfaces, cell) {
        Formula::Constant(_) => None,
        open => Some(open),
    }
}

/// The formula as it is in a box, without the sides that are decided there: what is left for the
/// halves to ask. Recurses as deep as the formula, which is bounded.
fn narrowed(formula: &Formula, surfaces: &[Surface], cell: &Aabb) -> Formula {
    let (parts, deciding) = match formula {
        Formula::Constant(_) => return formula.clone(),
        Formula::Side { side, inside } => {
            return match surfaces[*side as usize].classify(cell) {
                Side::Negative => Formula::Constant(*inside),
                Side::Positive => Formula::Constant(!inside),
                Side::Both => formula.clone(),
            };
        }
        Formula::All(parts) => (parts, false),
        Formula::Any(parts) => (parts, true),
    };
    let mut open = Vec::new();
    for part in parts {
        match narrowed(part, surfaces, cell) {
            Formula::Constant(value) if value == deciding => return Formula::Constant(deciding),
            Formula::Constant(_) => {}
            rest => open.push(rest),
        }
    }
    match (open.len(), deciding) {
        (0, _) => Formula::Constant(!deciding),
        (1, _) => open.remove(0),
        (_, false) => Formula::All(open),
        (_, true) => Formula::Any(open),
    }
}
