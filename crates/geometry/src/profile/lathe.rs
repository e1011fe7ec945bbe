//! Regions turned about the z axis.

use octray_math::{Aabb, DAffine3, DVec2, DVec3, transform};

use super::curve::Curve;
use super::decompose::{Decomposition, PlaneSide, Wishes};
use super::formula::Formula;
use super::pieces::Piece;
use super::region::Region;
use crate::ShapeError;
use crate::boundary::Boundary;
use crate::composite::{Composite, CompositeFace};
use crate::surface::Canonical;

/// A torus whose tube is thicker than this many major radii is handled as a turned arc: in its own
/// frame the numbers would be large.
const THICKEST_TUBE: f64 = 1024.0;

const WISHES: Wishes = Wishes {
    least_x: 0.0,
    takes_disc: turns_round,
};

/// How a region turns about the z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// The direction in which it begins, in degrees from x towards y.
    pub start: f64,
    /// By how many degrees it turns: more than 0, at most 360.
    pub sweep: f64,
    /// In how many straight steps, as by a polygon with its corners on the circle; `None` smoothly.
    pub steps: Option<u32>,
}

impl Turning {
    /// All the way round, smoothly.
    pub const ROUND: Self = Self {
        start: 0.0,
        sweep: 360.0,
        steps: None,
    };

    pub(crate) fn is_whole(&self) -> bool {
        self.sweep >= 360.0
    }

    /// The direction, as a unit vector, after this part of the whole turn.
    pub(crate) fn direction(&self, part: f64) -> DVec2 {
        let (sin, cos) = transform::sin_cos_degrees(self.start + self.sweep * part);
        DVec2::new(cos, sin)
    }

    /// The outward normal of each step's facet, times the distance of its plane where the corners
    /// have distance 1.
    fn facets(&self) -> Vec<(DVec2, f64)> {
        let Some(steps) = self.steps else {
            return Vec::new();
        };
        let count = f64::from(steps);
        let (_, apothem) = transform::sin_cos_degrees(0.5 * self.sweep / count);
        let middles = (0..steps).map(|i| (f64::from(i) + 0.5) / count);
        middles
            .map(|part| (self.direction(part), apothem))
            .collect()
    }

    /// A box around what a distance between these two from the axis passes.
    fn bounds(&self, least: f64, most: f64) -> [DVec2; 2] {
        let steps = self.steps.unwrap_or(1).max(1);
        let mut corners = Vec::new();
        for i in 0..=steps {
            let direction = self.direction(f64::from(i) / f64::from(steps));
            corners.extend([direction * least, direction * most]);
        }
        if self.steps.is_none() {
            // Where the arc passes an axis.
            for (quarter, axis) in [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y]
                .iter()
                .enumerate()
            {
                let ahead = (90.0 * quarter as f64 - self.start).rem_euclid(360.0);
                if ahead <= self.sweep {
                    corners.push(*axis * most);
                }
            }
        }
        let fold = |f: fn(DVec2, DVec2) -> DVec2| corners.iter().copied().reduce(f);
        [fold(DVec2::min), fold(DVec2::max)].map(Option::unwrap_or_default)
    }
}

/// The solid that the region sweeps when it turns about the z axis: its x is the distance from
/// the axis, its y the height.
///
/// # Errors
/// A part of the region lies at negative x; the turn is not finite, not positive or more than 360
/// degrees; a step is 180 degrees or more, or the region has curves or edges that cross and is to
/// turn in steps.
pub(crate) fn lathe(region: &Region, turning: Turning) -> Result<Composite, ShapeError> {
    if region.pieces.iter().any(|p| crosses_axis(&p.curve(), 8)) {
        return Err(ShapeError::BadProfile(
            "reaches to the other side of the axis that it is turned about",
        ));
    }
    let largest_step = turning.sweep / f64::from(turning.steps.unwrap_or(u32::MAX));
    if !(turning.start.is_finite()
        && turning.sweep > 0.0
        && turning.sweep <= 360.0
        && largest_step < 180.0)
    {
        return Err(ShapeError::BadProfile("is turned by no usable angle"));
    }
    let [low, high] = region.bounds();
    let mut turned = Turned {
        heights: [low.y, high.y],
        facets: turning.facets(),
        faces: Vec::new(),
    };
    let whole = Decomposition::new(region, WISHES);
    let is_line = |side: &PlaneSide| matches!(side, PlaneSide::Line(..));
    if turning.steps.is_some() && !whole.sides.iter().all(is_line) {
        return Err(ShapeError::BadProfile(
            "has curves or crossing edges, which cannot be turned in steps",
        ));
    }
    let sides: Vec<Formula> = whole.sides.into_iter().map(|s| turned.side(s)).collect();
    let mut parts = vec![
        whole
            .formula
            .substitute(&|side| sides[side as usize].clone()),
    ];
    for (normal, height) in [(DVec3::NEG_Z, low.y), (DVec3::Z, high.y)] {
        parts.push(turned.plane(normal, height));
    }
    if !turning.is_whole() {
        let (from, to) = (turning.direction(0.0), turning.direction(1.0));
        let ends = [-from.perp(), to.perp()].map(|normal| {
            turned.push(CompositeFace::Plane {
                normal: normal.extend(0.0),
                point: DVec3::ZERO,
            })
        });
        parts.push(if turning.sweep <= 180.0 {
            Formula::all(ends)
        } else {
            Formula::any(ends)
        });
    }
    let around = turning.bounds(low.x, high.x);
    let pieces = region.pieces.as_slice().into();
    Composite::new(
        Boundary::Lathe { pieces, turning },
        turned.faces,
        Formula::all(parts),
        Aabb::new(around[0].extend(low.y), around[1].extend(high.y)),
    )
}

