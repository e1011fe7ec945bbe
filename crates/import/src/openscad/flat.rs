//! `circle`, `square` and `polygon`, drawn out between two heights.

use octray_geometry::Solid;
use octray_math::{DVec2, DVec3};
use robust::{Coord, orient2d};

use super::arguments::Arguments;
use super::facets::frustum;
use super::polyhedron::Polyhedron;
use super::primitives::Workshop;
use super::syntax::{Statement, Value};

/// Polygons with more edges are not tested for edges that cross, and left out.
const MAX_EDGES: usize = 2000;

impl Workshop<'_> {
    /// `circle(r)`.
    pub(super) fn circle(&mut self, statement: &Statement<'_>, z: [f64; 2]) -> Solid {
        let arguments = Arguments::bind(statement, &["r"], &["d"], self.diagnostics);
        let radius = arguments.radius("r", "d", self.diagnostics).unwrap_or(1.0);
        let resolution = arguments.resolution(self.diagnostics);
        if !(radius > 0.0 && radius.is_finite()) {
            let why = format!("a circle of radius {radius} has no inside");
            return self.empty(arguments.span(), &why);
        }
        let fragments = resolution.fragments(radius);
        self.round(
            arguments.span(),
            resolution,
            fragments,
            || frustum([radius; 2], z, fragments),
            Solid::cylinder(radius, z[0], z[1]).ok(),
        )
    }

    /// `square(size, center)`.
    pub(super) fn square(&mut self, statement: &Statement<'_>, z: [f64; 2]) -> Solid {
        let arguments = Arguments::bind(statement, &["size", "center"], &[], self.diagnostics);
        let size = match arguments.get("size").map(|argument| &argument.value) {
            Some(Value::Number(side)) => DVec2::splat(*side),
            Some(value) => match value.numbers().as_deref() {
                Some([x, y]) => DVec2::new(*x, *y),
                _ => return self.empty(arguments.span(), "a square has one size or two"),
            },
            None => DVec2::ONE,
        };
        let centered = arguments.boolean("center", self.diagnostics);
        if !(size.is_finite() && size.min_element() > 0.0) {
            let why = format!("a square of size [{}, {}] has no inside", size.x, size.y);
            return self.empty(arguments.span(), &why);
        }
        let low = if centered { size * -0.5 } else { size * 0.0 };
        let high = if centered { size * 0.5 } else { size };
        let solid = Solid::cuboid(low.extend(z[0]), high.extend(z[1]));
        solid.unwrap_or_else(|error| self.empty(arguments.span(), &error.to_string()))
    }

    /// `polygon(points, paths)`; `None` if it is of a kind that is not supported.
    ///
    /// Paths inside of paths are holes, and islands in holes, as OpenSCAD's even-odd rule has it.
    pub(super) fn polygon(&mut self, statement: &Statement<'_>, z: [f64; 2]) -> Option<Polyhedron> {
        let names = ["points", "paths", "convexity"];
        let arguments = Arguments::bind(statement, &names, &[], self.diagnostics);
        let span = arguments.span();
        let paths = match paths(&arguments) {
            Ok(paths) => paths,
            Err(why) => return Some(Polyhedron::Solid(self.empty(span, &why))),
        };
        let edges: Vec<[DVec2; 2]> = paths.iter().flat_map(|path| edges(path)).collect();
        let refused = if edges.len() > MAX_EDGES {
            Some(format!("of {} edges", edges.len()))
        } else if cross(&edges) {
            Some("with edges that cross".to_owned())
        } else {
            None
        };
        if let Some(which) = refused {
            let message = format!("a `polygon` {which} is not supported; it is left out");
            self.diagnostics.warning(span, message);
            return None;
        }
        let mut layers: Vec<Vec<Solid>> = Vec::new();
        for (index, path) in paths.iter().enumerate() {
            let (corners, faces) = prism(path, z);
            let solid = match self.assemble(corners, faces, span) {
                Polyhedron::Solid(solid) => solid,
                open @ Polyhedron::Open(..) => return Some(open),
            };
            let depth = paths[..index]
                .iter()
                .filter(|outer| surrounds(outer, path))
                .count();
            layers.resize(layers.len().max(depth + 1), Vec::new());
            layers[depth].push(solid);
        }
        let mut solid = Solid::empty();
        for (depth, solids) in layers.into_iter().enumerate() {
            let together = Solid::union(solids);
            solid = match depth {
                0 => together,
                _ if depth % 2 == 1 => Solid::difference([solid, together]),
                _ => Solid::union([solid, together]),
            };
        }
        Some(Polyhedron::Solid(solid))
    }
}

