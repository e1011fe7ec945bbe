//! Regions drawn out along z.

use octray_math::{Aabb, DAffine3, DMat3, DVec2, DVec3};

use super::decompose::{Decomposition, PlaneSide, Wishes};
use super::formula::Formula;
use super::pieces::Piece;
use super::region::Region;
use crate::ShapeError;
use crate::boundary::FlatBoundary;
use crate::composite::{Composite, CompositeFace, CompositeKind};
use crate::surface::Canonical;

const WISHES: Wishes = Wishes {
    least_x: f64::NEG_INFINITY,
    takes_disc: |_| true,
};

/// The part of space whose section at height `z` is the region scaled about the axis, by
/// `scale[0]` at `z[0]` and by `scale[1]` at `z[1]`, linearly in between.
///
/// # Errors
/// Heights are not finite and increasing, a scale is negative or not finite, both are 0, or they
/// differ and the region has Bézier curves or edges that cross.
pub(crate) fn prism(
    region: &Region,
    z: [f64; 2],
    scale: [f64; 2],
) -> Result<Composite, ShapeError> {
    let whole = Decomposition::new(region, WISHES);
    let sweep = Sweep { z, scale };
    let mut faces = Vec::with_capacity(whole.sides.len() + 2);
    for side in whole.sides {
        faces.push(sweep.face(side)?);
    }
    let mut parts = vec![whole.formula];
    // Also at the tip of a pyramid: behind it the sides would open again.
    for (normal, height) in [(DVec3::NEG_Z, z[0]), (DVec3::Z, z[1])] {
        faces.push(CompositeFace::Plane {
            normal,
            point: DVec3::Z * height,
        });
        parts.push(Formula::inside(faces.len() as u32 - 1));
    }
    let [low, high] = region.bounds();
    let corner = |p: DVec2, i: usize| (p * scale[i]).extend(z[i]);
    let corners = [
        corner(low, 0),
        corner(high, 0),
        corner(low, 1),
        corner(high, 1),
    ];
    let composite = Composite::new(
        CompositeKind::Prism,
        faces,
        Formula::all(parts),
        Aabb::from_points(corners),
    )?;
    let straight = |piece: &Piece| match piece {
        Piece::Line(a, b) => Some([*a, *b]),
        _ => None,
    };
    let edges: Option<Vec<[DVec2; 2]>> = region.pieces.iter().map(straight).collect();
    Ok(match edges {
        Some(edges) => composite.with_flat_boundary(FlatBoundary::Prism {
            edges: edges.into(),
            z,
            scale,
        }),
        None => composite,
    })
}

struct Sweep {
    z: [f64; 2],
    scale: [f64; 2],
}

impl Sweep {
    fn is_straight(&self) -> bool {
        self.scale[0] == self.scale[1]
    }

    fn face(&self, side: PlaneSide) -> Result<CompositeFace, ShapeError> {
        match side {
            PlaneSide::Line(a, b) => Ok(self.plane(a, b)),
            PlaneSide::Disc(center, rim) => Ok(self.cone(center, center.distance(rim))),
            PlaneSide::Contour(contour) if self.is_straight() => {
                let s = self.scale[0];
                Ok(CompositeFace::Curved {
                    canonical: Canonical::Extrusion(contour.into()),
                    from_local: DAffine3::from_scale(DVec3::new(s, s, 1.0)),
                })
            }
            PlaneSide::Contour(_) => Err(ShapeError::BadProfile(
                "has curves or crossing edges, which cannot be drawn to a different size",
            )),
        }
    }

    /// Left of the line from `a` to `b`.
    fn plane(&self, a: DVec2, b: DVec2) -> CompositeFace {
        let d = b - a;
        // The wider end: at the other one there may be only a tip.
        let end = usize::from(self.scale[1] > self.scale[0]);
        let point = (a * self.scale[end]).extend(self.z[end]);
        let (rise, growth) = (self.z[1] - self.z[0], self.scale[1] - self.scale[0]);
        let normal = if growth == 0.0 {
            DVec3::new(d.y, -d.x, 0.0)
        } else {
            let lean = d.perp_dot(a) * (growth / rise);
            DVec3::new(d.y, -d.x, lean)
        };
        CompositeFace::Plane { normal, point }
    }

    /// In the disc, whatever size it has.
    fn cone(&self, center: DVec2, radius: f64) -> CompositeFace {
        let [from, to] = if self.scale[0] >= self.scale[1] {
            [0, 1]
        } else {
            [1, 0]
        };
        let (wide, narrow) = (self.scale[from], self.scale[to]);
        let axis = (center * (narrow - wide)).extend(self.z[to] - self.z[from]);
        let canonical = if self.is_straight() {
            Canonical::Cylinder
        } else {
            let slope = (narrow - wide) / wide;
            Canonical::Cone { slope }
        };
        let radius = radius * wide;
        CompositeFace::Curved {
            canonical,
            from_local: DAffine3::from_mat3_translation(
                DMat3::from_cols(DVec3::X * radius, DVec3::Y * radius, axis),
                (center * wide).extend(self.z[from]),
            ),
        }
    }
}
