//! A contour in the plane, drawn out along z without end.

use octray_math::{DVec2, DVec3};

use super::Side;
use super::found::Found;
use super::local_box::LocalBox;
use crate::profile::{Contour, changes};

/// The line is projected along z. Which side of it a point of the contour lies on is decided once
/// per shared end, so that closed curves change sides an even number of times.
pub(super) fn crossings(
    contour: &Contour,
    o: DVec3,
    d: DVec3,
    visit: &mut impl FnMut(f64),
) -> bool {
    let (origin, along) = (o.truncate(), d.truncate());
    let square = along.length_squared();
    let shift = -origin.dot(along) / square;
    if !shift.is_finite() {
        // Along z: inside or outside for good.
        return contour.contains(origin);
    }
    let near = origin + along * shift;
    let mut found = Found::new();
    let offset = near.perp_dot(along);
    for curve in contour.curves() {
        // Cross product of the direction with the way to the point.
        let side = curve.combined(-along.y, along.x, offset);
        let signs = side.coefficients();
        let first = signs[0] > 0.0;
        if signs.iter().all(|c| (*c > 0.0) == first) {
            continue;
        }
        changes(
            &side,
            |u| side.evaluate(u),
            |u| {
                let p = curve.at(u) - near;
                found.push(shift + p.dot(along) / square);
            },
        );
    }
    found.visit_sorted(visit);
    false
}

pub(super) fn classify(contour: &Contour, local: &LocalBox) -> Side {
    let (center, reach) = (local.center.truncate(), local.reach.truncate());
    contour.classify(center - reach, center + reach)
}

pub(super) fn gradient(contour: &Contour, p: DVec3) -> DVec3 {
    contour.normal(DVec2::new(p.x, p.y)).extend(0.0)
}
