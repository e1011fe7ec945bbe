//! Statements into solids with materials.

use octray_geometry::{Solid, SolidNode};
use octray_math::DAffine3;
use octray_scene::{MaterialId, SceneBuilder};

use crate::{Diagnostics, Options, Span};

use super::arguments::Arguments;
use super::drawing::{Drawing, DrawingId};
use super::modules::Module;
use super::operand::{OpenFaces, Operand, Operation, Part};
use super::paint::{Palette, Rgba, color_argument, is_complete};
use super::placement::matrix;
use super::polyhedron::Polyhedron;
use super::primitives::Workshop;
use super::syntax::Statement;
use crate::budget::Budget;

/// The tree of a solid may be this deep, after groups of one and unions of unions are flattened.
const MAX_DEPTH: u32 = 200;

/// What holds around a statement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// The colour that counts so far: of the outermost `color()` that says everything, else of
    /// the innermost.
    pub(super) color: Option<Rgba>,
    /// Whether the statement is taken away from something, an odd number of times.
    pub(super) subtracted: bool,
    /// What becomes of flat shapes; `None` outside of `linear_extrude` and `rotate_extrude`.
    pub(super) drawing: Option<DrawingId>,
}

/// Makes objects of statements.
pub(super) struct Lowering<'l> {
    pub(super) diagnostics: &'l mut Diagnostics,
    pub(super) options: &'l Options,
    pub(super) budget: Budget,
    pub(super) builder: SceneBuilder,
    pub(super) palette: Palette,
    /// What becomes of flat shapes, by [`DrawingId`].
    pub(super) drawings: Vec<Drawing>,
}

impl<'l> Lowering<'l> {
    pub(super) fn new(diagnostics: &'l mut Diagnostics, options: &'l Options) -> Self {
        Self {
            diagnostics,
            options,
            budget: Budget::new(options.memory_budget),
            builder: SceneBuilder::new(),
            palette: Palette::default(),
            drawings: Vec::new(),
        }
    }

    /// What a statement comes to, without the colour around it.
    pub(super) fn operand(&mut self, statement: &Statement<'_>, around: Surroundings) -> Operand {
        if is_absent(statement) {
            return Operand::Absent;
        }
        let Some(module) = Module::called(statement.name) else {
            self.unknown_module(statement);
            return Operand::Unknown;
        };
        let operand = match module {
            Module::Cube
            | Module::Sphere
            | Module::Cylinder
            | Module::Polyhedron
            | Module::LinearExtrude
            | Module::RotateExtrude
                if around.drawing.is_some() =>
            {
                let message = format!(
                    "`{}` is a solid, but something flat is needed here",
                    statement.name
                );
                self.left_out(statement.span, &message);
                Operand::OfOtherDimension
            }
            Module::Cube | Module::Sphere | Module::Cylinder | Module::Polyhedron => {
                self.primitive(module, statement)
            }
            Module::LinearExtrude => self.extruded(statement, around),
            Module::RotateExtrude => self.turned(statement, around),
            Module::Union => self.combined(Operation::Union, statement, around),
            Module::Intersection => self.combined(Operation::Intersection, statement, around),
            Module::Difference => self.combined(Operation::Difference, statement, around),
            Module::Transform => {
                let mut own = matrix(statement, self.diagnostics);
                let mut inside = around;
                if let Some(drawing) = around.drawing {
                    let (there, within) = self.flat_transform(own, drawing);
                    own = there;
                    inside.drawing = Some(within);
                }
                let operand = self.combined(Operation::Union, statement, inside);
                self.transformed(operand, own, statement.span)
            }
            Module::Color => {
                let inside = self.within_color(statement, around);
                let operand = self.combined(Operation::Union, statement, inside);
                match inside.color {
                    Some(color) if inside.color != around.color => {
                        let material = self.palette.color(color, &mut self.builder);
                        painted(operand, material)
                    }
                    _ => operand,
                }
            }
            // An operation on nothing is nothing, supported or not.
            Module::FlatOperation if statement.children.is_empty() && around.drawing.is_none() => {
                Operand::OfOtherDimension
            }
            Module::FlatOperation if statement.children.is_empty() => {
                Operand::Solid(Part::leaf(Solid::empty()))
            }
            Module::UnsupportedOperation if statement.children.is_empty() => {
                Operand::Solid(Part::leaf(Solid::empty()))
            }
            Module::Circle | Module::Square | Module::Polygon => match around.drawing {
                Some(drawing) => self.flat_shape(module, statement, drawing),
                None => self.flat_alone(statement),
            },
            Module::FlatShape | Module::FlatOperation if around.drawing.is_none() => {
                self.flat_alone(statement)
            }
            Module::FlatShape
            | Module::FlatOperation
            | Module::UnsupportedShape
            | Module::UnsupportedOperation => {
                self.left_out(
                    statement.span,
                    &format!("`{}` is not supported", statement.name),
                );
                Operand::Unknown
            }
        };
        match operand {
            Operand::Solid(part) if part.depth > MAX_DEPTH => {
                let message =
                    format!("the solid is nested deeper than {MAX_DEPTH} operations here");
                self.diagnostics.error(statement.span, message);
                // Forgotten, so that what is around it is not reported too.
                Operand::Unknown
            }
            operand => operand,
        }
    }