/// Whether a curve has points at negative x; its control points alone may have.
fn crosses_axis(curve: &Curve, halvings: u32) -> bool {
    if curve.control().all(|p| p.x >= 0.0) {
        return false;
    }
    let ends = curve.start().x < 0.0 || curve.end().x < 0.0;
    let halves = || curve.halves();
    ends || (halvings > 0 && halves().iter().any(|half| crosses_axis(half, halvings - 1)))
}

struct Turned {
    /// Normals and distances of a polygon with corners at distance 1; none to turn smoothly.
    facets: Vec<(DVec2, f64)>,
    /// Below and above there is nothing: planes end the solid there.
    heights: [f64; 2],
    faces: Vec<CompositeFace>,
}

impl Turned {
    fn push(&mut self, face: CompositeFace) -> Formula {
        self.faces.push(face);
        Formula::inside(self.faces.len() as u32 - 1)
    }

    fn plane(&mut self, normal: DVec3, height: f64) -> Formula {
        self.push(CompositeFace::Plane {
            normal,
            point: DVec3::Z * height,
        })
    }

    fn curved(&mut self, canonical: Canonical, height: f64, scale: DVec3) -> Formula {
        let from_local =
            DAffine3::from_translation(DVec3::Z * height) * DAffine3::from_scale(scale);
        self.push(CompositeFace::Curved {
            canonical,
            from_local,
        })
    }

    fn side(&mut self, side: PlaneSide) -> Formula {
        match side {
            PlaneSide::Line(a, b) => self.line(a, b),
            PlaneSide::Disc(center, rim) => self.ring(center, rim),
            PlaneSide::Contour(contour) => {
                self.curved(Canonical::Revolution(contour.into()), 0.0, DVec3::ONE)
            }
        }
    }

    /// What lies left of the line from `a` to `b`.
    fn line(&mut self, a: DVec2, b: DVec2) -> Formula {
        if a.y == b.y {
            // Left of a line that runs outwards is above it.
            let normal = if b.x > a.x { DVec3::NEG_Z } else { DVec3::Z };
            return self.plane(normal, a.y);
        }
        // Left of a line that runs upwards is the axis.
        let rises = b.y > a.y;
        let within = if a.x == 0.0 && b.x == 0.0 {
            // Nothing is nearer to the axis than the axis.
            Formula::Constant(false)
        } else if !self.facets.is_empty() {
            self.facets_within(a, b)
        } else if a.x == b.x {
            self.curved(Canonical::Cylinder, 0.0, DVec3::new(a.x, a.x, 1.0))
        } else {
            self.nappe(a, b)
        };
        if rises { within } else { within.complement() }
    }

    /// What lies nearer to the axis than the line through `a` and `b`, turned in steps.
    fn facets_within(&mut self, a: DVec2, b: DVec2) -> Formula {
        let growth = (b.x - a.x) / (b.y - a.y);
        let wide = if a.x > b.x { a } else { b };
        let facets = std::mem::take(&mut self.facets);
        let planes = facets.iter().map(|&(normal, apothem)| {
            self.push(CompositeFace::Plane {
                normal: normal.extend(-growth * apothem),
                point: (normal * (apothem * wide.x)).extend(wide.y),
            })
        });
        let within = Formula::all(planes.collect::<Vec<_>>());
        self.facets = facets;
        within
    }

    /// What lies nearer to the axis than the line through `a` and `b`.
    fn nappe(&mut self, a: DVec2, b: DVec2) -> Formula {
        let (wide, narrow) = if a.x > b.x { (a, b) } else { (b, a) };
        let rise = narrow.y - wide.y;
        let slope = (narrow.x - wide.x) / wide.x;
        let scale = DVec3::new(wide.x, wide.x, rise);
        let cone = self.curved(Canonical::Cone { slope }, wide.y, scale);
        let apex = if narrow.x == 0.0 {
            narrow.y
        } else {
            narrow.y + narrow.x * (rise / (wide.x - narrow.x))
        };
        if apex <= self.heights[0] || apex >= self.heights[1] {
            return cone;
        }
        // The other nappe begins here.
        let normal = if rise > 0.0 { DVec3::Z } else { DVec3::NEG_Z };
        let before = self.plane(normal, apex);
        Formula::all([cone, before])
    }

    /// The disc about `center`, turned.
    fn ring(&mut self, center: DVec2, rim: DVec2) -> Formula {
        let radius = center.distance(rim);
        if center.x == 0.0 {
            self.curved(Canonical::Sphere, center.y, DVec3::splat(radius))
        } else {
            let minor = radius / center.x;
            self.curved(Canonical::Torus { minor }, center.y, DVec3::splat(center.x))
        }
    }
}

/// Whether an arc about this centre becomes a sphere or a torus.
fn turns_round(piece: &Piece) -> bool {
    match piece {
        Piece::Arc { center, ends } => {
            center.x == 0.0
                || (center.x > 0.0 && center.distance(ends[0]) <= THICKEST_TUBE * center.x)
        }
        _ => false,
    }
}
