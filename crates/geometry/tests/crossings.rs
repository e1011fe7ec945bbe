//! The kernel that decides eight pairs of a line and a triangle against the scalar function whose place it
//! takes: the same bits wherever it decides, at every level of vector instructions.

use octray_geometry::mesh::TriangleRay;
use octray_kernels::crossings::PAIRS;
use octray_kernels::{CrossingTest, Crossings, Level, Pairs, Scalar, Vector, dispatch};
use octray_math::{DVec3, Ray};
use proptest::prelude::*;

/// Coordinates that often agree, are far apart in size, or vanish.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1.0f64..=1.0,
        prop::sample::select(vec![0.0, -0.0, 0.5, -0.5, 1.0, 1e-160, -1e150, 1e-300]),
        (-1.0f64..=1.0).prop_map(|x| 1.0 + x * 1e-14),
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(coordinate()).prop_map(DVec3::from_array)
}

fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse2().map(Level::Sse2));
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
    }
    levels
}

/// As the trees put pairs together: coordinates by the line's axes.
fn pairs(all: &[(Ray, [DVec3; 3])]) -> Pairs {
    let mut pairs = Pairs::default();
    for (lane, (ray, corners)) in all.iter().enumerate() {
        for (place, axis) in TriangleRay::axes(ray.direction).into_iter().enumerate() {
            pairs.origins[place][lane] = ray.origin[axis];
            pairs.directions[place][lane] = ray.direction[axis];
            for (corner, point) in corners.iter().enumerate() {
                pairs.corners[corner][place][lane] = point[axis];
            }
        }
    }
    pairs
}

/// How many lanes the kernel decided, after comparing them.
fn compare(all: &[(Ray, [DVec3; 3])]) -> usize {
    let pairs = pairs(all);
    let mut decided = 0;
    for level in levels() {
        let mut found = Crossings::default();
        dispatch!(level, simd => Vector(simd).cross(&pairs, &mut found));
        for (lane, (ray, corners)) in all.iter().enumerate() {
            let bit = |mask: u32| mask >> lane & 1 != 0;
            if !bit(found.decided) {
                continue;
            }
            decided += 1;
            let wanted = TriangleRay::new(ray).intersect(*corners);
            let wanted = wanted.map(|hit| (hit.t.to_bits(), hit.entering));
            let got = (found.t[lane].to_bits(), !bit(found.leaving));
            let got = bit(found.crossed).then_some(got);
            assert_eq!(got, wanted, "{level:?} {ray:?} {corners:?}");
        }
    }
    decided
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]
    #[test]
    fn lanes_decide_as_the_scalar_function_does(
        all in prop::collection::vec((point(), point(), prop::array::uniform3(point())), PAIRS),
    ) {
        let line = |(origin, direction, corners): (DVec3, DVec3, _)| {
            let direction = if direction == DVec3::ZERO { DVec3::X } else { direction };
            (Ray::new(origin, direction), corners)
        };
        compare(&all.into_iter().map(line).collect::<Vec<_>>());
    }

    #[test]
    fn plain_crossings_are_decided(
        weights in prop::collection::vec(prop::array::uniform3(0.1f64..1.0), PAIRS),
        eyes in prop::collection::vec(prop::array::uniform3(-1.0f64..1.0), PAIRS),
        turned in any::<bool>(),
    ) {
        let mut corners = [DVec3::new(4.0, 0.0, 3.0), DVec3::new(0.0, 4.0, 3.5), DVec3::new(-3.0, -3.0, 4.0)];
        if turned {
            corners.swap(0, 1);
        }
        let pair = |(weights, eye): (&[f64; 3], &[f64; 3])| {
            let total: f64 = weights.iter().sum();
            let target: DVec3 = (0..3).map(|i| corners[i] * (weights[i] / total)).sum();
            let eye = DVec3::from_array(*eye);
            (Ray::new(eye, target - eye), corners)
        };
        let all: Vec<_> = weights.iter().zip(&eyes).map(pair).collect();
        prop_assert_eq!(compare(&all), PAIRS * levels().len());
        for (ray, corners) in &all {
            let hit = TriangleRay::new(ray).intersect(*corners).expect("through the middle");
            prop_assert!((hit.t - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn the_scalar_twin_leaves_all_to_the_scalar_function() {
    let mut found = Crossings {
        decided: 1,
        crossed: 1,
        leaving: 1,
        ..Crossings::default()
    };
    Scalar.cross(&Pairs::default(), &mut found);
    assert_eq!((found.decided, found.crossed, found.leaving), (0, 0, 0));
}
