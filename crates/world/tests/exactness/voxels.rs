//! The oracle for solids of unit cubes: integers only, no rounding anywhere.

use octray_math::{DVec3, Ray};

/// A line through a grid of `n^3` unit cubes at `[0, n]^3`: the origin in units of
/// `1 / DENOMINATOR`, the direction in whole numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridLine {
    pub(crate) origin: [i64; 3],
    pub(crate) direction: [i64; 3],
}

/// Origins are multiples of 2^-10: exact as floating-point numbers, like the directions.
pub(crate) const DENOMINATOR: i64 = 1 << 10;

/// What a line meets.
#[derive(Debug)]
pub(crate) struct Met {
    /// Stretches inside filled cubes, as far as possible.
    pub(crate) intervals: Vec<[f64; 2]>,
    /// Whether two planes of the grid are crossed at once: through an edge or a corner.
    pub(crate) edge: bool,
}

/// Crossing a plane of the grid at `t = numerator / denominator`, the denominator positive.
#[derive(Clone, Copy)]
struct Crossing {
    numerator: i64,
    denominator: i64,
    axis: usize,
}

impl GridLine {
    pub(crate) fn ray(&self) -> Ray {
        let vector = |v: [i64; 3]| DVec3::from_array(v.map(|x| x as f64));
        Ray::new(
            vector(self.origin) / DENOMINATOR as f64,
            vector(self.direction),
        )
    }

    /// The planes at `0..=n` in the order in which the line crosses them.
    fn crossings(&self, n: i64) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        for axis in 0..3 {
            let (o, d) = (self.origin[axis], self.direction[axis]);
            if d != 0 {
                crossings.extend((0..=n).map(|plane| Crossing {
                    numerator: (plane * DENOMINATOR - o) * d.signum(),
                    denominator: d.abs() * DENOMINATOR,
                    axis,
                }));
            }
        }
        crossings.sort_by(order);
        crossings
    }

    /// What the line meets of the cubes that are `filled`.
    ///
    /// A line that runs in a plane of the grid is taken to run in the cubes above it, the side on
    /// which the plane's normal is.
    pub(crate) fn met(&self, n: i64, filled: impl Fn([i64; 3]) -> bool) -> Met {
        let mut cube: [i64; 3] = std::array::from_fn(|axis| match self.direction[axis] {
            0 => self.origin[axis].div_euclid(DENOMINATOR),
            d if d > 0 => -1,
            _ => n,
        });
        let is_inside = |cube: [i64; 3]| cube.iter().all(|i| (0..n).contains(i)) && filled(cube);
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        let (mut inside, mut edge) = (false, false);
        let crossings = self.crossings(n);
        for group in crossings.chunk_by(|a, b| order(a, b).is_eq()) {
            edge |= group.len() > 1;
            for crossing in group {
                cube[crossing.axis] += self.direction[crossing.axis].signum();
            }
            let now = is_inside(cube);
            if now != inside {
                let t = group[0].numerator as f64 / group[0].denominator as f64;
                match intervals.last_mut() {
                    Some(last) if inside => last[1] = t,
                    _ => intervals.push([t, f64::INFINITY]),
                }
                inside = now;
            }
        }
        Met { intervals, edge }
    }
}

fn order(a: &Crossing, b: &Crossing) -> std::cmp::Ordering {
    let cross = |x: i64, y: i64| i128::from(x) * i128::from(y);
    cross(a.numerator, b.denominator).cmp(&cross(b.numerator, a.denominator))
}
