//! Pieces of plane curves between points from which one sees where their tangents meet: then a piece
//! lies in the triangle of its ends and that point.

use octray_math::DVec2;

use super::band::Band;
use crate::profile::Curve;

/// A piece of a curve that bends to one side.
pub(super) trait PlaneCurve: Sized {
    /// Where it begins and ends.
    fn ends(&self) -> [DVec2; 2];
    /// Points whose convex hull holds the piece, near to it.
    fn hull(&self) -> Vec<DVec2>;
    /// The piece, cut.
    fn halves(&self) -> [Self; 2];

    fn band(&self) -> Band {
        Band::around(self.ends(), &self.hull())
    }

    /// How many times as far from the origin as its chord it is, seen along a ray: least and most. The
    /// ends are seen within less than half a turn.
    fn reach(&self) -> [f64; 2] {
        let [a, b] = self.ends();
        let normal = (b - a).perp();
        let distance = normal.dot(a);
        let mut reach: [f64; 2] = [1.0, 1.0];
        for p in self.hull() {
            let ratio = normal.dot(p) / distance;
            // The chord of a cusp may pass through the origin, as far as rounding tells.
            let ratio = if ratio.is_finite() {
                ratio.max(0.0)
            } else {
                0.0
            };
            reach = [reach[0].min(ratio), reach[1].max(ratio)];
        }
        reach
    }
}

impl PlaneCurve for Curve {
    fn ends(&self) -> [DVec2; 2] {
        [self.start(), self.end()]
    }

    fn hull(&self) -> Vec<DVec2> {
        let halves = Self::halves(self);
        halves
            .iter()
            .flat_map(|half| half.control().collect::<Vec<_>>())
            .collect()
    }

    fn halves(&self) -> [Self; 2] {
        Self::halves(self)
    }
}

/// What a piece of a conic section is in a frame of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ConicKind {
    /// `(cos s, sin s)`
    Circle,
    /// `(cosh s, sinh s)`
    Hyperbola,
    /// `(s, s^2)`
    Parabola,
}

/// A piece of a conic section: of a circle at most a third.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conic {
    pub(super) kind: ConicKind,
    /// What the axes of its own frame are in the plane.
    pub(super) axes: [DVec2; 2],
    /// First and last parameter.
    pub(super) span: [f64; 2],
}

impl Conic {
    fn place(&self, x: f64, y: f64) -> DVec2 {
        self.axes[0] * x + self.axes[1] * y
    }

    fn at(&self, s: f64) -> DVec2 {
        match self.kind {
            ConicKind::Circle => self.place(libm::cos(s), libm::sin(s)),
            ConicKind::Hyperbola => self.place(libm::cosh(s), libm::sinh(s)),
            ConicKind::Parabola => self.place(s, s * s),
        }
    }

    /// Where the tangents meet.
    fn pole(&self, [from, to]: [f64; 2]) -> DVec2 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        match self.kind {
            ConicKind::Circle => self.at(middle) / libm::cos(half),
            ConicKind::Hyperbola => self.at(middle) / libm::cosh(half),
            ConicKind::Parabola => self.place(middle, from * to),
        }
    }

    fn middle(&self) -> f64 {
        0.5 * (self.span[0] + self.span[1])
    }
}

impl PlaneCurve for Conic {
    fn ends(&self) -> [DVec2; 2] {
        self.span.map(|s| self.at(s))
    }

    fn hull(&self) -> Vec<DVec2> {
        let ([from, to], middle) = (self.span, self.middle());
        let poles = [[from, middle], [middle, to]].map(|span| self.pole(span));
        let [a, b] = self.ends();
        vec![a, poles[0], poles[1], b]
    }

    fn halves(&self) -> [Self; 2] {
        let ([from, to], middle) = (self.span, self.middle());
        [[from, middle], [middle, to]].map(|span| Self { span, ..*self })
    }
}

/// A piece of the curve `x^power + y^power = 1` at positive x and y (Lamé).
#[derive(Clone, Copy, Debug)]
pub(super) struct Lame {
    power: f64,
    /// Towards its ends, of length 1.
    directions: [DVec2; 2],
}

impl Lame {
    /// From the x axis to the y axis.
    pub(super) const fn quarter(power: f64) -> Self {
        Self {
            power,
            directions: [DVec2::X, DVec2::Y],
        }
    }

    fn at(&self, direction: DVec2) -> DVec2 {
        let (x, y) = (direction.x, direction.y);
        let (most, least) = if x > y { (x, y) } else { (y, x) };
        let sum = libm::log1p(libm::pow(least / most, self.power));
        direction / (most * libm::exp(sum / self.power))
    }

    /// The normal, of any length.
    fn normal(&self, p: DVec2) -> DVec2 {
        let ratio = libm::pow(p.y / p.x, self.power - 1.0);
        if ratio > 1.0 {
            DVec2::new(1.0 / ratio, 1.0)
        } else {
            DVec2::new(1.0, ratio)
        }
    }

