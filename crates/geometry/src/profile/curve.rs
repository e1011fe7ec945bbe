//! Rational Bézier curves in the plane, up to degree 3.

use octray_math::bernstein::Bernstein;
use octray_math::{DVec2, DVec3};

/// A straight, quadratic or cubic Bézier curve with positive weights: a circular arc of less than
/// half a turn is a quadratic one (Farin, *Curves and Surfaces for CAGD*, chapter 12).
///
/// The outer weights are 1, so the end points are exactly the outer control points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    degree: usize,
    /// `(w x, w y, w)`.
    points: [DVec3; 4],
}

impl Curve {
    /// The straight line from `a` to `b`.
    #[must_use]
    pub fn line(a: DVec2, b: DVec2) -> Self {
        Self::weighted(&[a.extend(1.0), b.extend(1.0)])
    }

    /// The Bézier curve with these control points, two to four.
    #[must_use]
    pub fn bezier(control: &[DVec2]) -> Self {
        let points: Vec<DVec3> = control.iter().map(|p| p.extend(1.0)).collect();
        Self::weighted(&points)
    }

    /// The arc about `center` from `a` to `b`, less than half a turn.
    #[must_use]
    pub fn arc(center: DVec2, a: DVec2, b: DVec2) -> Self {
        let (u, v) = (a - center, b - center);
        let square = (u.length_squared() + v.length_squared()) * 0.5;
        let cosine = u.dot(v) / square;
        // The tangents meet on the bisector; the weight is the cosine of half the angle.
        let corner = center + (u + v) / (1.0 + cosine);
        let weight = ((1.0 + cosine) * 0.5).sqrt();
        Self::weighted(&[
            a.extend(1.0),
            (corner * weight).extend(weight),
            b.extend(1.0),
        ])
    }

    fn weighted(all: &[DVec3]) -> Self {
        let mut points = [DVec3::Z; 4];
        let count = all.len().min(4);
        points[..count].copy_from_slice(&all[..count]);
        Self {
            degree: count.max(2) - 1,
            points,
        }
    }

    /// The curve with these [`Curve::weighted_points`], two to four.
    ///
    /// `None` where a weight is not positive, or one of the outer ones not 1.
    pub(crate) fn from_weighted(all: &[DVec3]) -> Option<Self> {
        let outer = [all.first()?, all.last()?];
        let has_weight = all.iter().all(|p| p.z > 0.0 && p.is_finite());
        (has_weight && outer.iter().all(|p| p.z == 1.0)).then(|| Self::weighted(all))
    }

    /// The control points, times their weights, and the weights.
    #[must_use]
    pub fn weighted_points(&self) -> &[DVec3] {
        &self.points[..=self.degree]
    }

    /// The control points.
    pub fn control(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.weighted_points().iter().map(|p| p.truncate() / p.z)
    }

    /// Where it begins.
    #[must_use]
    pub const fn start(&self) -> DVec2 {
        place(self.points[0])
    }

    /// Where it ends.
    #[must_use]
    pub const fn end(&self) -> DVec2 {
        place(self.points[self.degree])
    }

    /// Whether it is a straight line.
    #[must_use]
    pub const fn is_line(&self) -> bool {
        self.degree == 1
    }

    /// The point at `u` in `[0, 1]`.
    #[must_use]
    pub fn at(&self, u: f64) -> DVec2 {
        if u <= 0.0 {
            return self.start();
        }
        if u >= 1.0 {
            return self.end();
        }
        let p = self.casteljau(u, |_, _| {});
        p.truncate() / p.z
    }

    /// The direction in which it runs at `u`, of any length; 0 at a cusp.
    #[must_use]
    pub fn direction(&self, u: f64) -> DVec2 {
        let mut last = [DVec3::Z; 2];
        self.casteljau(u, |level, points| {
            if level == 1 {
                last = [points[0], points[1]];
            }
        });
        let [a, b] = last;
        // The two points of the last level span the tangent.
        b.truncate() / b.z - a.truncate() / a.z
    }

    /// `visit` sees the points of every level, with how many steps remain.
    fn casteljau(&self, u: f64, mut visit: impl FnMut(usize, &[DVec3])) -> DVec3 {
        let mut points = self.points;
        for level in (1..=self.degree).rev() {
            visit(level, &points[..=level]);
            for i in 0..level {
                points[i] = points[i] + (points[i + 1] - points[i]) * u;
            }
        }
        points[0]
    }

