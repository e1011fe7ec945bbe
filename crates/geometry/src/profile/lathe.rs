//! Regions turned about the z axis.

use octray_math::{Aabb, DAffine3, DVec2, DVec3};

use super::curve::Curve;
use super::decompose::{Decomposition, PlaneSide, Wishes};
use super::formula::Formula;
use super::pieces::Piece;
use super::region::Region;
use crate::ShapeError;
use crate::composite::{Composite, CompositeFace, CompositeKind};
use crate::surface::Canonical;

/// A torus whose tube is thicker than this many major radii is handled as a turned arc: in its own
/// frame the numbers would be large.
const THICKEST_TUBE: f64 = 1024.0;

const WISHES: Wishes = Wishes {
    least_x: 0.0,
    takes_disc: turns_round,
};

/// The solid that the region sweeps when it turns about the z axis: its x is the distance from
/// the axis, its y the height.
///
/// # Errors
/// A part of the region lies at negative x.
pub(crate) fn lathe(region: &Region) -> Result<Composite, ShapeError> {
    if region.pieces.iter().any(|p| crosses_axis(&p.curve(), 8)) {
        return Err(ShapeError::BadProfile(
            "reaches to the other side of the axis that it is turned about",
        ));
    }
    let [low, high] = region.bounds();
    let mut turned = Turned {
        heights: [low.y, high.y],
        faces: Vec::new(),
    };
    let whole = Decomposition::new(region, WISHES);
    let sides: Vec<Formula> = whole.sides.into_iter().map(|s| turned.side(s)).collect();
    let mut parts = vec![
        whole
            .formula
            .substitute(&|side| sides[side as usize].clone()),
    ];
    for (normal, height) in [(DVec3::NEG_Z, low.y), (DVec3::Z, high.y)] {
        parts.push(turned.plane(normal, height));
    }
    let reach = DVec2::splat(high.x);
    Composite::new(
        CompositeKind::Lathe,
        turned.faces,
        Formula::all(parts),
        Aabb::new((-reach).extend(low.y), reach.extend(high.y)),
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
        let within = if a.x == b.x {
            if a.x == 0.0 {
                // Nothing is nearer to the axis than the axis.
                Formula::Constant(false)
            } else {
                self.curved(Canonical::Cylinder, 0.0, DVec3::new(a.x, a.x, 1.0))
            }
        } else {
            self.nappe(a, b)
        };
        if rises { within } else { within.complement() }
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