    /// Where the tangents at two points meet, or a corner of the box between the points, beyond that.
    fn pole(&self, a: DVec2, b: DVec2) -> DVec2 {
        let (m, n) = (self.normal(a), self.normal(b));
        let (low, high) = (a.min(b), a.max(b));
        let turn = m.perp_dot(n);
        if turn == 0.0 {
            // Straight.
            return a;
        }
        let (u, v) = (m.dot(a), n.dot(b));
        let met = DVec2::new(u * n.y - v * m.y, v * m.x - u * n.x) / turn;
        if met.cmpge(low).all() && met.cmple(high).all() {
            met
        } else if self.power < 1.0 {
            low
        } else {
            high
        }
    }

    fn middle(&self) -> DVec2 {
        (self.directions[0] + self.directions[1]).normalize()
    }
}

impl PlaneCurve for Lame {
    fn ends(&self) -> [DVec2; 2] {
        self.directions.map(|d| self.at(d))
    }

    fn hull(&self) -> Vec<DVec2> {
        let [a, b] = self.ends();
        let middle = self.at(self.middle());
        vec![a, self.pole(a, middle), middle, self.pole(middle, b), b]
    }

    fn halves(&self) -> [Self; 2] {
        let ([a, b], middle) = (self.directions, self.middle());
        [[a, middle], [middle, b]].map(|directions| Self {
            directions,
            ..*self
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a point lies in the convex hull of others, up to `slack`: on no side of any line
    /// through two of them on which none of them lies.
    fn holds(hull: &[DVec2], p: DVec2, slack: f64) -> bool {
        let directions = hull
            .iter()
            .flat_map(|a| hull.iter().map(|b| (*b - *a).perp()));
        directions.filter(|d| d.length() > 1e-300).all(|d| {
            let d = d.normalize();
            let most = hull
                .iter()
                .map(|q| d.dot(*q))
                .fold(f64::NEG_INFINITY, f64::max);
            d.dot(p) <= most + slack
        })
    }

    fn check(piece: &impl PlaneCurve, points: &[DVec2], name: &str) {
        let (hull, band) = (piece.hull(), piece.band());
        for p in points {
            assert!(holds(&hull, *p, 1e-9), "{name}: {p} outside of {hull:?}");
            assert!(
                holds(&band.corners(), *p, 1e-9),
                "{name}: {p} outside of {band:?}"
            );
        }
    }

    fn check_reach(piece: &impl PlaneCurve, points: &[DVec2], name: &str) {
        let (reach, [a, b]) = (piece.reach(), piece.ends());
        for p in points {
            // On the ray through p, the chord is where cross(c - a, b - a) = 0.
            let ratio = (b - a).perp_dot(*p) / (b - a).perp_dot(a);
            if ratio.is_finite() {
                let is_within = reach[0] - 1e-9 <= ratio && ratio <= reach[1] + 1e-9;
                assert!(is_within, "{name}: {ratio} beyond {reach:?}");
            }
        }
    }

    #[test]
    fn pieces_lie_in_their_hulls() {
        for power in [1e-2, 0.3, 0.9, 1.0, 1.1, 2.0, 5.0, 700.0, 2e6] {
            let mut pieces = vec![Lame::quarter(power)];
            for _ in 0..5 {
                pieces = pieces.iter().flat_map(Lame::halves).collect();
                for piece in &pieces {
                    let [u, v] = piece.directions;
                    let points: Vec<DVec2> = (0..=50)
                        .map(|i| f64::from(i) / 50.0)
                        .map(|t| piece.at((u * (1.0 - t) + v * t).normalize()))
                        .collect();
                    for p in points.iter().filter(|p| p.min_element() > 0.0) {
                        let sum = libm::pow(p.x, power) + libm::pow(p.y, power);
                        assert!(
                            (libm::pow(sum, 1.0 / power) - 1.0).abs() < 1e-8,
                            "{power}: {p}"
                        );
                    }
                    check(piece, &points, &format!("power {power}"));
                    check_reach(piece, &points, &format!("power {power}"));
                }
            }
        }
        for (kind, span) in [
            (ConicKind::Circle, [-0.4, 1.4]),
            (ConicKind::Hyperbola, [-3.0, 1.0]),
            (ConicKind::Hyperbola, [0.5, 6.0]),
            (ConicKind::Parabola, [-2.0, 5.0]),
        ] {
            let axes = [DVec2::X, DVec2::Y];
            let conic = Conic { kind, axes, span };
            for piece in [conic].into_iter().chain(conic.halves()) {
                let at =
                    |i: u32| piece.span[0] + (piece.span[1] - piece.span[0]) * f64::from(i) / 50.0;
                let points: Vec<DVec2> = (0..=50).map(|i| piece.at(at(i))).collect();
                for p in &points {
                    let zero = match kind {
                        ConicKind::Circle => p.x * p.x + p.y * p.y - 1.0,
                        ConicKind::Hyperbola => p.x * p.x - p.y * p.y - 1.0,
                        ConicKind::Parabola => p.x * p.x - p.y,
                    };
                    assert!(zero.abs() < 1e-9, "{p}");
                }
                check(&piece, &points, &format!("{kind:?}"));
                if kind == ConicKind::Circle {
                    check_reach(&piece, &points, "circle");
                }
            }
        }
    }
}