/// The outlines of a polygon, counter-clockwise, the largest first; none without area.
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
    let mut outlines: Vec<(f64, Vec<DVec2>)> = Vec::new();
    for mut path in chosen {
        path.dedup();
        while path.len() > 1 && path.first() == path.last() {
            path.pop();
        }
        let area = area(&path);
        if area < 0.0 {
            path.reverse();
        }
        if area != 0.0 {
            outlines.push((area.abs(), path));
        }
    }
    if outlines.is_empty() {
        return Err("a polygon without area has no inside".to_owned());
    }
    outlines.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(outlines.into_iter().map(|(_, path)| path).collect())
}

/// Gauss's formula.
fn area(path: &[DVec2]) -> f64 {
    let first = path.first().copied().unwrap_or_default();
    let twice = edges(path).map(|[a, b]| (a - first).perp_dot(b - first));
    twice.sum::<f64>() / 2.0
}

fn edges(path: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> {
    let next = path.iter().cycle().skip(1);
    path.iter().zip(next).map(|(a, b)| [*a, *b])
}

/// Positive where `point` lies left of the edge, with the sign exact.
fn side([a, b]: [DVec2; 2], point: DVec2) -> f64 {
    let [a, b, c] = [a, b, point].map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// Whether two edges cross in a point inside of both.
fn cross(edges: &[[DVec2; 2]]) -> bool {
    let opposite = |one: [DVec2; 2], other: [DVec2; 2]| {
        let (s, t) = (side(one, other[0]), side(one, other[1]));
        (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0)
    };
    edges.iter().enumerate().any(|(index, &one)| {
        let others = &edges[..index];
        others
            .iter()
            .any(|&other| opposite(one, other) && opposite(other, one))
    })
}

/// Whether a path lies in a larger one that it does not cross.
fn surrounds(outer: &[DVec2], path: &[DVec2]) -> bool {
    // A corner on the outline says nothing; the middle of an edge or another corner does.
    let middles = edges(path).map(|[a, b]| (a + b) / 2.0);
    for point in path.iter().copied().chain(middles) {
        let touches = |edge: [DVec2; 2]| {
            let within = (edge[0].min(edge[1]), edge[0].max(edge[1]));
            side(edge, point) == 0.0 && point.cmpge(within.0).all() && point.cmple(within.1).all()
        };
        if edges(outer).any(touches) {
            continue;
        }
        // A ray to the right crosses the outline an odd number of times.
        let crossed = edges(outer).filter(|&[a, b]| {
            let rises = b.y > a.y;
            (a.y > point.y) != (b.y > point.y) && (side([a, b], point) > 0.0) == rises
        });
        return crossed.count() % 2 == 1;
    }
    false
}

/// Corners and faces, counter-clockwise seen from outside, of a path drawn out.
fn prism(path: &[DVec2], z: [f64; 2]) -> (Vec<DVec3>, Vec<Vec<u32>>) {
    let count = path.len() as u32;
    let corners = z
        .iter()
        .flat_map(|&z| path.iter().map(move |p| p.extend(z)));
    let mut faces = vec![(0..count).rev().collect(), (count..2 * count).collect()];
    for i in 0..count {
        let next = (i + 1) % count;
        faces.push(vec![i, next, next + count, i + count]);
    }
    (corners.collect(), faces)
}
