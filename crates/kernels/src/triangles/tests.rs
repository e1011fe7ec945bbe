use super::*;
use crate::{Level, dispatch};
use proptest::prelude::*;

const SLACK: f64 = 1.0 / (1u64 << 40) as f64;

type Corners = [[f32; 3]; 3];

fn rows(triangles: &[Corners]) -> [f32; WINDOW] {
    let mut rows = Vec::new();
    for axis in 0..3 {
        for corner in 0..3 {
            rows.extend(triangles.iter().map(|t| t[corner][axis]));
        }
    }
    // What follows may be anything.
    let wild = [f32::NAN, f32::INFINITY, 0.0, -1.0, 1.0, 2.0, f32::MAX, 0.0];
    rows.extend(wild.into_iter().cycle().take(WINDOW - rows.len()));
    rows.try_into().expect("a window full")
}

/// What one lane after the other finds, after comparing with what all vector instructions find.
fn everywhere(line: &TriangleLine, triangles: &[Corners], s_min: f32, s_max: f32) -> Candidates {
    let rows = rows(triangles);
    let mut wanted = Candidates::default();
    Scalar.test_triangles(line, &rows, triangles.len(), s_min, s_max, &mut wanted);
    let mut levels = vec![Level::new()];
    #[cfg(target_arch = "x86_64")]
    {
        let level = Level::new();
        levels.extend(level.as_sse2().map(Level::Sse2));
        levels.extend(level.as_sse4_2().map(Level::Sse4_2));
        levels.extend(level.as_avx2().map(Level::Avx2));
    }
    for level in levels {
        let mut found = Candidates::default();
        dispatch!(level, simd =>
            Vector(simd).test_triangles(line, &rows, triangles.len(), s_min, s_max, &mut found));
        assert_eq!(found.possible, wanted.possible, "{level:?}");
        if wanted.possible != 0 {
            assert_eq!(found.certain, wanted.certain, "{level:?}");
        }
        for lane in (0..8).filter(|lane| wanted.possible >> lane & 1 != 0) {
            assert!(found.nearest[lane] == wanted.nearest[lane]);
            assert!(found.farthest[lane] == wanted.farthest[lane]);
        }
    }
    wanted
}

/// Edge functions and parameter of a crossing in `f64`, hundreds of millions of times as accurate.
fn accurate(corners: &Corners, origin: [f64; 3], d: [f64; 3]) -> ([f64; 3], f64) {
    let z = (0..3).fold(0, |z, i| if d[i].abs() > d[z].abs() { i } else { z });
    let (x, y) = ([1, 2, 0][z], [2, 0, 1][z]);
    let v = corners.map(|c| [0, 1, 2].map(|i| f64::from(c[i]) - origin[i]));
    let across = v.map(|v| [v[x] - v[z] * d[x] / d[z], v[y] - v[z] * d[y] / d[z]]);
    let edge = |i: usize, j: usize| across[i][0] * across[j][1] - across[i][1] * across[j][0];
    let edges = [edge(1, 2), edge(2, 0), edge(0, 1)];
    let sum = edges[0] + edges[1] + edges[2];
    let depth = (0..3).map(|i| edges[i] * v[i][z]).sum::<f64>() / sum;
    (edges, depth / d[z])
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        -1.0f32..=1.0,
        prop::sample::select(vec![-1.0, -0.5, 0.0, 0.25, 0.5, 1.0]),
        (-1.0f32..=1.0).prop_map(|x| x * 1e-5),
    ]
}

