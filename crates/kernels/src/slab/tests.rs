use super::*;
use crate::{Level, dispatch};
use proptest::prelude::*;

const SLACK: f64 = 1.0 / (1u64 << 40) as f64;

fn both(ray: &SlabRay, boxes: &Boxes8, s_min: f32, s_max: f32) -> (u32, [f32; 8]) {
    let mut entries = [0.0; 8];
    let mask = Scalar.test(ray, boxes, s_min, s_max, &mut entries);
    let mut levels = vec![Level::new()];
    #[cfg(target_arch = "x86_64")]
    {
        let level = Level::new();
        levels.extend(level.as_sse2().map(Level::Sse2));
        levels.extend(level.as_sse4_2().map(Level::Sse4_2));
        levels.extend(level.as_avx2().map(Level::Avx2));
    }
    for level in levels {
        let mut found = [0.0; 8];
        let got = dispatch!(level, simd =>
            Vector(simd).test(ray, boxes, s_min, s_max, &mut found));
        assert_eq!(got, mask, "{level:?}");
        for lane in 0..8 {
            // Only the sign of a zero may differ.
            assert!(mask >> lane & 1 == 0 || found[lane] == entries[lane]);
        }
    }
    (mask, entries)
}

#[test]
fn empty_slots_are_never_hit() {
    for d in [[1.0, 0.0, 0.0], [-1.0, -0.0, 0.5], [0.3, -1.5, 1e-30]] {
        let ray = SlabRay::new([0.25, 0.5, -0.125], d, 1.0, SLACK);
        let span = (f32::NEG_INFINITY, f32::INFINITY);
        assert_eq!(both(&ray, &Boxes8::EMPTY, span.0, span.1).0, 0);
    }
}

#[test]
fn parallel_lines_see_the_planes_they_lie_in_and_not_those_beyond() {
    let mut boxes = Boxes8::EMPTY;
    boxes.set(0, [0.5, -1.0, -1.0], [0.5, -0.5, -0.5]);
    boxes.set(1, [0.5, 0.25, -1.0], [1.0, 0.5, 1.0]);
    boxes.set(2, [0.25, 0.25, -1.0], [0.5, 0.5, 1.0]);
    boxes.set(3, [0.5001, -1.0, -1.0], [1.0, 1.0, 1.0]);
    boxes.set(4, [0.0, -1.0, -1.0], [0.4999, 1.0, 1.0]);
    for zero in [0.0, -0.0] {
        let ray = SlabRay::new([0.5, -0.5, -0.5], [zero, 1.0, zero], 1.0, SLACK);
        let (mask, entries) = both(&ray, &boxes, -8.0, 8.0);
        assert_eq!(mask, 0b111);
        assert!((entries[1] - 0.75).abs() < 1e-6 && entries[1] <= 0.75);
        // The box touched at the origin alone is behind the rest of the line.
        assert_eq!(both(&ray, &boxes, 0.1, 8.0).0, 0b110);
    }
}

/// A coordinate that is often on the same few values as others.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1.0f32..=1.0,
        prop::sample::select(vec![-1.0, -0.5, 0.0, 0.25, 0.5, 1.0, 1e-20, -1e-39]),
        (-1.0f32..=1.0).prop_map(|x| x * 1e-5),
    ]
}

fn component() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1.9f64..1.9,
        prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 1e-12, -1e-40, 1e-300, 5e-324]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]
    /// A point of the box is chosen first and the line laid through it, so the box must be
    /// reported, and the entry must not lie behind the point.
    #[test]
    fn a_line_through_a_point_of_a_box_reports_it(
        a in prop::array::uniform3(coordinate()),
        b in prop::array::uniform3(coordinate()),
        weight in prop::array::uniform3(prop_oneof![Just(0.0), Just(1.0), 0.0f64..=1.0]),
        d in prop::array::uniform3(component()),
        big in 0usize..3,
        negative in any::<bool>(),
        s in -2.0f64..2.0,
    ) {
        let mut d = d;
        d[big] = if negative { -1.25 } else { 1.0 };
        let mut boxes = Boxes8::EMPTY;
        let min = [0, 1, 2].map(|i| a[i].min(b[i]));
        let max = [0, 1, 2].map(|i| a[i].max(b[i]));
        boxes.set(5, min, max);
        let point = [0, 1, 2].map(|i| {
            let (lo, hi) = (f64::from(min[i]), f64::from(max[i]));
            (lo + weight[i] * (hi - lo)).clamp(lo, hi)
        });
        // In f64 the origin misses the point by less than the slack.
        let origin = [0, 1, 2].map(|i| point[i] - s * d[i]);
        let ray = SlabRay::new(origin, d, 1.0, SLACK);
        let (mask, entries) = both(&ray, &boxes, round_down(s), round_up(s));
        prop_assert_eq!(mask, 1 << 5);
        prop_assert!(f64::from(entries[5]) <= s);
    }

    /// And what is reported is not far off.
    #[test]
    fn a_reported_box_is_nearly_met(
        a in prop::array::uniform3(-1.0f32..=1.0),
        b in prop::array::uniform3(-1.0f32..=1.0),
        o in prop::array::uniform3(-1.0f64..=1.0),
        d in prop::array::uniform3(0.01f64..1.0),
    ) {
        let mut d = d;
        d[0] = 1.0;
        let mut boxes = Boxes8::EMPTY;
        let min = [0, 1, 2].map(|i| a[i].min(b[i]));
        let max = [0, 1, 2].map(|i| a[i].max(b[i]));
        boxes.set(0, min, max);
        let ray = SlabRay::new(o, d, 1.0, SLACK);
        let (mask, entries) = both(&ray, &boxes, -1e3, 1e3);
        let plane = |p: [f32; 3], i: usize| (f64::from(p[i]) - o[i]) / d[i];
        let enter = (0..3).map(|i| plane(min, i)).fold(f64::MIN, f64::max);
        let leave = (0..3).map(|i| plane(max, i)).fold(f64::MAX, f64::min);
        if enter <= leave {
            prop_assert!(mask == 1 && (f64::from(entries[0]) - enter).abs() < 1e-3);
        } else if enter > leave + 1e-3 {
            prop_assert_eq!(mask, 0);
        }
    }
}
