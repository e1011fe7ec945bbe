//! The elements of a PLY file that make a mesh.

use octray_math::{DVec2, DVec3};

use super::color::color_columns;
use super::header::{Element, Header, Kind};
use super::rows::{Body, Row};
use crate::budget::Budget;
use crate::polygon::Triangulator;
use crate::{Diagnostics, Options, SourceId};

/// Position, normal, texture coordinates, colour.
const BYTES_PER_VERTEX: usize = 96;
/// A corner's share of its face and of the triangles with their attributes.
const BYTES_PER_CORNER: usize = 64;

/// What has been read.
#[derive(Debug, Default)]
pub(super) struct Tables {
    pub positions: Vec<DVec3>,
    pub normals: Option<Vec<DVec3>>,
    pub texcoords: Option<Vec<DVec2>>,
    /// Linear, per vertex.
    pub colors: Option<Vec<DVec3>>,
    pub triangles: Vec<[u32; 3]>,
    /// Linear, per triangle; empty if no face has a colour.
    pub face_colors: Vec<Option<DVec3>>,
}

struct Reader<'a> {
    body: Body<'a>,
    diagnostics: &'a mut Diagnostics,
    tables: Tables,
    /// Faces with their corners, split when all positions are known.
    faces: Faces,
    vertex_count: u64,
    budget: Budget,
}

#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    faces: Vec<Face>,
}

struct Face {
    /// Where it ends in [`Faces::corners`].
    end: usize,
    /// Its bytes in the file.
    place: std::ops::Range<usize>,
    color: Option<DVec3>,
}

/// Reads the body. `None` if it cannot be read to its end; other errors are only reported.
pub(super) fn read(
    bytes: &[u8],
    source: SourceId,
    header: &Header,
    options: &Options,
    diagnostics: &mut Diagnostics,
) -> Option<Tables> {
    let vertices = header.elements.iter().find(|e| e.name == "vertex");
    let mut reader = Reader {
        body: Body::new(bytes, header.body, header.format, source),
        diagnostics,
        tables: Tables::default(),
        faces: Faces::default(),
        vertex_count: vertices.map_or(0, |e| e.count),
        budget: Budget::new(options.memory_budget),
    };
    for element in &header.elements {
        let least = element.least_row_length(header.format);
        if least == 0 {
            continue;
        }
        // The last row of a text need not end with a newline.
        let left = reader.body.left() as u64 + u64::from(header.format.is_text());
        if element.count > left / least {
            let message = format!(
                "`{}` is said to have {} rows of at least {least} bytes, but only {left} bytes \
                 follow",
                element.name, element.count
            );
            reader.diagnostics.error(element.span, message);
            return None;
        }
        match element.name.as_str() {
            "vertex" => reader.vertices(element)?,
            "face" => reader.faces(element, false)?,
            "tristrips" => reader.faces(element, true)?,
            _ => reader.each_row(element, |_, _| {})?,
        }
    }
    reader.split_faces();
    Some(reader.tables)
}

