//! The triangle-cube test against two oracles, both exact: clipping in rational numbers and the
//! separating-axis theorem in integers.

#![expect(
    clippy::print_stdout,
    reason = "how many cases each step decides is worth seeing"
)]

use num_bigint::BigInt;
use octray_math::{Aabb, DVec3, hash_combine};
use octray_tree::triangle_cube::{Step, triangle_meets_cube};

/// Cases per kind; `OCTRAY_CASES` multiplies it.
fn cases() -> u64 {
    let times = std::env::var("OCTRAY_CASES")
        .ok()
        .and_then(|n| n.parse().ok());
    4_000 * times.unwrap_or(1)
}

/// Homogeneous coordinates x, y, z, w in integers, `w > 0`: a rational point.
type Point = [BigInt; 4];

/// The number times 2^1074: an integer for every `f64`.
fn exact(x: f64) -> BigInt {
    let bits = x.abs().to_bits();
    let (exponent, fraction) = (bits >> 52, bits & ((1 << 52) - 1));
    let size = match exponent {
        0 => BigInt::from(fraction),
        e => BigInt::from(fraction | 1 << 52) << (e - 1),
    };
    if x < 0.0 { -size } else { size }
}

/// Whether anything is left of the triangle after clipping it by the six faces (Sutherland and
/// Hodgman 1974), in rational numbers.
fn clipping(triangle: &[DVec3; 3], cube: &Aabb) -> bool {
    let zero = BigInt::from(0);
    let mut polygon: Vec<Point> = triangle
        .iter()
        .map(|p| [exact(p.x), exact(p.y), exact(p.z), BigInt::from(1)])
        .collect();
    for axis in 0..3 {
        for (bound, keep_below) in [(cube.max[axis], true), (cube.min[axis], false)] {
            let bound = exact(bound);
            let height = |p: &Point| {
                let above = &p[axis] - &bound * &p[3];
                if keep_below { above } else { -above }
            };
            let mut kept = Vec::new();
            for (i, p) in polygon.iter().enumerate() {
                let q = &polygon[(i + 1) % polygon.len()];
                let (hp, hq) = (height(p), height(q));
                if hp <= zero {
                    kept.push(p.clone());
                }
                if (hp < zero && hq > zero) || (hp > zero && hq < zero) {
                    let sign = if hp < zero { 1 } else { -1 };
                    kept.push(std::array::from_fn(|i| (&q[i] * -&hp + &p[i] * &hq) * sign));
                }
            }
            polygon = kept;
        }
    }
    !polygon.is_empty()
}

/// The separating-axis theorem (Akenine-Moller 2001) for integer coordinates below 2^20: thirteen
/// axes, no rounding.
fn separating_axes(triangle: &[[i64; 3]; 3], min: [i64; 3], max: [i64; 3]) -> bool {
    let wide = |p: [i64; 3]| p.map(i128::from);
    let corners: Vec<[i128; 3]> = (0..8)
        .map(|i| {
            std::array::from_fn(|axis| {
                i128::from(if i >> axis & 1 == 0 {
                    min[axis]
                } else {
                    max[axis]
                })
            })
        })
        .collect();
    let points = triangle.map(wide);
    let sub = |a: [i128; 3], b: [i128; 3]| -> [i128; 3] { std::array::from_fn(|i| a[i] - b[i]) };
    let cross = |a: [i128; 3], b: [i128; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let unit = |axis: usize| -> [i128; 3] { std::array::from_fn(|i| i128::from(i == axis)) };
    let edges = [
        sub(points[1], points[0]),
        sub(points[2], points[1]),
        sub(points[0], points[2]),
    ];
    let mut axes = vec![cross(edges[0], edges[1])];
    for axis in 0..3 {
        axes.push(unit(axis));
        axes.extend(edges.map(|edge| cross(edge, unit(axis))));
    }
    let along = |axis: &[i128; 3], p: &[i128; 3]| (0..3).map(|i| axis[i] * p[i]).sum::<i128>();
    let range = |axis: &[i128; 3], all: &[[i128; 3]]| {
        let values = all.iter().map(|p| along(axis, p));
        (values.clone().min().unwrap_or(0), values.max().unwrap_or(0))
    };
    axes.iter().all(|axis| {
        let (a, b) = (range(axis, &points), range(axis, &corners));
        a.1 >= b.0 && b.1 >= a.0
    })
}

/// A stream of numbers that is the same everywhere.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 = hash_combine(self.0, 0x9e37);
        self.0
    }

    /// In `-range..=range`.
    fn integer(&mut self, range: i64) -> i64 {
        (self.roll() % (2 * range as u64 + 1)) as i64 - range
    }

    /// In [-1, 1), all 53 bits random.
    fn real(&mut self) -> f64 {
        (self.roll() >> 11) as f64 * libm::exp2(-52.0) - 1.0
    }
}