    /// The curve under a linear map of the plane and a shift.
    #[must_use]
    pub fn mapped(&self, map: &impl Fn(DVec2) -> DVec2) -> Self {
        let mut all = *self;
        for p in &mut all.points[..=self.degree] {
            *p = (map(place(*p)) * p.z).extend(p.z);
        }
        all
    }

    /// The two halves. Those of a quadratic curve get outer weights of 1 again; of a cubic one
    /// with weights they do not.
    #[must_use]
    pub fn halves(&self) -> [Self; 2] {
        self.split(0.5)
    }

    /// The same with other end points, near those it has.
    pub(super) fn with_ends(mut self, start: DVec2, end: DVec2) -> Self {
        self.points[0] = start.extend(1.0);
        self.points[self.degree] = end.extend(1.0);
        self
    }

    /// The same with no control point at negative x: of a curve that bends once and lies at
    /// positive x they are there by rounding alone.
    pub(super) fn clamped(mut self) -> Self {
        self.points.iter_mut().for_each(|p| p.x = p.x.max(0.0));
        self
    }

    /// A quadratic curve with outer weights of 1 (Farin, section 12.5).
    fn standard(mut self) -> Self {
        let [a, b, c] = [self.points[0], self.points[1], self.points[2]];
        let weight = b.z / (a.z * c.z).sqrt();
        self.points[0] = place(a).extend(1.0);
        self.points[1] = (place(b) * weight).extend(weight);
        self.points[2] = place(c).extend(1.0);
        self
    }

    /// The part from `u` in `(0, 1)` on, and what comes before it, in order; for curves of degree 1
    /// or 2, and for cubic ones without weights.
    #[must_use]
    pub fn split(&self, u: f64) -> [Self; 2] {
        let (mut left, mut right) = (*self, *self);
        let mut points = self.points;
        for level in (1..=self.degree).rev() {
            for i in 0..level {
                points[i] = points[i] + (points[i + 1] - points[i]) * u;
            }
            left.points[self.degree - level + 1] = points[0];
            right.points[level - 1] = points[level - 1];
        }
        if self.degree == 2 {
            [left, right].map(Self::standard)
        } else {
            [left, right]
        }
    }

    /// `x`-, `y`- and weight-polynomial combined: `a x + b y + c w`, times the weight.
    #[must_use]
    pub fn combined(&self, a: f64, b: f64, c: f64) -> Bernstein {
        let mut values = [0.0; 4];
        for (value, p) in values.iter_mut().zip(self.weighted_points()) {
            *value = a * p.x + b * p.y + c * p.z;
        }
        Bernstein::new(&values[..=self.degree])
    }

    /// The box around the control points: lowest and highest corner.
    #[must_use]
    pub fn bounds(&self) -> [DVec2; 2] {
        let mut bounds = [self.start(), self.start()];
        for p in self.control() {
            bounds = [bounds[0].min(p), bounds[1].max(p)];
        }
        bounds
    }
}

const fn place(p: DVec3) -> DVec2 {
    DVec2::new(p.x / p.z, p.y / p.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_are_round() {
        let center = DVec2::new(1.0, -2.0);
        let arc = Curve::arc(center, center + DVec2::X * 3.0, center + DVec2::Y * 3.0);
        for i in 0..=20 {
            let u = f64::from(i) / 20.0;
            let p = arc.at(u) - center;
            assert!((p.length() - 3.0).abs() < 1e-15 * 8.0, "{p}");
            assert!(p.dot(arc.direction(u)).abs() < 1e-13, "{u}");
        }
        assert_eq!(arc.at(1.0), center + DVec2::Y * 3.0);
    }

    #[test]
    fn halves_are_the_curve() {
        let cubic = Curve::bezier(&[
            DVec2::ZERO,
            DVec2::new(1.0, 2.0),
            DVec2::new(3.0, -1.0),
            DVec2::new(4.0, 0.0),
        ]);
        let [left, right] = cubic.halves();
        assert_eq!(left.end(), right.start());
        for i in 0..=10 {
            let u = f64::from(i) / 10.0;
            assert!((left.at(u) - cubic.at(u * 0.5)).length() < 1e-15);
            assert!((right.at(u) - cubic.at(0.5 + u * 0.5)).length() < 4e-15);
        }
    }
}
