//! Ascii STL: `solid`, `facet`, `outer loop`, `vertex`, `endloop`, `endfacet`, `endsolid`.

use octray_math::DVec3;

use super::{BYTES_PER_TRIANGLE, Part};
use crate::budget::Budget;
use crate::polygon::Triangulator;
use crate::text::{Lines, Word, Words, text_start};
use crate::{Diagnostics, SourceId, Span};

struct Reader<'a> {
    source: SourceId,
    diagnostics: &'a mut Diagnostics,
    budget: &'a mut Budget,
    triangulator: Triangulator,
    parts: Vec<Part>,
    part: Part,
    in_solid: bool,
    /// The corners since `outer loop`, and the line of that; `None` outside a loop.
    corners: Option<(Vec<DVec3>, Span)>,
    /// A corner of the loop was wrong and has been reported.
    spoiled: bool,
}

pub(super) fn read(
    bytes: &[u8],
    source: SourceId,
    budget: &mut Budget,
    diagnostics: &mut Diagnostics,
) -> Vec<Part> {
    let mut reader = Reader {
        source,
        diagnostics,
        budget,
        triangulator: Triangulator::new(),
        parts: Vec::new(),
        part: Part::default(),
        in_solid: false,
        corners: None,
        spoiled: false,
    };
    for (start, end) in Lines::new(bytes, text_start(bytes)) {
        let mut words = Words::new(bytes, start, end);
        if let Some(keyword) = words.next() {
            reader.line(keyword, words);
        }
        if reader.budget.is_exhausted() {
            return Vec::new();
        }
    }
    reader.end(bytes.len())
}

impl Reader<'_> {
    fn line(&mut self, keyword: Word<'_>, mut words: Words<'_>) {
        let span = keyword.span(self.source);
        if keyword.is("vertex") {
            self.vertex(keyword, words);
        } else if keyword.is("facet") || keyword.is("endfacet") {
            // What matters is between `outer loop` and `endloop`.
            self.close_loop();
        } else if keyword.is("outer") {
            self.close_loop();
            self.corners = Some((Vec::with_capacity(3), span));
            self.spoiled = false;
            if !words.next().is_some_and(|w| w.is("loop")) {
                self.diagnostics
                    .error(span, "`outer` must be followed by `loop`");
            }
        } else if keyword.is("endloop") {
            self.end_loop(span);
        } else if keyword.is("solid") {
            self.close_loop();
            self.end_solid();
            self.in_solid = true;
            self.part.name = words.rest().text().into_owned();
        } else if keyword.is("endsolid") {
            self.close_loop();
            self.end_solid();
        } else if keyword.is("color") {
            // An extension of some programs; three numbers follow.
        } else {
            let message = format!("`{}` is no keyword of STL", keyword.shown());
            self.diagnostics.error(span, message);
        }
    }

    fn vertex(&mut self, keyword: Word<'_>, mut words: Words<'_>) {
        let span = keyword.span(self.source);
        let mut position = DVec3::ZERO;
        for axis in 0..3 {
            let Some(word) = words.next() else {
                self.spoiled = true;
                let message = format!("a vertex has 3 coordinates, this one {axis}");
                return self.diagnostics.error(span, message);
            };
            match word.number() {
                Some(value) if value.is_finite() => position[axis] = value,
                number => {
                    self.spoiled = true;
                    let what = if number.is_some() {
                        "finite"
                    } else {
                        "a number"
                    };
                    let message = format!("`{}` is not {what}", word.shown());
                    return self.diagnostics.error(word.span(self.source), message);
                }
            }
        }
        match &mut self.corners {
            Some((corners, _)) => corners.push(position),
            None => self
                .diagnostics
                .error(span, "this vertex is not in an `outer loop`"),
        }
    }

    /// The triangles of a loop.
    fn end_loop(&mut self, span: Span) {
        let Some((corners, start)) = self.corners.take() else {
            return self
                .diagnostics
                .error(span, "`endloop` without `outer loop`");
        };
        if self.spoiled || !self.budget.take(BYTES_PER_TRIANGLE * corners.len()) {
            return;
        }
        if corners.len() < 3 {
            let message = format!("a loop has 3 vertices, this one {}", corners.len());
            return self.diagnostics.error(start, message);
        }
        match self.triangulator.triangulate(&corners) {
            Ok(triangles) => {
                for triangle in triangles {
                    self.part.add(triangle.map(|i| corners[i as usize]));
                }
            }
            Err(error) => self.diagnostics.error(start, error.to_string()),
        }
    }

    /// Something begins or ends that no loop goes across.
    fn close_loop(&mut self) {
        if let Some((_, start)) = self.corners.take() {
            self.diagnostics.error(start, "this loop has no `endloop`");
        }
    }

    fn end_solid(&mut self) {
        self.in_solid = false;
        let part = std::mem::take(&mut self.part);
        if !part.triangles.is_empty() {
            self.parts.push(part);
        }
    }

    fn end(mut self, length: usize) -> Vec<Part> {
        let end = Span::new(self.source, length..length);
        if self.corners.is_some() {
            self.diagnostics.error(end, "the file ends inside a facet");
        } else if self.in_solid {
            self.diagnostics
                .error(end, "the file ends without `endsolid`: it is not complete");
        }
        self.end_solid();
        self.parts
    }
}
