//! Faces: which vertices they join, and to which object they belong.

use super::lines::Statement;
use super::syntax::{Face, NONE, Reader};
use crate::text::Word;

/// Its indices, and its share of the triangles with their attributes.
const BYTES_PER_CORNER: usize = 96;

/// What a corner names.
const ATTRIBUTES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

impl Reader<'_> {
    pub(super) fn face(&mut self, keyword: Word<'_>, statement: Statement<'_>) {
        let start = self.model.corners.len();
        let mut good = true;
        for word in statement {
            if !self.budget.take(BYTES_PER_CORNER) {
                return;
            }
            match self.corner(word) {
                Some(corner) => self.model.corners.push(corner),
                None => good = false,
            }
        }
        let count = self.model.corners.len() - start;
        if good && count < 3 {
            let message = format!("a face has at least 3 corners, this one {count}");
            self.diagnostics.error(keyword.span(self.source), message);
            good = false;
        }
        if !good {
            self.model.corners.truncate(start);
            return;
        }
        let face = Face {
            corners: start..start + count,
            object: self.object(),
            material: self.material,
            smoothing: self.smoothing,
            start: keyword.start,
        };
        self.model.faces.push(face);
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    pub(super) fn corner(&mut self, word: Word<'_>) -> Option<[u32; 3]> {
        let so_far = [
            self.model.positions.len(),
            self.model.texcoords.len(),
            self.model.normals.len(),
        ];
        let mut corner = [NONE; 3];
        let mut at = word.start;
        for (field, bytes) in word.bytes.split(|&b| b == b'/').enumerate() {
            let part = Word { bytes, start: at };
            at += bytes.len() + 1;
            if field > 0 && (bytes.is_empty() || self.totals.get(field) == Some(&0)) {
                if !bytes.is_empty() {
                    self.missing_attribute(field, part);
                }
                continue;
            }
            let (Some(index), Some(total)) = (part.integer(), self.totals.get(field)) else {
                let message = format!("`{}` is no corner of a face", word.shown());
                self.diagnostics.error(word.span(self.source), message);
                return None;
            };
            let resolved = match index {
                0 => None,
                1.. => usize::try_from(index - 1).ok(),
                _ => usize::try_from(index.unsigned_abs())
                    .ok()
                    .and_then(|back| so_far[field].checked_sub(back)),
            };
            let Some(resolved) = resolved.filter(|r| r < total && *r < NONE as usize) else {
                let name = ATTRIBUTES[field];
                let message = match index {
                    0 => format!("{name} 0 does not exist: counting begins at 1"),
                    1.. => format!("the face uses {name} {index}, but there are {total}"),
                    _ => format!(
                        "the face uses {name} {index}, but only {} come before it",
                        so_far[field]
                    ),
                };
                self.diagnostics.error(part.span(self.source), message);
                return None;
            };
            corner[field] = resolved as u32;
        }
        Some(corner)
    }

    /// Some programs name normals or texture coordinates that they did not export.
    pub(super) fn missing_attribute(&mut self, field: usize, part: Word<'_>) {
        if !self.missing_warned[field] {
            self.missing_warned[field] = true;
            let message = format!(
                "the faces name {}s, but the file has none",
                ATTRIBUTES[field]
            );
            self.diagnostics.warning(part.span(self.source), message);
        }
    }

    /// The index of the current object, made when its first face comes.
    pub(super) fn object(&mut self) -> u32 {
        if let Some(index) = self.object {
            return index;
        }
        let (object, group) = (&self.object_name, &self.group_name);
        let name = match (object.as_str(), group.as_str()) {
            ("", name) | (name, "") => name.to_owned(),
            (object, group) if object == group => group.to_owned(),
            (object, group) => format!("{object}/{group}"),
        };
        let next = self.model.objects.len() as u32;
        let index = *self.object_index.entry(name.clone()).or_insert(next);
        if index == next {
            self.model.objects.push(name);
        }
        self.object = Some(index);
        index
    }
}
