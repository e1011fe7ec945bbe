//! The triangle-cube test against two oracles, both exact: clipping in rational numbers and the
//! separating-axis theorem in integers.

#![expect(
    clippy::print_stdout,
    reason = "how many cases each step decides is worth seeing"
)]

use num_bigint::BigInt;
use octray_math::{Aabb, DVec3, hash_combine};
use octray_tree::triangle_cube::{Step, triangle_meets_cube};

/// Cases per family; `OCTRAY_CASES` multiplies it: with 250 a million of each.
fn cases() -> u64 {
    let times = std::env::var("OCTRAY_CASES")
        .ok()
        .and_then(|n| n.parse().ok());
    4_000 * times.unwrap_or(1)
}

/// Homogeneous coordinates x, y, z, w in integers, `w > 0`: a rational point.
type Point = [BigInt; 4];

/// An odd number, or zero, and the power of two that makes `x` of it.
fn odd_part(x: f64) -> (u64, i32) {
    let bits = x.abs().to_bits();
    let (exponent, fraction) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
    let (odd, power) = match exponent {
        0 => (fraction, -1074),
        e => (fraction | 1 << 52, e - 1075),
    };
    let zeros = odd.trailing_zeros();
    if odd == 0 {
        (0, 0)
    } else {
        (odd >> zeros, power + zeros as i32)
    }
}

/// A triangle and a box, all coordinates as integers of one unit: the largest power of two of which
/// each of them is a multiple.
struct Exact {
    triangle: [[BigInt; 3]; 3],
    min: [BigInt; 3],
    max: [BigInt; 3],
}

impl Exact {
    fn new(triangle: &[DVec3; 3], cube: &Aabb) -> Self {
        let [a, b, c] = triangle.map(|p| p.to_array());
        let all = [a, b, c, cube.min.to_array(), cube.max.to_array()];
        let powers = all.iter().flatten().filter(|x| **x != 0.0);
        let unit = powers.map(|x| odd_part(*x).1).min().unwrap_or(0);
        let whole = |x: f64| {
            let (odd, power) = odd_part(x);
            let size = BigInt::from(odd) << (power - unit).max(0);
            if x < 0.0 { -size } else { size }
        };
        let [a, b, c, min, max] = all.map(|p| p.map(whole));
        Self {
            triangle: [a, b, c],
            min,
            max,
        }
    }

    fn corners(&self) -> [[BigInt; 3]; 8] {
        std::array::from_fn(|corner| {
            std::array::from_fn(|axis| {
                let end = if corner >> axis & 1 == 1 {
                    &self.max
                } else {
                    &self.min
                };
                end[axis].clone()
            })
        })
    }
}

