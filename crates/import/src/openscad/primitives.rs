//! `cube`, `sphere` and `cylinder`.

use std::sync::Arc;

use octray_geometry::{ConvexPolyhedron, Solid};

use crate::{Diagnostics, Options, Span};

use super::arguments::Arguments;
use super::facets::{Resolution, frustum, rings, sphere};
use super::syntax::Statement;
use crate::budget::Budget;

/// What a primitive needs besides its arguments.
pub(super) struct Workshop<'w> {
    pub(super) diagnostics: &'w mut Diagnostics,
    pub(super) options: &'w Options,
    pub(super) budget: &'w mut Budget,
}

impl Workshop<'_> {
    /// The solid without points, with the reason.
    pub(super) fn empty(&mut self, span: Span, why: &str) -> Solid {
        self.diagnostics
            .warning(span, format!("{why}: it is empty"));
        Solid::empty()
    }

    /// The polyhedron OpenSCAD makes, if it was asked for, or the exact shape.
    pub(super) fn round(
        &mut self,
        span: Span,
        resolution: Resolution,
        faces: usize,
        polyhedron: impl FnOnce() -> Option<ConvexPolyhedron>,
        exact: Option<Solid>,
    ) -> Solid {
        if !(resolution.is_explicit() || self.options.facets) {
            return exact.unwrap_or_else(|| self.empty(span, "this is too small or too large"));
        }
        if !self.budget.take_faces(faces, span, self.diagnostics) {
            return Solid::empty();
        }
        match polyhedron() {
            Some(polyhedron) => Solid::convex(Arc::new(polyhedron)),
            None => self.empty(span, "this is too small or too large"),
        }
    }

    /// `cube(size, center)`.
    pub(super) fn cube(&mut self, statement: &Statement<'_>) -> Solid {
        let arguments = Arguments::bind(statement, &["size", "center"], &[], self.diagnostics);
        let size = arguments.size("size", self.diagnostics);
        let size = size.unwrap_or(octray_math::DVec3::ONE);
        let centered = arguments.boolean("center", self.diagnostics);
        if !(size.is_finite() && size.min_element() > 0.0) {
            let why = format!(
                "a cube of size [{}, {}, {}] has no inside",
                size.x, size.y, size.z
            );
            return self.empty(arguments.span(), &why);
        }
        let low = if centered { size * -0.5 } else { size * 0.0 };
        let high = if centered { size * 0.5 } else { size };
        let solid = Solid::cuboid(low, high);
        solid.unwrap_or_else(|error| self.empty(arguments.span(), &error.to_string()))
    }

    /// `sphere(r)`.
    pub(super) fn sphere(&mut self, statement: &Statement<'_>) -> Solid {
        let arguments = Arguments::bind(statement, &["r"], &["d"], self.diagnostics);
        let radius = arguments.radius("r", "d", self.diagnostics).unwrap_or(1.0);
        let resolution = arguments.resolution(self.diagnostics);
        if !(radius > 0.0 && radius.is_finite()) {
            let why = format!("a sphere of radius {radius} has no inside");
            return self.empty(arguments.span(), &why);
        }
        let fragments = resolution.fragments(radius);
        self.round(
            arguments.span(),
            resolution,
            rings(fragments).saturating_mul(fragments),
            || sphere(radius, fragments),
            Solid::sphere(radius).ok(),
        )
    }

    /// `cylinder(h, r1, r2, center)`.
    pub(super) fn cylinder(&mut self, statement: &Statement<'_>) -> Solid {
        let positional = ["h", "r1", "r2", "center"];
        let arguments = Arguments::bind(
            statement,
            &positional,
            &["r", "d", "d1", "d2"],
            self.diagnostics,
        );
        let height = arguments.number("h", self.diagnostics).unwrap_or(1.0);
        let both = arguments.radius("r", "d", self.diagnostics).unwrap_or(1.0);
        let mut end = |radius, diameter| {
            let own = arguments.radius(radius, diameter, self.diagnostics);
            own.unwrap_or(both)
        };
        let radii = [end("r1", "d1"), end("r2", "d2")];
        let centered = arguments.boolean("center", self.diagnostics);
        let resolution = arguments.resolution(self.diagnostics);
        let largest = radii[0].max(radii[1]);
        let finite = height.is_finite() && radii.iter().all(|r| r.is_finite());
        if !(finite && height > 0.0 && radii[0].min(radii[1]) >= 0.0 && largest > 0.0) {
            let why = format!(
                "a cylinder of height {height} and radii {} and {} has no inside",
                radii[0], radii[1]
            );
            return self.empty(arguments.span(), &why);
        }
        let z = if centered {
            [height * -0.5, height * 0.5]
        } else {
            [0.0, height]
        };
        let fragments = resolution.fragments(largest);
        self.round(
            arguments.span(),
            resolution,
            fragments,
            || frustum(radii, z, fragments),
            Solid::cone(radii[0], radii[1], z[0], z[1]).ok(),
        )
    }
}
