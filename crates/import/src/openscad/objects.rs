//! Statements at the top into objects of the scene.

use octray_geometry::Sheet;
use octray_math::{DAffine3, transform};
use octray_scene::{Object, Shape};

use super::lower::{Lowering, Surroundings, is_absent};
use super::modules::Module;
use super::operand::Operand;
use super::placement::matrix;
use super::syntax::Statement;

impl Lowering<'_> {
    /// Adds an object for each statement, and for each child of groups, unions, transforms and
    /// colours at the top: together they are the same set of points, and keep their own names.
    pub(super) fn scene(&mut self, statements: &[Statement<'_>]) {
        let around = Surroundings {
            color: None,
            subtracted: false,
            drawing: None,
        };
        for statement in statements {
            self.object(statement, DAffine3::IDENTITY, around);
        }
    }

    fn object(&mut self, statement: &Statement<'_>, place: DAffine3, around: Surroundings) {
        if is_absent(statement) {
            return;
        }
        match Module::called(statement.name) {
            Some(Module::Union) => {
                for child in &statement.children {
                    self.object(child, place, around);
                }
                return;
            }
            Some(Module::Color) => {
                let around = self.within_color(statement, around);
                for child in &statement.children {
                    self.object(child, place, around);
                }
                return;
            }
            Some(Module::Transform) => {
                let own = matrix(statement, self.diagnostics);
                // What is flattened must first be seen, to say so only where it matters.
                if transform::is_invertible(&(place * own)) {
                    for child in &statement.children {
                        self.object(child, place * own, around);
                    }
                    return;
                }
            }
            _ => {}
        }
        let operand = self.operand(statement, around);
        let operand = self.transformed(operand, place, statement.span);
        let line = self.diagnostics.line(statement.span);
        let name = format!("{} in line {line}", statement.name);
        let shape = match operand {
            Operand::Solid(part) if !part.is_empty() => Shape::Solid(part.solid),
            Operand::Open(faces) => {
                let message = format!("{}; it is shown as a surface without inside", faces.why);
                self.diagnostics.warning(faces.span, message);
                match Sheet::mesh(faces.mesh).transform(faces.place) {
                    Ok(sheet) => Shape::Sheet(sheet),
                    Err(error) => {
                        self.diagnostics.warning(faces.span, error.to_string());
                        return;
                    }
                }
            }
            _ => return,
        };
        let (material, is_clear) = match around.color {
            Some(color) => {
                let id = self.palette.color(color, &mut self.builder);
                (id, (0.0..1.0).contains(&color[3]))
            }
            None => (self.palette.surface(&mut self.builder), false),
        };
        self.builder.add_object(Object {
            name: name.into(),
            shape,
            material,
            // Opaque things show inside of clear ones.
            priority: -i32::from(is_clear),
            casts_shadows: true,
        });
    }
}
