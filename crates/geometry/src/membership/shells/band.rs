//! Rectangles in the plane that hold a piece of a curve, and what is drawn out or turned from them.

use octray_math::{DVec2, DVec3};

use super::ShellPatch;

/// What the rounding of corners may be of their coordinates; cells are grown by far more.
const ROUNDING: f64 = 1e-14;

/// A rectangle along the chord of a piece of a curve, which lies in it: its two long sides. They are one
/// where the curve is straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    pub(super) inner: [DVec2; 2],
    pub(super) outer: [DVec2; 2],
}

impl Band {
    /// No wider than a line.
    pub(super) const fn line(ends: [DVec2; 2]) -> Self {
        Self {
            inner: ends,
            outer: ends,
        }
    }

    /// The smallest one along a chord that holds these points; where the chord has no length, along an axis.
    pub(super) fn around(chord: [DVec2; 2], points: &[DVec2]) -> Self {
        let origin = chord[0];
        if let Some(along) = (chord[1] - origin).try_normalize() {
            return Self::along(along, origin, points);
        }
        let upright = Self::along(DVec2::Y, origin, points);
        let level = Self::along(DVec2::X, origin, points);
        if upright.thickness() < level.thickness() {
            upright
        } else {
            level
        }
    }

    fn along(along: DVec2, origin: DVec2, points: &[DVec2]) -> Self {
        let across = along.perp();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in points {
            let q = DVec2::new(along.dot(*p - origin), across.dot(*p - origin));
            (low, high) = (low.min(q), high.max(q));
        }
        let corner = |x: f64, y: f64| origin + along * x + across * y;
        Self {
            inner: [corner(low.x, low.y), corner(high.x, low.y)],
            outer: [corner(low.x, high.y), corner(high.x, high.y)],
        }
    }

    pub(super) const fn corners(&self) -> [DVec2; 4] {
        let ([a, b], [d, c]) = (self.inner, self.outer);
        [a, b, c, d]
    }

    /// The distance of its long sides.
    pub(super) fn thickness(&self) -> f64 {
        self.inner[0].distance(self.outer[0])
    }

    /// The largest abscissa.
    pub(super) fn most_x(&self) -> f64 {
        self.corners().iter().fold(0.0, |most, p| p.x.max(most))
    }

    /// One that holds, of the points of this one that are not on the left of the y axis, all that have
    /// `reach[0]` to `reach[1]` times their abscissa; it does not reach to the left either. (A quadrilateral
    /// that does would turn into a bow tie.)
    pub(super) fn stretched(&self, reach: [f64; 2]) -> Self {
        let scaled = |p: DVec2| reach.map(|k| DVec2::new(p.x * k, p.y));
        let stretched = if reach == [1.0; 2] {
            *self
        } else if self.inner == self.outer && self.inner[0].y == self.inner[1].y {
            // To the bit as flat as it is.
            let [near, far] = if self.inner[0].x <= self.inner[1].x {
                self.inner
            } else {
                [self.inner[1], self.inner[0]]
            };
            Self::line([scaled(near)[0], scaled(far)[1]])
        } else {
            Self::around(self.inner, self.corners().map(scaled).as_flattened())
        };
        let corners = stretched.corners();
        let right = |p: DVec2| p.max(DVec2::new(0.0, f64::NEG_INFINITY));
        let size = corners.iter().fold(0.0, |most, p| p.length().max(most));
        if corners.iter().all(|p| p.x >= -ROUNDING * size) {
            return Self {
                inner: stretched.inner.map(right),
                outer: stretched.outer.map(right),
            };
        }
        Self::around([right(corners[0]); 2], &corners.map(right))
    }

    /// Both triangles of the quadrilateral that each of the sides becomes when it moves from one end to
    /// the other, where `place` puts its points in space. What a side becomes must be plane.
    pub(super) fn swept(&self, place: impl Fn(DVec2, usize) -> DVec3) -> [ShellPatch; 2] {
        let quad = |side: &[DVec2; 2]| {
            [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(corner, end)| place(side[corner], end))
        };
        let (inner, outer) = (quad(&self.inner), quad(&self.outer));
        [[0, 1, 2], [0, 2, 3]].map(|t| ShellPatch {
            inner: t.map(|i| inner[i]),
            outer: t.map(|i| outer[i]),
        })
    }
}

/// Both triangles of each side of a band that turns from one direction to another, if what is there of
/// the turn lies `reach[0]` to `reach[1]` times as far from the axis as its chord.
pub(super) fn facet(band: &Band, directions: [DVec2; 2], reach: [f64; 2]) -> [ShellPatch; 2] {
    band.stretched(reach)
        .swept(|p, end| (directions[end] * p.x).extend(p.y))
}
