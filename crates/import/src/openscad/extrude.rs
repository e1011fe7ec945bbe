//! `linear_extrude` and `rotate_extrude`: flat shapes drawn out along z or turned about it.

use octray_geometry::Solid;
use octray_geometry::profile::Turning;
use octray_math::{DAffine3, DVec3};

use super::arguments::Arguments;
use super::drawing::{Drawing, DrawingId, Slab, Turn};
use super::lower::{Lowering, Surroundings};
use super::modules::Module;
use super::operand::{Operand, Operation, Part};
use super::syntax::{Statement, Value};

/// OpenSCAD's height where none is given.
const DEFAULT_HEIGHT: f64 = 100.0;

/// The one factor of `scale`, if it is the same along x and y.
fn uniform_scale(value: &Value) -> Option<f64> {
    let scale = match value.numbers().as_deref() {
        Some([x, y]) if x == y => Some(*x),
        Some(_) => None,
        None => value.number(),
    };
    scale.filter(|scale| *scale >= 0.0 && scale.is_finite())
}

impl Lowering<'_> {
    /// `linear_extrude(height, center, scale)` with its children.
    pub(super) fn extruded(&mut self, statement: &Statement<'_>, around: Surroundings) -> Operand {
        let arguments = Arguments::bind(
            statement,
            &["height", "center", "convexity", "twist", "slices", "scale"],
            &["v", "segments", "file", "layer", "origin", "timestamp"],
            self.diagnostics,
        );
        let twists = arguments
            .get("twist")
            .is_some_and(|a| a.value.number() != Some(0.0));
        let scale = arguments.get("scale").map(|a| uniform_scale(&a.value));
        let leans = arguments.get("v").is_some();
        let reads = arguments.get("file").is_some();
        for (applies, what) in [
            (twists, "twist"),
            (scale == Some(None), "unequal scales"),
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
        let z = if centered {
            [height * -0.5, height * 0.5]
        } else {
            [0.0, height]
        };
        let top = scale.flatten().unwrap_or(1.0);
        self.drawn(statement, around, Drawing::Out(Slab { z, top }))
    }

    /// `rotate_extrude(angle)` with its children: the plane's y axis becomes z.
    pub(super) fn turned(&mut self, statement: &Statement<'_>, around: Surroundings) -> Operand {
        let arguments = Arguments::bind(
            statement,
            &["angle", "convexity"],
            &["start", "file", "layer", "origin", "scale", "timestamp"],
            self.diagnostics,
        );
        if arguments.get("file").is_some() {
            self.left_out(
                statement.span,
                "`rotate_extrude` with a file is not supported",
            );
            return Operand::Unknown;
        }
        let given = arguments.number("angle", self.diagnostics);
        if given == Some(0.0) {
            return Operand::Solid(Part::leaf(Solid::empty()));
        }
        let angle = given.filter(|a| a.is_finite() && a.abs() < 360.0);
        let angle = angle.unwrap_or(360.0);
        let start = arguments.number("start", self.diagnostics);
        let whole = angle == 360.0;
        // OpenSCAD begins on the negative x axis where it goes all the way round.
        let start = start.unwrap_or(if whole { 180.0 } else { 0.0 });
        let resolution = arguments.resolution(self.diagnostics);
        let mut turn = Turn {
            place: DAffine3::IDENTITY,
            turning: Turning {
                start: if angle < 0.0 { start + angle } else { start },
                sweep: angle.abs(),
                steps: None,
            },
        };
        if !turn.turning.start.is_finite() {
            let message = "the start of a turn must be finite: it is empty";
            self.diagnostics.warning(statement.span, message);
            return Operand::Solid(Part::leaf(Solid::empty()));
        }
        let mut solid = self.drawn(statement, around, Drawing::Turned(turn));
        // Shapes left of the axis are turned like those right of it.
        if matches!(&solid, Operand::Solid(part) if part.solid.bounds().is_empty()) {
            turn.place = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
            turn.turning.start += 180.0;
            solid = self.drawn_quietly(statement, around, Drawing::Turned(turn));
        }
        let Operand::Solid(round) = &solid else {
            return solid;
        };
        if resolution.is_explicit() || self.options.facets {
            let bounds = round.solid.bounds();
            let reach = bounds.min.abs().max(bounds.max.abs()).truncate();
            let fragments = resolution.fragments(reach.max_element()) as f64;
            let least = if whole { 3.0 } else { angle.abs() / 120.0 };
            let steps = libm::floor(fragments * angle.abs() / 360.0).max(libm::ceil(least));
            turn.turning.steps = Some(steps as u32);
            solid = self.drawn_quietly(statement, around, Drawing::Turned(turn));
        }
        solid
    }

    fn drawn(
        &mut self,
        statement: &Statement<'_>,
        around: Surroundings,
        drawing: Drawing,
    ) -> Operand {
        let inside = Surroundings {
            drawing: Some(self.drawing(drawing)),
            ..around
        };
        match self.combined(Operation::Union, statement, inside) {
            // Only solids, which cannot be drawn.
            Operand::OfOtherDimension => Operand::Solid(Part::leaf(Solid::empty())),
            operand => operand,
        }
    }

    /// Once more, without saying again what is wrong.
    fn drawn_quietly(
        &mut self,
        statement: &Statement<'_>,
        around: Surroundings,
        drawing: Drawing,
    ) -> Operand {
        let mut said = std::mem::take(self.diagnostics);
        let operand = self.drawn(statement, around, drawing);
        std::mem::swap(self.diagnostics, &mut said);
        operand
    }

    /// Keeps a drawing, so that what holds around a statement stays small: lowering recurses.
    fn drawing(&mut self, drawing: Drawing) -> DrawingId {
        self.drawings.push(drawing);
        DrawingId(self.drawings.len() as u32 - 1)
    }

    /// Something flat under a transform: it as a transform of solids, and the drawing within.
    pub(super) fn flat_transform(
        &mut self,
        own: DAffine3,
        drawing: DrawingId,
    ) -> (DAffine3, DrawingId) {
        let (there, within) = self.drawings[drawing.0 as usize].transformed(own);
        (there, self.drawing(within))
    }

    /// A flat shape, drawn out or turned.
    pub(super) fn flat_shape(
        &mut self,
        module: Module,
        statement: &Statement<'_>,
        drawing: DrawingId,
    ) -> Operand {
        let drawing = self.drawings[drawing.0 as usize];
        let mut workshop = self.workshop();
        let solid = match module {
            Module::Circle => workshop.circle(statement, drawing),
            Module::Square => workshop.square(statement, drawing),
            _ => workshop.polygon(statement, drawing),
        };
        Operand::Solid(Part::leaf(solid))
    }
}