    /// Something flat that is neither drawn out nor turned.
    fn flat_alone(&mut self, statement: &Statement<'_>) -> Operand {
        let message = format!(
            "`{}` is two-dimensional, which is only supported inside of `linear_extrude` and \
             `rotate_extrude`",
            statement.name
        );
        self.left_out(statement.span, &message);
        Operand::OfOtherDimension
    }

    pub(super) fn workshop(&mut self) -> Workshop<'_> {
        Workshop {
            diagnostics: self.diagnostics,
            options: self.options,
            budget: &mut self.budget,
        }
    }

    fn primitive(&mut self, module: Module, statement: &Statement<'_>) -> Operand {
        if let Some(child) = statement.children.first() {
            let message = format!("`{}` takes no children; they are left out", statement.name);
            self.diagnostics.warning(child.span, message);
        }
        let mut workshop = self.workshop();
        let solid = match module {
            Module::Cube => workshop.cube(statement),
            Module::Sphere => workshop.sphere(statement),
            Module::Cylinder => workshop.cylinder(statement),
            _ => match workshop.polyhedron(statement) {
                Polyhedron::Solid(solid) => solid,
                Polyhedron::Open(mesh, why) => {
                    return Operand::Open(OpenFaces {
                        mesh,
                        place: DAffine3::IDENTITY,
                        why,
                        span: statement.span,
                    });
                }
            },
        };
        Operand::Solid(Part::leaf(solid))
    }

    pub(super) fn combined(
        &mut self,
        operation: Operation,
        statement: &Statement<'_>,
        around: Surroundings,
    ) -> Operand {
        let mut operands = Vec::with_capacity(statement.children.len());
        let mut is_first = true;
        for child in &statement.children {
            if is_absent(child) {
                continue;
            }
            let takes_away = operation == Operation::Difference && !is_first;
            is_first = false;
            let mut inside = around;
            inside.subtracted ^= takes_away;
            let mut operand = self.operand(child, inside);
            if takes_away && around.color.is_none() {
                let material = if inside.subtracted {
                    self.palette.cut(&mut self.builder)
                } else {
                    self.palette.surface(&mut self.builder)
                };
                operand = painted(operand, material);
            }
            operands.push(operand);
        }
        let diagnostics = &mut *self.diagnostics;
        operation.combine(operands, &mut |faces: OpenFaces| {
            let name = operation.name();
            let message = format!("{}; it is left out of the {name}", faces.why);
            diagnostics.warning(faces.span, message);
        })
    }

    /// What holds inside a `color()`.
    pub(super) fn within_color(
        &mut self,
        statement: &Statement<'_>,
        around: Surroundings,
    ) -> Surroundings {
        let arguments = Arguments::bind(statement, &["c", "alpha"], &[], self.diagnostics);
        let own = color_argument(&arguments, self.diagnostics);
        let says_something = own.iter().any(|channel| *channel >= 0.0);
        let is_decided = around.color.as_ref().is_some_and(is_complete);
        Surroundings {
            color: if is_decided || !says_something {
                around.color
            } else {
                Some(own)
            },
            ..around
        }
    }

    pub(super) fn transformed(&mut self, operand: Operand, place: DAffine3, span: Span) -> Operand {
        if place == DAffine3::IDENTITY {
            return operand;
        }
        let flattened = match operand {
            Operand::Solid(part) if !part.is_empty() => {
                let is_moved = matches!(part.solid.node(), SolidNode::Transformed { .. });
                match part.solid.transform(place) {
                    Ok(solid) => {
                        return Operand::Solid(Part {
                            solid,
                            depth: part.depth + u32::from(!is_moved),
                        });
                    }
                    Err(error) => error,
                }
            }
            Operand::Open(faces) => {
                let place = place * faces.place;
                return Operand::Open(OpenFaces { place, ..faces });
            }
            other => return other,
        };
        let message = format!("{flattened}: what it is applied to is empty");
        self.diagnostics.warning(span, message);
        Operand::Solid(Part::leaf(Solid::empty()))
    }
}

/// Whether a mark takes the statement out of the model.
pub(super) const fn is_absent(statement: &Statement<'_>) -> bool {
    statement.modifiers.background || statement.modifiers.disable
}

/// The operand with a material wherever it has none yet.
fn painted(operand: Operand, material: MaterialId) -> Operand {
    match operand {
        Operand::Solid(part) if !part.is_empty() => Operand::Solid(Part {
            solid: part.solid.with_material(material),
            depth: part.depth + 1,
        }),
        other => other,
    }
}
