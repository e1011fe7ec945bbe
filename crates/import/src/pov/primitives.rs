//! The simple shapes: numbers in, geometry out.

use octray_geometry::{ShapeError, Sheet, Solid};
use octray_math::{DAffine3, DVec3};

use super::object::Geometry;
use super::reader::{Parsed, Reader};
use crate::Span;

/// How many sizes of balls are remembered.
const SHARED_SPHERES: usize = 1000;

impl Reader<'_> {
    /// The numbers of a shape, up to its modifiers; `None`, with a warning, where they describe
    /// nothing that can be shown.
    pub(super) fn geometry(&mut self, word: &str, span: Span) -> Parsed<Option<Geometry>> {
        let made = match word {
            "sphere" => {
                let center = self.vector()?;
                self.comma();
                let radius = self.float()?;
                self.sphere(radius)
                    .and_then(|s| s.translate(center))
                    .map(Geometry::Solid)
            }
            "box" => {
                let a = self.vector()?;
                self.comma();
                Solid::cuboid(a, self.vector()?).map(Geometry::Solid)
            }
            "cylinder" => {
                let a = self.vector()?;
                self.comma();
                let b = self.vector()?;
                self.comma();
                let radius = self.float()?;
                let open = self.eat_word("open");
                conical(a, radius, b, radius, open)
            }
            "cone" => {
                let a = self.vector()?;
                self.comma();
                let radius_a = self.float()?;
                self.comma();
                let b = self.vector()?;
                self.comma();
                let radius_b = self.float()?;
                let open = self.eat_word("open");
                conical(a, radius_a, b, radius_b, open)
            }
            "plane" => {
                let normal = self.vector()?;
                self.comma();
                Solid::half_space(normal, self.float()?).map(Geometry::Solid)
            }
            "torus" => {
                let major = self.float()?;
                self.comma();
                let minor = self.float()?;
                let y_from_z = DAffine3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y, DVec3::ZERO);
                Solid::torus(major, minor)
                    .and_then(|s| s.transform(y_from_z))
                    .map(Geometry::Solid)
            }
            "disc" => {
                let center = self.vector()?;
                self.comma();
                let normal = self.vector()?;
                self.comma();
                let radius = self.float()?;
                self.comma();
                let hole = if matches!(self.peek().kind, super::lexer::Kind::Number(_)) {
                    self.float()?
                } else {
                    0.0
                };
                Sheet::disc(center, normal, radius, hole).map(Geometry::Sheet)
            }
            "quadric" => return self.quadric(span),
            "superellipsoid" => return self.superellipsoid(span),
            "polynomial" => return self.polynomial(span),
            "cubic" | "quartic" | "poly" => return self.poly(word, span),
            "triangle" | "smooth_triangle" => return self.triangle(word == "smooth_triangle"),
            "mesh" => return self.mesh(span),
            "mesh2" => return self.mesh2(span),
            "polygon" => return self.polygon(span),
            "prism" => return self.prism(span),
            "lathe" => return self.lathe(span),
            _ => return self.unexpected("an object"),
        };
        Ok(self.usable(word, span, made))
    }

    /// A ball about the origin; those of one size are one solid.
    fn sphere(&mut self, radius: f64) -> Result<Solid, ShapeError> {
        if let Some(known) = self.spheres.get(&radius.to_bits()) {
            return Ok(known.clone());
        }
        let made = Solid::sphere(radius)?;
        if self.spheres.len() < SHARED_SPHERES {
            self.spheres.insert(radius.to_bits(), made.clone());
        }
        Ok(made)
    }

    /// A shape, or a warning that it is left out.
    pub(super) fn usable(
        &mut self,
        word: &str,
        span: Span,
        made: Result<Geometry, ShapeError>,
    ) -> Option<Geometry> {
        if let Err(error) = &made {
            self.warn(
                span.to(self.last),
                format!("this `{word}` is left out: {error}"),
            );
        }
        made.ok()
    }
}

/// The frame whose z axis leads from `a` to `b`, and the distance.
fn axis_frame(a: DVec3, b: DVec3) -> Result<(DAffine3, f64), ShapeError> {
    let axis = b - a;
    let z = axis
        .try_normalize()
        .ok_or(ShapeError::ZeroVector { what: "axis" })?;
    let (x, y) = z.any_orthonormal_pair();
    Ok((DAffine3::from_cols(x, y, z, a), axis.length()))
}

/// A cylinder, cone or frustum between two points.
pub(super) fn conical(
    a: DVec3,
    radius_a: f64,
    b: DVec3,
    radius_b: f64,
    open: bool,
) -> Result<Geometry, ShapeError> {
    let (frame, height) = axis_frame(a, b)?;
    let solid = Solid::cone(radius_a, radius_b, 0.0, height)?.transform(frame)?;
    if !open {
        return Ok(Geometry::Solid(solid));
    }
    // The mantle of a longer one, so that no cap lies where the surface is cut off.
    let longer = if radius_a == radius_b {
        Solid::infinite_cylinder(radius_a)?
    } else {
        let slope = (radius_b - radius_a) / height;
        let apex = -radius_a / slope;
        let margin = height / 64.0;
        let (low, high) = if slope > 0.0 {
            (apex.max(-margin), height + margin)
        } else {
            (-margin, apex.min(height + margin))
        };
        let radius_at = |z: f64| (radius_a + slope * z).max(0.0);
        Solid::cone(radius_at(low), radius_at(high), low, high)?
    };
    let slab = Solid::intersection([
        Solid::half_space(DVec3::Z, height)?,
        Solid::half_space(DVec3::NEG_Z, 0.0)?,
    ]);
    let shell = Sheet::Shell {
        solid: longer.transform(frame)?,
        clip: slab.transform(frame)?,
    };
    Ok(Geometry::Open { shell, solid })
}
