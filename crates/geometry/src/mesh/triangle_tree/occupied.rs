//! How much of a cell its triangles occupy. A triangle has no volume: the box around its part in the cell
//! stands for it, as boxes around operands do for solids.

use octray_math::{Aabb, DVec3};

/// The box around the part of a triangle inside a cell; empty where there is none. (Clipped by one face of the
/// cell after the other: Sutherland and Hodgman 1974.)
pub(super) fn bounds_within(corners: [DVec3; 3], cell: &Aabb) -> Aabb {
    // Every face adds at most one corner.
    let mut polygon = [DVec3::ZERO; 9];
    let mut kept = polygon;
    polygon[..3].copy_from_slice(&corners);
    let mut count = 3;
    for axis in 0..3 {
        for (sign, face) in [(1.0, cell.max[axis]), (-1.0, cell.min[axis])] {
            let beyond = |p: DVec3| sign * (p[axis] - face);
            let mut next = 0;
            for i in 0..count {
                let (a, b) = (polygon[i], polygon[(i + 1) % count]);
                let (from, to) = (beyond(a), beyond(b));
                if from <= 0.0 {
                    kept[next] = a;
                    next += 1;
                }
                if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
                    kept[next] = a + (b - a) * (from / (from - to));
                    kept[next][axis] = face;
                    next += 1;
                }
            }
            (polygon, count) = (kept, next);
        }
    }
    Aabb::from_points(polygon[..count].iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_math::{hash_combine, unit_f64};

    #[test]
    fn boxes_hold_what_is_inside_and_no_more() {
        let cell = Aabb::new(DVec3::ZERO, DVec3::splat(2.0));
        let bounds = |corners: [[f64; 3]; 3]| bounds_within(corners.map(DVec3::from_array), &cell);
        let whole = bounds([[0.5, 0.5, 1.0], [1.5, 0.5, 1.0], [0.5, 1.5, 1.0]]);
        assert_eq!(whole.min, DVec3::new(0.5, 0.5, 1.0));
        assert_eq!(whole.max, DVec3::new(1.5, 1.5, 1.0));
        // Far larger than the cell, through its middle.
        let across = bounds([[-50.0, -50.0, 1.0], [50.0, -50.0, 1.0], [0.0, 90.0, 1.0]]);
        assert_eq!((across.min.z, across.max.z), (1.0, 1.0));
        assert_eq!((across.min.x, across.max.y), (0.0, 2.0));
        // It cuts off the corner at 2, 2, 2.
        let corner = bounds(
            [[2.0, 2.0, 1.0], [2.0, 1.0, 2.0], [1.0, 2.0, 2.0]].map(|p| {
                let away = DVec3::from_array(p) - DVec3::splat(5.0 / 3.0);
                (DVec3::splat(5.0 / 3.0) + away * 8.0).to_array()
            }),
        );
        assert!((corner.min - DVec3::ONE).abs().max_element() < 1e-12);
        assert_eq!(corner.max, DVec3::splat(2.0));
        assert!(bounds([[3.0, 0.0, 0.0], [4.0, 1.0, 0.0], [3.0, 1.0, 1.0]]).is_empty());
    }

    #[test]
    fn boxes_are_those_of_points_of_random_triangles() {
        let cell = Aabb::new(DVec3::splat(-1.0), DVec3::ONE);
        let mut seed = 3;
        let mut unit = || {
            seed = hash_combine(seed, 5);
            unit_f64(seed)
        };
        let mut met = 0;
        for _ in 0..500 {
            let mut point = || (DVec3::new(unit(), unit(), unit()) - 0.5) * 5.0;
            let corners = [point(), point(), point()];
            let bounds = bounds_within(corners, &cell);
            let mut sampled = Aabb::EMPTY;
            for i in 0..=60 {
                for j in 0..=60 - i {
                    let (u, v) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    let p = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    if cell.contains(p) {
                        sampled = sampled.including(p);
                    }
                }
            }
            if sampled.is_empty() {
                continue;
            }
            met += 1;
            assert!(bounds.inflated(1e-12).contains_box(&sampled), "{corners:?}");
            assert!(sampled.inflated(0.4).contains_box(&bounds), "{corners:?}");
            assert!(cell.contains_box(&bounds));
        }
        assert!(met > 150, "{met}");
    }
}