/// Whether anything is left of the triangle after clipping it by the six faces (Sutherland and
/// Hodgman 1974), in rational numbers.
fn clipping(exact: &Exact) -> bool {
    let zero = BigInt::from(0);
    let mut polygon: Vec<Point> = exact
        .triangle
        .iter()
        .map(|[x, y, z]| [x.clone(), y.clone(), z.clone(), BigInt::from(1)])
        .collect();
    for axis in 0..3 {
        for (bound, keep_below) in [(&exact.max[axis], true), (&exact.min[axis], false)] {
            let height = |p: &Point| {
                let above = &p[axis] - bound * &p[3];
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

/// The separating-axis theorem (Akenine-Moller 2001), thirteen axes, in integers.
fn separating_axes(exact: &Exact) -> bool {
    type Vector = [BigInt; 3];
    let corners = exact.corners();
    let points = &exact.triangle;
    let sub = |a: &Vector, b: &Vector| -> Vector { std::array::from_fn(|i| &a[i] - &b[i]) };
    let cross = |a: &Vector, b: &Vector| -> Vector {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            &a[j] * &b[k] - &a[k] * &b[j]
        })
    };
    let unit = |axis: usize| -> Vector { std::array::from_fn(|i| BigInt::from(i == axis)) };
    let edges = [(1, 0), (2, 1), (0, 2)].map(|(i, j)| sub(&points[i], &points[j]));
    let mut axes = vec![cross(&edges[0], &edges[1])];
    for axis in 0..3 {
        axes.push(unit(axis));
        axes.extend(edges.each_ref().map(|edge| cross(edge, &unit(axis))));
    }
    let along = |axis: &Vector, p: &Vector| (0..3).map(|i| &axis[i] * &p[i]).sum::<BigInt>();
    let range = |axis: &Vector, all: &[Vector]| {
        let values: Vec<BigInt> = all.iter().map(|p| along(axis, p)).collect();
        (values.iter().min().cloned(), values.iter().max().cloned())
    };
    axes.iter().all(|axis| {
        let (a, b) = (range(axis, points), range(axis, &corners));
        a.1 >= b.0 && b.1 >= a.0
    })
}

/// What both oracles say; they must be of one mind.
fn oracles(triangle: &[DVec3; 3], cube: &Aabb) -> bool {
    let exact = Exact::new(triangle, cube);
    let meets = separating_axes(&exact);
    assert_eq!(clipping(&exact), meets, "{triangle:?} {cube:?}");
    meets
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
    let mut all = [0; 4];
    // Small ranges make touching faces, edges and vertices, and triangles without area, common.
    for range in [2, 3, 5, 9, 40, 1 << 18] {
        let mut steps = [0; 4];
        for _ in 0..cases() {
            let triangle: [[i64; 3]; 3] =
                std::array::from_fn(|_| std::array::from_fn(|_| dice.integer(range)));
            let half = 1 + dice.integer(range).abs() / 2;
            let center: [i64; 3] = std::array::from_fn(|_| dice.integer(range) / 2);
            let (min, max) = (center.map(|c| c - half), center.map(|c| c + half));
            let real = |p: [i64; 3]| DVec3::from_array(p.map(|x| x as f64));
            let cube = Aabb::new(real(min), real(max));
            let verdict = triangle_meets_cube(&triangle.map(real), &cube);
            let expected = oracles(&triangle.map(real), &cube);
            assert_eq!(verdict.meets, expected, "{triangle:?} {min:?} {max:?}");
            count(&mut steps, verdict.step);
            count(&mut all, verdict.step);
        }
        println!("integers to {range}: vertex, face, edge, diagonal {steps:?}");
    }
    assert!(all.iter().all(|&n| n > 0), "every step is reached: {all:?}");
}

#[test]
fn adversarial_triangles_agree_with_both_oracles() {
    const FAMILIES: [&str; 5] = [
        "random",
        "near a corner",
        "needle",
        "in a face",
        "near a face",
    ];
    let mut dice = Dice(2);
    let mut steps = [[0; 4]; FAMILIES.len()];
    for case in 0..cases() * FAMILIES.len() as u64 {
        let scale = libm::exp2(dice.integer(30) as f64);
        let random = |dice: &mut Dice| DVec3::new(dice.real(), dice.real(), dice.real());
        let cube = Aabb::new(DVec3::splat(-0.5), DVec3::splat(0.5));
        let mut triangle = match case % FAMILIES.len() as u64 {
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
            oracles(&triangle, &cube),
            "{triangle:?} {cube:?}"
        );
        count(&mut steps[case as usize % FAMILIES.len()], verdict.step);
    }
    for (family, steps) in FAMILIES.iter().zip(&steps) {
        println!("{family}: vertex, face, edge, diagonal {steps:?}");
    }
}

#[test]
fn where_products_underflow_or_overflow_the_answer_is_never_a_wrong_no() {
    const EXPONENTS: [i32; 6] = [-1074, -1060, -1000, -700, 400, 1020];
    let mut dice = Dice(3);
    let mut ties = [0; EXPONENTS.len()];
    for case in 0..cases() * EXPONENTS.len() as u64 {
        let kind = (case % EXPONENTS.len() as u64) as usize;
        let exponent = EXPONENTS[kind];
        let scale = |p: DVec3| DVec3::from_array(p.to_array().map(|x| libm::ldexp(x, exponent)));
        let triangle: [DVec3; 3] = std::array::from_fn(|_| {
            let mut x = || dice.integer(6) as f64;
            scale(DVec3::new(x(), x(), x()))
        });
        let half = scale(DVec3::splat(1.0 + dice.integer(2).abs() as f64));
        let cube = Aabb::new(-half, half);
        let verdict = triangle_meets_cube(&triangle, &cube);
        let expected = oracles(&triangle, &cube);
        // What rounding left open is taken for a yes.
        assert!(verdict.meets || !expected, "{triangle:?} {cube:?}");
        ties[kind] += u64::from(verdict.meets != expected);
    }
    for (exponent, ties) in EXPONENTS.iter().zip(&ties) {
        println!("coordinates of 2^{exponent}: {ties} ties taken for a yes");
    }
}
