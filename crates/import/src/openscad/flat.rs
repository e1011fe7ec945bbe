//! `circle`, `square` and `polygon`.

use octray_geometry::Solid;
use octray_geometry::profile::{Outline, Region};
use octray_math::DVec2;

use super::arguments::Arguments;
use super::drawing::Drawing;
use super::facets::{circle, frustum};
use super::primitives::Workshop;
use super::syntax::{Statement, Value};
use crate::Span;

impl Workshop<'_> {
    /// `circle(r)`.
    pub(super) fn circle(&mut self, statement: &Statement<'_>, drawing: Drawing) -> Solid {
        let arguments = Arguments::bind(statement, &["r"], &["d"], self.diagnostics);
        let radius = arguments.radius("r", "d", self.diagnostics).unwrap_or(1.0);
        let resolution = arguments.resolution(self.diagnostics);
        let span = arguments.span();
        if !(radius > 0.0 && radius.is_finite()) {
            let why = format!("a circle of radius {radius} has no inside");
            return self.empty(span, &why);
        }
        let fragments = resolution.fragments(radius);
        let turn = match drawing {
            Drawing::Out(slab) => {
                let radii = [radius, radius * slab.top];
                return self.round(
                    span,
                    resolution,
                    fragments,
                    || frustum(radii, slab.z, fragments),
                    Solid::cone(radii[0], radii[1], slab.z[0], slab.z[1]).ok(),
                );
            }
            Drawing::Turned(turn) => turn,
        };
        let has_corners =
            resolution.is_explicit() || self.options.facets || turn.turning.steps.is_some();
        let outline = if has_corners {
            Outline::polygon(&circle(radius, fragments).collect::<Vec<_>>())
        } else {
            Outline::circle(DVec2::ZERO, radius)
        };
        let edges = if has_corners { fragments } else { 1 };
        self.drawn(span, &[outline], edges, drawing)
    }

    /// `square(size, center)`.
    pub(super) fn square(&mut self, statement: &Statement<'_>, drawing: Drawing) -> Solid {
        let arguments = Arguments::bind(statement, &["size", "center"], &[], self.diagnostics);
        let span = arguments.span();
        let size = match arguments.get("size").map(|argument| &argument.value) {
            Some(Value::Number(side)) => DVec2::splat(*side),
            Some(value) => match value.numbers().as_deref() {
                Some([x, y]) => DVec2::new(*x, *y),
                _ => return self.empty(span, "a square has one size or two"),
            },
            None => DVec2::ONE,
        };
        let centered = arguments.boolean("center", self.diagnostics);
        if !(size.is_finite() && size.min_element() > 0.0) {
            let why = format!("a square of size [{}, {}] has no inside", size.x, size.y);
            return self.empty(span, &why);
        }
        let low = if centered { size * -0.5 } else { size * 0.0 };
        let high = if centered { size * 0.5 } else { size };
        if let Drawing::Out(slab) = drawing
            && slab.top == 1.0
        {
            let solid = Solid::cuboid(low.extend(slab.z[0]), high.extend(slab.z[1]));
            return solid.unwrap_or_else(|error| self.empty(span, &error.to_string()));
        }
        let corners = [
            low,
            DVec2::new(high.x, low.y),
            high,
            DVec2::new(low.x, high.y),
        ];
        self.drawn(span, &[Outline::polygon(&corners)], 4, drawing)
    }

    /// `polygon(points, paths)`.
    ///
    /// Paths inside of paths are holes, and islands in holes, as OpenSCAD's even-odd rule has it.
    pub(super) fn polygon(&mut self, statement: &Statement<'_>, drawing: Drawing) -> Solid {
        let names = ["points", "paths", "convexity"];
        let arguments = Arguments::bind(statement, &names, &[], self.diagnostics);
        let span = arguments.span();
        match paths(&arguments) {
            Ok(paths) => {
                let edges = paths.iter().map(Vec::len).sum();
                let outlines: Vec<Outline> = paths.iter().map(|p| Outline::polygon(p)).collect();
                self.drawn(span, &outlines, edges, drawing)
            }
            Err(why) => self.empty(span, &why),
        }
    }

    /// The solid of the region within the outlines.
    fn drawn(&mut self, span: Span, outlines: &[Outline], edges: usize, drawing: Drawing) -> Solid {
        let steps = match drawing {
            Drawing::Turned(turn) => turn.turning.steps.map_or(1, |steps| steps as usize),
            Drawing::Out(_) => 1,
        };
        if !self
            .budget
            .take_faces(edges.saturating_mul(steps), span, self.diagnostics)
        {
            return Solid::empty();
        }
        let solid = Region::new(outlines).and_then(|region| drawing.solid(&region));
        solid.unwrap_or_else(|error| self.empty(span, &error.to_string()))
    }
}

/// The outlines of a polygon.
fn paths(arguments: &Arguments<'_>) -> Result<Vec<Vec<DVec2>>, String> {
    let rows = |name: &str| match arguments.get(name).map(|argument| &argument.value) {
        Some(Value::Vector(rows)) => rows.iter().map(Value::numbers).collect::<Option<Vec<_>>>(),
        _ => None,
    };
    let points: Option<Vec<DVec2>> = rows("points")
        .unwrap_or_default()
        .iter()
        .map(|point| match point[..] {
            [x, y] | [x, y, _] => Some(DVec2::new(x, y)),
            _ => None,
        })
        .collect();
    let points = points.filter(|points| points.iter().all(|point| point.is_finite()));
    let points = points.ok_or("the points of a polygon have two finite coordinates")?;
    let chosen = match arguments.get("paths") {
        None => vec![points],
        Some(_) => {
            let rows = rows("paths").ok_or("the paths of a polygon are vectors of indices")?;
            let path = |row: &Vec<f64>| -> Option<Vec<DVec2>> {
                let point = |index: &f64| {
                    let valid = *index >= 0.0;
                    points.get(*index as usize).filter(|_| valid).copied()
                };
                row.iter().map(point).collect()
            };
            let all: Option<Vec<_>> = rows.iter().map(path).collect();
            all.ok_or("a path of a polygon uses a point it does not have")?
        }
    };
    Ok(chosen)
}
