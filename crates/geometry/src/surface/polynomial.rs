//! Algebraic surfaces in the frame of their polynomial.

use octray_math::roots::SignChangeList;
use octray_math::{Aabb, DAffine3, DVec3};

use super::Side;
use super::local_box::{LocalBox, decide};
use crate::Polynomial;

pub(super) fn crossings(polynomial: &Polynomial, o: DVec3, d: DVec3) -> SignChangeList {
    // In units of length from the point that is nearest to the origin, where the polynomial's
    // terms are smallest.
    let length = d.length();
    let unit = d / length;
    let closest = -o.dot(unit);
    let changes = polynomial.crossings(o + unit * closest, unit);
    changes.moved(closest / length, 1.0 / length)
}

pub(super) fn classify(polynomial: &Polynomial, local: &LocalBox) -> Side {
    let (low, high, magnitude) = enclosure(polynomial, local);
    if low.is_finite() && high.is_finite() {
        decide(low, high, magnitude)
    } else {
        Side::Both
    }
}

/// Least and greatest value in a box, but for rounding of the magnitude that comes third.
pub(crate) fn range(polynomial: &Polynomial, bounds: &Aabb) -> (f64, f64, f64) {
    enclosure(polynomial, &LocalBox::new(bounds, &DAffine3::IDENTITY))
}

/// By the Taylor polynomial of second order at the centre; what it leaves out is at most what the
/// polynomial of absolute values leaves out there.
fn enclosure(polynomial: &Polynomial, local: &LocalBox) -> (f64, f64, f64) {
    let (center, reach) = (local.center, local.reach);
    let jet = polynomial.jet(center);
    let products = DVec3::new(reach.y * reach.z, reach.z * reach.x, reach.x * reach.y);
    let second =
        |squares: DVec3, mixed: DVec3| 0.5 * squares.dot(reach * reach) + mixed.dot(products);
    let above = polynomial.majorant(center);
    let most = polynomial.majorant_value(center.abs() + reach);
    let rest = most - above.value - above.gradient.dot(reach) - second(above.squares, above.mixed);
    let spread =
        local.linear(jet.gradient) + second(jet.squares.abs(), jet.mixed.abs()) + rest.max(0.0);
    (jet.value - spread, jet.value + spread, most)
}

pub(super) fn gradient(polynomial: &Polynomial, p: DVec3) -> DVec3 {
    polynomial.jet(p).gradient
}