impl Reader<'_> {
    /// Hands every good row to `take`; `None` if the rest of the body cannot be read.
    fn each_row(&mut self, element: &Element, mut take: impl FnMut(&mut Self, &Row)) -> Option<()> {
        let mut row = Row::default();
        for _ in 0..element.count {
            match self.body.read_row(element, &mut row) {
                Ok(()) => {
                    take(self, &row);
                    if self.budget.is_exhausted() {
                        self.budget.report(self.diagnostics);
                        return None;
                    }
                }
                Err(bad) => {
                    self.body.report(&bad, self.diagnostics);
                    if !bad.next_is_known {
                        return None;
                    }
                    // Rows are counted by index: a bad vertex leaves a hole, not a shift.
                    if element.name == "vertex" {
                        self.tables.positions.push(DVec3::ZERO);
                    }
                }
            }
        }
        Some(())
    }

    fn vertices(&mut self, element: &Element) -> Option<()> {
        let [x, y, z] = [["x"], ["y"], ["z"]].map(|names| element.column(&names));
        let (Some(x), Some(y), Some(z)) = (x, y, z) else {
            let message = "the element `vertex` must have the properties x, y and z";
            self.diagnostics.error(element.span, message);
            return None;
        };
        let normal = columns(element, [&["nx"], &["ny"], &["nz"]]);
        let uv = columns(
            element,
            [
                &["u", "s", "texture_u", "texture_s"],
                &["v", "t", "texture_v", "texture_t"],
            ],
        );
        let color = color_columns(element);
        let (mut normals, mut texcoords, mut colors) = (Vec::new(), Vec::new(), Vec::new());
        self.budget
            .reserve(&mut self.tables.positions, element.count);
        self.each_row(element, |reader, row| {
            reader.budget.take(BYTES_PER_VERTEX);
            let p = DVec3::new(row.number(x), row.number(y), row.number(z));
            if !p.is_finite() {
                let index = reader.tables.positions.len();
                let message = format!("vertex {index} is not finite: ({}, {}, {})", p.x, p.y, p.z);
                reader
                    .body
                    .error(row.place.clone(), &message, reader.diagnostics);
            }
            reader.tables.positions.push(p);
            if let Some(columns) = normal {
                let n = DVec3::from_array(columns.map(|c| row.number(c)));
                // Zero stands for "as the face".
                normals.push(if n.is_finite() { n } else { DVec3::ZERO });
            }
            if let Some(columns) = uv {
                let uv = DVec2::from_array(columns.map(|c| row.number(c)));
                texcoords.push(if uv.is_finite() { uv } else { DVec2::ZERO });
            }
            if let Some(columns) = color {
                colors.push(columns.color(row));
            }
        })?;
        self.tables.normals = normal.map(|_| normals);
        self.tables.texcoords = uv.map(|_| texcoords);
        self.tables.colors = color.map(|_| colors);
        Some(())
    }

    fn faces(&mut self, element: &Element, strips: bool) -> Option<()> {
        let column = element.column(&["vertex_indices", "vertex_index"]);
        let column = column.filter(|&c| match element.properties[c].kind {
            Kind::List { item, .. } => item.is_integer(),
            Kind::One(_) => false,
        });
        let Some(column) = column else {
            let message = format!(
                "the element `{}` must have a list of integers `vertex_indices`",
                element.name
            );
            self.diagnostics.error(element.span, message);
            return None;
        };
        let color = color_columns(element);
        if !strips {
            self.budget.reserve(&mut self.faces.faces, element.count);
        }
        self.each_row(element, |reader, row| {
            let corners = row.list(column);
            let color = color.map(|columns| columns.color(row));
            if strips {
                reader.strip(corners, color, row);
            } else {
                reader.face(corners, color, row);
            }
        })
    }

    fn face(&mut self, corners: &[f64], color: Option<DVec3>, row: &Row) {
        if corners.len() < 3 {
            let message = format!("a face has at least 3 corners, this one {}", corners.len());
            self.body
                .error(row.place.clone(), &message, self.diagnostics);
            return;
        }
        if !self.budget.take(BYTES_PER_CORNER * corners.len()) {
            return;
        }
        let start = self.faces.corners.len();
        for &corner in corners {
            if let Some(index) = self.index(corner, row) {
                self.faces.corners.push(index);
            } else {
                self.faces.corners.truncate(start);
                return;
            }
        }
        self.faces.faces.push(Face {
            end: self.faces.corners.len(),
            place: row.place.clone(),
            color,
        });
    }

    /// Adds the triangles of strips; -1 begins a new strip.
    fn strip(&mut self, corners: &[f64], color: Option<DVec3>, row: &Row) {
        for strip in corners.split(|&c| c == -1.0) {
            for (i, triple) in strip.windows(3).enumerate() {
                let [a, b, c] = [triple[0], triple[1], triple[2]];
                // Every second triangle is turned, or it would show its back.
                let triangle = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                // Strips turn corners by triangles that name a vertex twice.
                if a != b && b != c && c != a {
                    self.face(&triangle, color, row);
                }
            }
        }
    }

    fn index(&mut self, corner: f64, row: &Row) -> Option<u32> {
        let count = self.vertex_count;
        if corner >= 0.0 && corner < count as f64 && libm::trunc(corner) == corner {
            return Some(corner as u32);
        }
        let message = format!("the face uses vertex {corner}, but there are {count} (from 0)");
        self.body
            .error(row.place.clone(), &message, self.diagnostics);
        None
    }

    fn split_faces(&mut self) {
        if self.diagnostics.has_errors() {
            return;
        }
        let mut triangulator = Triangulator::new();
        let faces = std::mem::take(&mut self.faces);
        let colored = faces.faces.iter().any(|face| face.color.is_some());
        let mut start = 0;
        let mut outline = Vec::new();
        for Face { end, place, color } in &faces.faces {
            let corners = &faces.corners[start..*end];
            start = *end;
            outline.clear();
            outline.extend(corners.iter().map(|&i| self.tables.positions[i as usize]));
            let triangles = match triangulator.triangulate(&outline) {
                Ok(triangles) => triangles,
                Err(error) => {
                    self.body
                        .error(place.clone(), &error.to_string(), self.diagnostics);
                    return;
                }
            };
            if colored {
                let colors = triangles.iter().map(|_| *color);
                self.tables.face_colors.extend(colors);
            }
            let named = |t: [u32; 3]| t.map(|i| corners[i as usize]);
            self.tables
                .triangles
                .extend(triangles.into_iter().map(named));
        }
    }
}

/// The columns of these names, if all are there.
pub(super) fn columns<const N: usize>(
    element: &Element,
    names: [&[&str]; N],
) -> Option<[usize; N]> {
    let found = names.map(|names| element.column(names));
    found
        .iter()
        .all(Option::is_some)
        .then(|| found.map(Option::unwrap_or_default))
}