fn component() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1.9f64..1.9,
        prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 1e-12, 1e-300]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]
    /// A point of the triangle is chosen first (often on an edge or at a corner) and the line laid
    /// through it.
    #[test]
    fn a_line_through_a_point_of_a_triangle_may_cross_it_there(
        corners in prop::array::uniform3(prop::array::uniform3(coordinate())),
        shrink in prop::sample::select(vec![1.0f32, 1e-2, 1e-4]),
        weights in prop::array::uniform3(prop_oneof![Just(0.0), 0.0f64..1.0]),
        d in prop::array::uniform3(component()),
        big in 0usize..3,
        negative in any::<bool>(),
        s in -2.0f64..2.0,
        lane in 0usize..8,
    ) {
        let mut d = d;
        d[big] = if negative { -1.25 } else { 1.0 };
        let base = corners[0];
        let corners = corners.map(|c| [0, 1, 2].map(|i| base[i] + (c[i] - base[i]) * shrink));
        let weights = if weights == [0.0; 3] { [0.0, 1.0, 0.0] } else { weights };
        let total: f64 = weights.iter().sum();
        let point = [0, 1, 2].map(|i| {
            (0..3).map(|c| weights[c] / total * f64::from(corners[c][i])).sum::<f64>()
        });
        let origin = [0, 1, 2].map(|i| point[i] - s * d[i]);
        let line = TriangleLine::new(origin, d, SLACK);
        let mut triangles = vec![[[4.0, 4.0, 4.0]; 3]; lane];
        triangles.push(corners);
        let found = everywhere(&line, &triangles, s as f32 - 1e-6, s as f32 + 1e-6);
        prop_assert!(found.possible >> lane & 1 == 1);
        prop_assert!(found.certain & ((1 << lane) - 1) == 0);
        // The point is on the line to within 2^-50, far less than what bounds are rounded by.
        prop_assert!(f64::from(found.nearest[lane]) <= s && s <= f64::from(found.farthest[lane]));
    }

    /// What is certain is true, bounds hold, and a clear miss is seen.
    #[test]
    fn verdicts_agree_with_more_accurate_arithmetic(
        triangles in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(coordinate())), 1..=8),
        o in prop::array::uniform3(-0.5f64..0.5),
        d in prop::array::uniform3(-0.99f64..0.99),
        main in 0usize..3,
        negative in any::<bool>(),
    ) {
        let mut d = d;
        d[main] = if negative { -1.0 } else { 1.0 };
        let line = TriangleLine::new(o, d, SLACK);
        let found = everywhere(&line, &triangles, -16.0, 16.0);
        for (lane, corners) in triangles.iter().enumerate() {
            let (edges, s) = accurate(corners, o, d);
            let inside = edges.iter().all(|&e| e > 0.0) || edges.iter().all(|&e| e < 0.0);
            let clear = edges.iter().all(|&e| e.abs() > 1e-3);
            let [possible, certain] = [found.possible, found.certain].map(|m| m >> lane & 1 == 1);
            prop_assert!(inside || !certain);
            prop_assert!(possible || !inside);
            prop_assert!(!clear || (possible == inside && certain == inside));
            if inside {
                let (low, high) = (f64::from(found.nearest[lane]), f64::from(found.farthest[lane]));
                prop_assert!(low <= s && s <= high, "{low} {s} {high}");
                prop_assert!(!clear || high - low < 0.1);
            }
        }
    }
}

#[test]
fn a_crossing_outside_the_span_is_not_shown() {
    let triangle = [[-0.5, -0.5, 0.25], [0.5, -0.5, 0.25], [0.0, 0.5, 0.25]];
    let line = TriangleLine::new([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], SLACK);
    let shown = |s_min, s_max| everywhere(&line, &[triangle], s_min, s_max);
    let inside = shown(1.0, 2.0);
    assert_eq!((inside.possible, inside.certain), (1, 1));
    assert!(inside.nearest[0] <= 1.25 && inside.nearest[0] > 1.2499);
    assert!(inside.farthest[0] >= 1.25 && inside.farthest[0] < 1.2501);
    assert_eq!(shown(1.25, 1.25).possible, 1);
    assert_eq!(shown(1.0, 1.24).possible, 0);
    assert_eq!(shown(1.26, 2.0).possible, 0);
}
