//! Integrals over all lines through a solid, by plain grids of parallel rays.

use octray_geometry::Solid;
use octray_math::{DQuat, DVec3, Ray};

use crate::draw::Draw;
use crate::subject::{Subject, cases};

/// How many independent estimates the standard error is taken from.
const REPLICATES: u64 = 24;

/// Grids of `side * side` parallel rays in each of `directions` directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayGrid {
    directions: u32,
    side: u32,
}

/// A mean of independent estimates, with its standard error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    standard_error: f64,
}

impl Estimate {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
        Self {
            mean,
            standard_error: (squares / (count - 1.0) / count).sqrt(),
        }
    }

    /// Asserts that the exact value lies within four standard errors and within `share` of itself.
    #[track_caller]
    pub(crate) fn assert_near(&self, exact: f64, share: f64, what: &str) {
        let off = (self.mean - exact).abs();
        // Without any spread at all only rounding is left.
        let sigmas = 4.0 * self.standard_error + 1e-12 * exact;
        assert!(
            off <= sigmas && off <= share * exact,
            "{what}: {self:?}, exactly {exact}: off by {:e}, {:.1} sigma",
            off / exact,
            off / self.standard_error
        );
    }
}

impl RayGrid {
    /// For what does not depend on the direction: one grid in one random direction each time.
    pub(crate) fn one_way() -> Self {
        let rays = cases(600) as f64;
        Self {
            directions: 1,
            side: rays.sqrt() as u32,
        }
    }

    /// For means over all directions.
    pub(crate) fn all_ways() -> Self {
        let rays = cases(1500) as f64;
        // As many directions as rays in the width of a grid, so that both errors fall.
        let side = rays.cbrt() as u32;
        Self {
            directions: 2 * side,
            side,
        }
    }

    /// What an estimate may be off by at most, as a share, given grids of this fineness.
    pub(crate) fn coarseness(&self) -> f64 {
        0.5 / (f64::from(self.side) * f64::from(self.directions).sqrt())
    }

    /// For every `what`, the integral of what it makes of the intervals of a line, over all lines
    /// of one direction, averaged over the directions.
    pub(crate) fn integrals<const N: usize>(
        &self,
        solid: &Solid,
        what: impl Fn(&[[f64; 2]]) -> [f64; N],
    ) -> [Estimate; N] {
        let subject = Subject::one(solid);
        let bounds = solid.bounds();
        let mut values = [[0.0; REPLICATES as usize]; N];
        for replicate in 0..REPLICATES {
            let draw = &mut Draw::new(40, replicate);
            let turn = rotation(draw);
            for index in 0..self.directions {
                let toward = turn * fibonacci(index, self.directions);
                let (u, v) = toward.any_orthonormal_pair();
                let center = bounds.center();
                let reach = |axis: DVec3| {
                    let corners = bounds.corners().into_iter();
                    let far = corners.map(|c| (c - center).dot(axis).abs());
                    far.fold(0.0, f64::max)
                };
                // One cell more, so that the grid covers the solid wherever it is shifted to.
                let cells = f64::from(self.side);
                let steps = [u, v].map(|axis| axis * (2.0 * reach(axis) / cells));
                let area = steps[0].length() * steps[1].length();
                let shift = [draw.unit(), draw.unit()];
                for i in 0..(self.side + 1) * (self.side + 1) {
                    let place = [i / (self.side + 1), i % (self.side + 1)];
                    let at = |axis: usize| f64::from(place[axis]) - shift[axis] - 0.5 * cells;
                    let origin = center + steps[0] * at(0) + steps[1] * at(1);
                    let met = subject.intervals(Ray::new(origin, toward));
                    for (sum, part) in values.iter_mut().zip(what(&met)) {
                        sum[replicate as usize] += part * area / f64::from(self.directions);
                    }
                }
            }
        }
        values.map(|of_one| Estimate::of(&of_one))
    }

    /// The volume: chords times the area of a cell.
    pub(crate) fn volume(&self, solid: &Solid) -> Estimate {
        let [volume] = self.integrals(solid, |met| [met.iter().map(|[s, e]| e - s).sum()]);
        volume
    }

    /// The area of the boundary: twice the crossings of a mean direction (Crofton).
    pub(crate) fn area(&self, solid: &Solid) -> Estimate {
        let [area] = self.integrals(solid, |met| [4.0 * met.len() as f64]);
        area
    }
}

/// Evenly among all rotations (Shoemake 1992).
fn rotation(draw: &mut Draw) -> DQuat {
    let share = draw.unit();
    let [a, b] = [0, 1].map(|_| std::f64::consts::TAU * draw.unit());
    let (r, s) = ((1.0 - share).sqrt(), share.sqrt());
    DQuat::from_xyzw(r * a.sin(), r * a.cos(), s * b.sin(), s * b.cos())
}

/// A point of the golden spiral on the sphere: evenly spread.
fn fibonacci(index: u32, count: u32) -> DVec3 {
    let z = 1.0 - (2.0 * f64::from(index) + 1.0) / f64::from(count);
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let (sin, cos) = (golden * f64::from(index)).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

#[test]
fn a_wrong_volume_is_noticed() {
    let grid = RayGrid::one_way();
    let ball = Solid::sphere(1.0).expect("valid");
    let exact = 4.0 / 3.0 * std::f64::consts::PI;
    let estimate = grid.volume(&ball);
    estimate.assert_near(exact, grid.coarseness(), "ball");
    for wrong in [0.97 * exact, 1.03 * exact] {
        let assertion = || estimate.assert_near(wrong, grid.coarseness(), "not the ball");
        assert!(std::panic::catch_unwind(assertion).is_err());
    }
}
