//! The simple shapes: numbers in, geometry out.

use octray_geometry::{ShapeError, Sheet, Solid};
use octray_math::{DAffine3, DVec3};

use super::object::Geometry;
use super::reader::{Parsed, Reader};
use crate::Span;

impl Reader<'_> {
    /// The numbers of a shape, up to its modifiers; `None`, with a warning, where they describe
    /// nothing that can be shown.
    pub(super) fn geometry(&mut self, word: &str, span: Span) -> Parsed<Option<Geometry>> {
        let made = match word {
            "sphere" => {
                let center = self.vector()?;
                self.comma();
                let radius = self.float()?;
                Solid::sphere(radius)
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

    /// `<A, B, C>, <D, E, F>, <G, H, I>, J`: `A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y
    /// + I z + J <= 0`. Ellipsoids, elliptic cylinders and half-spaces are shapes that we have.
    fn quadric(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let square = self.vector()?;
        self.comma();
        let mixed = self.vector()?;
        self.comma();
        let linear = self.vector()?;
        self.comma();
        let constant = self.float()?;
        let made = if mixed == DVec3::ZERO {
            diagonal_quadric(square, linear, constant)
        } else {
            None
        };
        match made {
            Some(made) => Ok(self.usable("quadric", span, made.map(Geometry::Solid))),
            None => {
                self.warn(
                    span,
                    "a quadric of this kind is not supported: it is left out",
                );
                Ok(None)
            }
        }
    }
}

/// A quadric without mixed terms; `None` where it is of a kind that we do not have.
fn diagonal_quadric(a: DVec3, b: DVec3, c: f64) -> Option<Result<Solid, ShapeError>> {
    if a == DVec3::ZERO {
        return Some(Solid::half_space(b, -c / b.length()));
    }
    // An axis without a square must not have a linear term either.
    let mut center = DVec3::ZERO;
    let mut level = -c;
    for axis in 0..3 {
        if a[axis] < 0.0 || (a[axis] == 0.0 && b[axis] != 0.0) {
            return None;
        }
        if a[axis] > 0.0 {
            center[axis] = -0.5 * b[axis] / a[axis];
            level += 0.25 * b[axis] * b[axis] / a[axis];
        }
    }
    if level <= 0.0 {
        return None;
    }
    let radius = |axis: usize| (level / a[axis]).sqrt();
    let free: Vec<usize> = (0..3).filter(|&axis| a[axis] == 0.0).collect();
    Some(match free[..] {
        [] => Solid::sphere(1.0).and_then(|ball| {
            let scale = DVec3::new(radius(0), radius(1), radius(2));
            ball.transform(DAffine3::from_translation(center) * DAffine3::from_scale(scale))
        }),
        [axis] => Solid::infinite_cylinder(1.0).and_then(|cylinder| {
            let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
            let mut columns = [DVec3::ZERO; 3];
            columns[0][i] = radius(i);
            columns[1][j] = radius(j);
            columns[2][axis] = 1.0;
            let [x, y, z] = columns;
            cylinder.transform(DAffine3::from_cols(x, y, z, center))
        }),
        _ => return None,
    })
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
