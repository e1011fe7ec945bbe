//! Statements into solids with materials.

use octray_geometry::{Sheet, Solid, SolidNode};
use octray_math::{DAffine3, transform};
use octray_scene::{MaterialId, Object, SceneBuilder, Shape};

use crate::{Diagnostic, Diagnostics, Options, Severity, Span};

use super::arguments::Arguments;
use super::budget::Budget;
use super::modules::{self, Module};
use super::operand::{OpenFaces, Operand, Operation, Part};
use super::paint::{Palette, Rgba, color_argument, is_complete};
use super::placement::matrix;
use super::polyhedron::Polyhedron;
use super::primitives::Workshop;
use super::syntax::Statement;

/// The tree of a solid may be this deep, after groups of one and unions of unions are flattened.
const MAX_DEPTH: u32 = 200;

/// What holds around a statement.
#[derive(Clone, Copy, Debug)]
struct Surroundings {
    /// The colour that counts so far: of the outermost `color()` that says everything, else of
    /// the innermost.
    color: Option<Rgba>,
    /// Whether the statement is taken away from something, an odd number of times.
    subtracted: bool,
}

/// Makes objects of statements.
pub(super) struct Lowering<'l> {
    pub(super) diagnostics: &'l mut Diagnostics,
    pub(super) options: &'l Options,
    pub(super) budget: Budget,
    pub(super) builder: SceneBuilder,
    palette: Palette,
}

impl<'l> Lowering<'l> {
    pub(super) fn new(diagnostics: &'l mut Diagnostics, options: &'l Options) -> Self {
        Self {
            diagnostics,
            options,
            budget: Budget::new(options.memory_budget),
            builder: SceneBuilder::new(),
            palette: Palette::default(),
        }
    }

    /// Adds an object for each statement, and for each child of groups, unions, transforms and
    /// colours at the top: together they are the same set of points, and keep their own names.
    pub(super) fn scene(&mut self, statements: &[Statement<'_>]) {
        let around = Surroundings {
            color: None,
            subtracted: false,
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
            name,
            shape,
            material,
            // Opaque things show inside of clear ones.
            priority: -i32::from(is_clear),
            casts_shadows: true,
        });
    }

    /// What a statement comes to, without the colour around it.
    fn operand(&mut self, statement: &Statement<'_>, around: Surroundings) -> Operand {
        if is_absent(statement) {
            return Operand::Absent;
        }
        let Some(module) = Module::called(statement.name) else {
            self.unknown_module(statement);
            return Operand::Unknown;
        };
        let operand = match module {
            Module::Cube | Module::Sphere | Module::Cylinder | Module::Polyhedron => {
                self.primitive(module, statement)
            }
            Module::Union => self.combined(Operation::Union, statement, around),
            Module::Intersection => self.combined(Operation::Intersection, statement, around),
            Module::Difference => self.combined(Operation::Difference, statement, around),
            Module::Transform => {
                let own = matrix(statement, self.diagnostics);
                let operand = self.combined(Operation::Union, statement, around);
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
            Module::FlatOperation if statement.children.is_empty() => Operand::Flat,
            Module::UnsupportedOperation if statement.children.is_empty() => {
                Operand::Solid(Part::leaf(Solid::empty()))
            }
            Module::FlatShape | Module::FlatOperation => {
                let message = format!(
                    "`{}` is two-dimensional, which is not supported",
                    statement.name
                );
                self.left_out(statement.span, &message);
                Operand::Flat
            }
            Module::UnsupportedShape | Module::UnsupportedOperation => {
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

    fn primitive(&mut self, module: Module, statement: &Statement<'_>) -> Operand {
        if let Some(child) = statement.children.first() {
            let message = format!("`{}` takes no children; they are left out", statement.name);
            self.diagnostics.warning(child.span, message);
        }
        let mut workshop = Workshop {
            diagnostics: self.diagnostics,
            options: self.options,
            budget: &mut self.budget,
        };
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

    fn combined(
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
    fn within_color(&mut self, statement: &Statement<'_>, around: Surroundings) -> Surroundings {
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

    fn transformed(&mut self, operand: Operand, place: DAffine3, span: Span) -> Operand {
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

    fn left_out(&mut self, span: Span, why: &str) {
        self.diagnostics
            .warning(span, format!("{why}; it is left out"));
    }

    fn unknown_module(&mut self, statement: &Statement<'_>) {
        let name = statement.name;
        let help = if modules::is_evaluated(name) {
            Some(
                "a dump has the outcome of this in its place; export one with \
                 `openscad -o model.csg model.scad`"
                    .to_owned(),
            )
        } else {
            let near = crate::spelling::nearest(name, modules::names());
            near.map(|near| format!("did you mean `{near}`?"))
        };
        self.diagnostics.push(Diagnostic {
            severity: Severity::Error,
            span: Some(statement.span),
            message: format!("there is no module called `{name}`"),
            help,
        });
    }
}

/// Whether a mark takes the statement out of the model.
const fn is_absent(statement: &Statement<'_>) -> bool {
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