fn count(steps: &mut [u64; 4], step: Step) {
    steps[step as usize] += 1;
}

#[test]
fn integer_triangles_agree_with_both_oracles() {
    let mut dice = Dice(1);
    let mut steps = [0; 4];
    // Small ranges make touching faces, edges and vertices, and triangles without area, common.
    for range in [2, 3, 5, 9, 40, 1 << 18] {
        for _ in 0..cases() {
            let triangle: [[i64; 3]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| dice.integer(range)));
            let half = 1 + dice.integer(range).abs() / 2;
            let center: [i64; 3] = std::array::from_fn(|_| dice.integer(range) / 2);
            let (min, max) = (center.map(|c| c - half), center.map(|c| c + half));
            let real = |p: [i64; 3]| DVec3::from_array(p.map(|x| x as f64));
            let cube = Aabb::new(real(min), real(max));
            let verdict = triangle_meets_cube(&triangle.map(real), &cube);
            let expected = separating_axes(&triangle, min, max);
            assert_eq!(verdict.meets, expected, "{triangle:?} {min:?} {max:?}");
            if dice.roll().is_multiple_of(8) {
                assert_eq!(clipping(&triangle.map(real), &cube), expected);
            }
            count(&mut steps, verdict.step);
        }
    }
    println!("decided at vertex, face, edge, diagonal: {steps:?}");
    assert!(
        steps.iter().all(|&n| n > 0),
        "every step is reached: {steps:?}"
    );
}

#[test]
fn adversarial_triangles_agree_with_rational_clipping() {
    let mut dice = Dice(2);
    let mut steps = [0; 4];
    for case in 0..cases() {
        let scale = libm::exp2(dice.integer(30) as f64);
        let random = |dice: &mut Dice| DVec3::new(dice.real(), dice.real(), dice.real());
        let cube = Aabb::new(DVec3::splat(-0.5), DVec3::splat(0.5));
        let mut triangle = match case % 5 {
            0 => [random(&mut dice), random(&mut dice), random(&mut dice)].map(|p| p * 2.0),
            // Far larger than the cube, through a point near one of its corners.
            1 => {
                let corner = cube.corners()[(dice.roll() % 8) as usize];
                let near = corner
                    + random(&mut dice) * libm::exp2(-(f64::from(dice.roll() as u32) % 53.0));
                let (u, v) = (random(&mut dice) * 30.0, random(&mut dice) * 30.0);
                [near + u, near + v, near - (u + v)]
            }
            // A needle past an edge.
            2 => {
                let a = DVec3::new(0.5, 0.5, dice.real() * 0.5);
                let d = random(&mut dice) * 4.0;
                let thin = random(&mut dice) * 1e-14;
                [a - d, a + d, a + d + thin]
            }
            // In or nearly in a face.
            3 => {
                let height =
                    [0.5, 0.5 + f64::EPSILON, 0.5 - f64::EPSILON][(dice.roll() % 3) as usize];
                let flat =
                    |dice: &mut Dice| DVec3::new(dice.real() * 2.0, dice.real() * 2.0, height);
                [flat(&mut dice), flat(&mut dice), flat(&mut dice)]
            }
            // One vertex a few units in the last place outside.
            _ => {
                let p = DVec3::new(
                    0.5 * (1.0 + f64::EPSILON * dice.integer(3) as f64),
                    dice.real(),
                    dice.real(),
                );
                let out = DVec3::new(1.0 + dice.real().abs(), dice.real(), dice.real());
                [p, out, p + random(&mut dice)]
            }
        };
        let mut cube = cube;
        for p in &mut triangle {
            *p *= scale;
        }
        cube = Aabb::new(cube.min * scale, cube.max * scale);
        let verdict = triangle_meets_cube(&triangle, &cube);
        assert_eq!(
            verdict.meets,
            clipping(&triangle, &cube),
            "{triangle:?} {cube:?}"
        );
        count(&mut steps, verdict.step);
    }
    println!("decided at vertex, face, edge, diagonal: {steps:?}");
}

#[test]
fn where_products_underflow_or_overflow_the_answer_is_never_a_wrong_no() {
    let mut dice = Dice(3);
    for case in 0..cases() / 4 {
        let exponent = [-1074, -1060, -1000, -700, 400, 1020][(case % 6) as usize];
        let scale = |p: DVec3| DVec3::from_array(p.to_array().map(|x| libm::ldexp(x, exponent)));
        let triangle: [DVec3; 3] = std::array::from_fn(|_| {
            let mut x = || dice.integer(6) as f64;
            scale(DVec3::new(x(), x(), x()))
        });
        let half = scale(DVec3::splat(1.0 + dice.integer(2).abs() as f64));
        let cube = Aabb::new(-half, half);
        let verdict = triangle_meets_cube(&triangle, &cube);
        assert!(
            verdict.meets || !clipping(&triangle, &cube),
            "{triangle:?} {cube:?}"
        );
    }
}
