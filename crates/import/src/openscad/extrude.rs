//! `linear_extrude`: flat shapes drawn out along z.
//!
//! Drawing out and set operations may be done in either order, so each flat shape becomes a prism
//! or cylinder of the same height, and the operations on them are those on solids.

use octray_geometry::Solid;
use octray_math::DAffine3;

use super::arguments::Arguments;
use super::lower::{Lowering, Surroundings};
use super::modules::Module;
use super::operand::{OpenFaces, Operand, Operation, Part};
use super::polyhedron::Polyhedron;
use super::syntax::{Statement, Value};

/// OpenSCAD's height where none is given.
const DEFAULT_HEIGHT: f64 = 100.0;

impl Lowering<'_> {
    /// `linear_extrude(height, center)` with its children.
    pub(super) fn extruded(&mut self, statement: &Statement<'_>, around: Surroundings) -> Operand {
        let arguments = Arguments::bind(
            statement,
            &["height", "center", "convexity", "twist", "slices", "scale"],
            &["v", "segments", "file", "layer", "origin", "timestamp"],
            self.diagnostics,
        );
        let is_one = |value: &Value| {
            value.number() == Some(1.0)
                || value
                    .numbers()
                    .is_some_and(|all| all.iter().all(|s| *s == 1.0))
        };
        let twists = arguments
            .get("twist")
            .is_some_and(|a| a.value.number() != Some(0.0));
        let scales = arguments.get("scale").is_some_and(|a| !is_one(&a.value));
        let leans = arguments.get("v").is_some();
        let reads = arguments.get("file").is_some();
        for (applies, what) in [
            (twists, "twist"),
            (scales, "scale"),
            (leans, "a direction"),
            (reads, "a file"),
        ] {
            if applies {
                let message = format!("`linear_extrude` with {what} is not supported");
                self.left_out(statement.span, &message);
                return Operand::Unknown;
            }
        }
        let height = arguments.number("height", self.diagnostics);
        let height = height.unwrap_or(DEFAULT_HEIGHT);
        let centered = arguments.boolean("center", self.diagnostics);
        if !(height > 0.0 && height.is_finite()) {
            let message = format!("an extrusion of height {height} has no inside: it is empty");
            self.diagnostics.warning(statement.span, message);
            return Operand::Solid(Part::leaf(Solid::empty()));
        }
        let slab = if centered {
            [height * -0.5, height * 0.5]
        } else {
            [0.0, height]
        };
        let inside = Surroundings {
            slab: Some(slab),
            ..around
        };
        match self.combined(Operation::Union, statement, inside) {
            // Only solids, which cannot be drawn out.
            Operand::OfOtherDimension => Operand::Solid(Part::leaf(Solid::empty())),
            operand => operand,
        }
    }

    /// A flat shape, drawn out.
    pub(super) fn flat_shape(
        &mut self,
        module: Module,
        statement: &Statement<'_>,
        slab: [f64; 2],
    ) -> Operand {
        let mut workshop = self.workshop();
        let solid = match module {
            Module::Circle => workshop.circle(statement, slab),
            Module::Square => workshop.square(statement, slab),
            _ => match workshop.polygon(statement, slab) {
                Some(Polyhedron::Solid(solid)) => solid,
                Some(Polyhedron::Open(mesh, why)) => {
                    return Operand::Open(OpenFaces {
                        mesh,
                        place: DAffine3::IDENTITY,
                        why,
                        span: statement.span,
                    });
                }
                None => return Operand::Unknown,
            },
        };
        Operand::Solid(Part::leaf(solid))
    }
}
