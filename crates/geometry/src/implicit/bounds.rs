//! A box around the points where a polynomial is negative, where one can be proved.

use octray_math::roots::sign_changes;
use octray_math::{Aabb, DVec3};

use crate::Polynomial;
use crate::polynomial::powers;
use crate::surface::polynomial_range;

/// Boxes that are looked at before giving up, and before the box is good enough.
const MOST_BOXES: usize = 1000;
/// Into how many steps the first box is resolved.
const SHARPNESS: f64 = 64.0;

/// [`Aabb::ALL`] where the terms of the highest degree are not positive in all directions.
pub(super) fn of_negative_points(polynomial: &Polynomial) -> Aabb {
    radius(polynomial).map_or(Aabb::ALL, |radius| {
        let first = Aabb::new(DVec3::splat(-radius), DVec3::splat(radius));
        shrunk(polynomial, first)
    })
}

/// A cube outside of which the polynomial is positive: half its edge.
fn radius(polynomial: &Polynomial) -> Option<f64> {
    let degree = polynomial.degree();
    let leading: Vec<f64> = powers(degree)
        .zip(polynomial.coefficients())
        .map(|(p, &c)| {
            if p.iter().sum::<usize>() == degree {
                c
            } else {
                0.0
            }
        })
        .collect();
    let leading = Polynomial::new(degree, &leading).ok()?;
    // It was scaled again.
    let scale = |p: &Polynomial| {
        p.coefficients()
            .iter()
            .fold(0.0, |m: f64, c| m.max(c.abs()))
    };
    let least = least_on_cube(&leading)?;
    let largest = powers(degree)
        .zip(polynomial.coefficients())
        .filter(|(p, _)| p.iter().sum::<usize>() == degree)
        .fold(0.0, |m: f64, (_, c)| m.max(c.abs()));
    // On the cube of half edge s it is at least `least s^n - sum of the others' sizes s^k`.
    let mut bound = vec![0.0; degree + 1];
    bound[degree] = 0.99 * least * (largest / scale(&leading));
    for (p, c) in powers(degree).zip(polynomial.coefficients()) {
        let sum: usize = p.iter().sum();
        if sum < degree {
            bound[sum] -= c.abs();
        }
    }
    let last = sign_changes(&bound).as_slice().last().copied()?;
    (last > 0.0 && last.is_finite()).then_some(last * 1.01)
}

/// A positive lower bound of a homogeneous polynomial on the surface of the cube from -1 to 1.
fn least_on_cube(leading: &Polynomial) -> Option<f64> {
    if leading.degree() % 2 == 1 {
        return None;
    }
    // The opposite faces have the same values.
    let mut boxes: Vec<Aabb> = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .map(|axis| Aabb::new(axis * 2.0 - DVec3::ONE, DVec3::ONE))
        .collect();
    let (mut least, mut looked) = (f64::INFINITY, 0);
    while let Some(part) = boxes.pop() {
        let (low, _, magnitude) = polynomial_range(leading, &part);
        // A quarter of the value at the centre is enough: the bound need not be sharp.
        let value = leading.value(part.center());
        if low > 0.25 * value && low > 1e-12 * magnitude {
            least = least.min(low);
            continue;
        }
        looked += 1;
        if value <= 0.0 || looked > MOST_BOXES {
            return None;
        }
        boxes.extend(halves(&part));
    }
    Some(least)
}

/// The two halves of a box, cut across its longest edge.
fn halves(part: &Aabb) -> [Aabb; 2] {
    let size = part.size();
    let axis = (0..3).fold(0, |a, b| if size[b] > size[a] { b } else { a });
    let middle = part.center()[axis];
    let (mut low, mut high) = (*part, *part);
    low.max[axis] = middle;
    high.min[axis] = middle;
    [low, high]
}

/// The part of a box that holds all its negative points, as far as halving it tells.
fn shrunk(polynomial: &Polynomial, first: Aabb) -> Aabb {
    let mut bounds = first;
    for axis in 0..3 {
        let limits = [-1.0, 1.0].map(|sign| farthest(polynomial, &bounds, axis, sign));
        let [Some(low), Some(high)] = limits else {
            return Aabb::EMPTY;
        };
        (bounds.min[axis], bounds.max[axis]) = (-low, high);
    }
    bounds
}

/// The largest `sign * coordinate` that a negative point in the box may have, not sharp. `None`
/// where no point is negative.
fn farthest(polynomial: &Polynomial, first: &Aabb, axis: usize, sign: f64) -> Option<f64> {
    let reach = |part: &Aabb| (part.min[axis] * sign).max(part.max[axis] * sign);
    let enough = first.size()[axis] / SHARPNESS;
    let mut open = vec![*first];
    for _ in 0..MOST_BOXES {
        let ahead = (0..open.len()).max_by(|&i, &j| reach(&open[i]).total_cmp(&reach(&open[j])))?;
        let part = open.swap_remove(ahead);
        if part.size().max_element() < enough {
            return Some(reach(&part));
        }
        open.extend(halves(&part).into_iter().filter(|half| {
            let (low, _, magnitude) = polynomial_range(polynomial, half);
            low <= 1e-12 * magnitude
        }));
    }
    open.iter().map(reach).max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;

    fn polynomial(degree: usize, of: impl Fn([usize; 3]) -> f64) -> Polynomial {
        let all: Vec<f64> = powers(degree).map(of).collect();
        Polynomial::new(degree, &all).expect("valid")
    }

    #[test]
    fn a_torus_is_boxed_tightly_wherever_and_however_large_it_is() {
        for size in [1e-3, 1.0, 1e3] {
            // Radii 0.75 and 0.25 times the size.
            let (sum, difference) = (0.625 * size * size, 0.5 * size * size);
            let torus = polynomial(4, |p| match p {
                [4, 0, 0] | [0, 4, 0] | [0, 0, 4] => 1.0,
                [2, 2, 0] | [2, 0, 2] | [0, 2, 2] => 2.0,
                [2, 0, 0] | [0, 2, 0] => -2.0 * sum,
                [0, 0, 2] => 2.0 * difference,
                [0, 0, 0] => difference * difference,
                _ => 0.0,
            });
            let bounds = Solid::polynomial(torus).expect("valid").bounds();
            let exact = DVec3::new(size, size, 0.25 * size);
            assert!(
                exact.cmple(bounds.max).all() && bounds.min.cmple(-exact).all(),
                "{bounds:?}"
            );
            assert!(
                (bounds.max - exact).max_element() < 0.08 * size,
                "{bounds:?}"
            );
        }
    }

    #[test]
    fn what_goes_on_for_ever_has_no_box() {
        let saddle = polynomial(3, |p| match p {
            [3, 0, 0] => 1.0,
            [1, 2, 0] => -3.0,
            [0, 0, 1] => -1.0,
            _ => 0.0,
        });
        assert_eq!(of_negative_points(&saddle), Aabb::ALL);
        // x^4 + y^4 - 1: a column.
        let column = polynomial(4, |p| match p {
            [4, 0, 0] | [0, 4, 0] => 1.0,
            [0, 0, 0] => -1.0,
            _ => 0.0,
        });
        assert_eq!(of_negative_points(&column), Aabb::ALL);
    }

    #[test]
    fn what_is_nowhere_negative_is_empty() {
        let nothing = polynomial(4, |p| match p {
            [4, 0, 0] | [0, 4, 0] | [0, 0, 4] | [0, 0, 0] => 1.0,
            _ => 0.0,
        });
        assert!(of_negative_points(&nothing).is_empty());
    }
}
