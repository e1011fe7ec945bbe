//! The statements of an OBJ file.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use octray_math::{DVec2, DVec3};
use octray_scene::srgb_to_linear;

use super::lines::{JoinedLines, Statement};
use crate::budget::Budget;
use crate::text::Word;
use crate::{Diagnostics, Options, SourceId, Span};

/// A corner has no such reference.
pub(super) const NONE: u32 = u32::MAX;

/// A vertex with its colour, or a face without its corners.
const BYTES_PER_STATEMENT: usize = 96;

/// What a file says.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub positions: Vec<DVec3>,
    /// Linear, by vertex, `None` for vertices without; empty if no vertex has a colour.
    pub colors: Vec<Option<DVec3>>,
    pub normals: Vec<DVec3>,
    pub texcoords: Vec<DVec2>,
    /// Indices of position, texture coordinate and normal.
    pub corners: Vec<[u32; 3]>,
    pub faces: Vec<Face>,
    /// Names of objects and groups.
    pub objects: Vec<String>,
    /// Names after `usemtl`, each with its first place.
    pub materials: Vec<(String, Span)>,
    /// What stands after each `mtllib`.
    pub libraries: Vec<(Span, String)>,
}

/// A polygon.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// Its part of [`Model::corners`].
    pub corners: Range<usize>,
    /// Index into [`Model::objects`].
    pub object: u32,
    /// Index into [`Model::materials`].
    pub material: Option<u32>,
    /// 0 is none.
    pub smoothing: u32,
    /// Its first byte in the file.
    pub start: usize,
}

pub(super) struct Reader<'a> {
    pub source: SourceId,
    pub diagnostics: &'a mut Diagnostics,
    pub model: Model,
    /// How many positions, texture coordinates and normals the whole file has: a face may name
    /// vertices that come after it.
    pub totals: [usize; 3],
    pub object_name: String,
    pub group_name: String,
    pub object_index: BTreeMap<String, u32>,
    pub object: Option<u32>,
    material_index: BTreeMap<String, u32>,
    pub material: Option<u32>,
    pub smoothing: u32,
    /// Keywords already warned about.
    warned: BTreeSet<Vec<u8>>,
    pub missing_warned: [bool; 3],
    pub budget: Budget,
}

pub(super) fn read(
    bytes: &[u8],
    source: SourceId,
    options: &Options,
    diagnostics: &mut Diagnostics,
) -> Model {
    let mut totals = [0; 3];
    for mut statement in JoinedLines::new(bytes) {
        match statement.next().map(|w| w.bytes) {
            Some(b"v") => totals[0] += 1,
            Some(b"vt") => totals[1] += 1,
            Some(b"vn") => totals[2] += 1,
            _ => {}
        }
    }
    let mut reader = Reader {
        source,
        diagnostics,
        model: Model::default(),
        totals,
        object_name: String::new(),
        group_name: String::new(),
        object_index: BTreeMap::new(),
        object: None,
        material_index: BTreeMap::new(),
        material: None,
        smoothing: 0,
        warned: BTreeSet::new(),
        missing_warned: [false; 3],
        budget: Budget::new(options.memory_budget),
    };
    for mut statement in JoinedLines::new(bytes) {
        if let Some(keyword) = statement.next() {
            reader.budget.take(BYTES_PER_STATEMENT);
            reader.statement(keyword, statement);
        }
        if reader.budget.is_exhausted() {
            reader.budget.report(reader.diagnostics);
            break;
        }
    }
    reader.model
}

impl Reader<'_> {
    fn statement(&mut self, keyword: Word<'_>, statement: Statement<'_>) {
        match keyword.bytes {
            b"v" => self.vertex(keyword, statement),
            b"vt" => {
                let [u, v, _] = self.numbers(keyword, statement, 1).0;
                self.model.texcoords.push(DVec2::new(u, v));
            }
            b"vn" => {
                let n = self.numbers(keyword, statement, 3).0;
                self.model.normals.push(DVec3::from_array(n));
            }
            b"f" | b"fo" => self.face(keyword, statement),
            b"o" => {
                self.object_name = statement.rest().text().into_owned();
                self.group_name.clear();
                self.object = None;
            }
            b"g" => {
                let names: Vec<_> = statement.map(|w| w.text()).collect();
                self.group_name = names.join(" ");
                self.object = None;
            }
            b"s" => self.smoothing_group(statement),
            b"usemtl" => self.use_material(keyword, &statement),
            b"mtllib" => {
                let rest = statement.rest();
                if rest.bytes.is_empty() {
                    let message = "`mtllib` must name a file";
                    self.diagnostics.warning(keyword.span(self.source), message);
                } else {
                    let library = (rest.span(self.source), rest.text().into_owned());
                    self.model.libraries.push(library);
                }
            }
            b"p" | b"l" => self.passed_over(keyword, "points and lines have no surface"),
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf"
            | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech"
            | b"stech" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res" => {
                self.passed_over(keyword, "free-form curves and surfaces are not read");
            }
            // About display, not about shape.
            b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj"
            | b"trace_obj" | b"usemap" | b"maplib" => {
                self.passed_over(keyword, "it says nothing about the shape");
            }
            _ => self.passed_over(keyword, "it is no statement of OBJ"),
        }
    }

    /// Warns once per keyword.
    fn passed_over(&mut self, keyword: Word<'_>, why: &str) {
        // A file of nothing but nonsense must not fill the memory with it.
        if self.warned.len() < Diagnostics::LIMIT && self.warned.insert(keyword.bytes.to_vec()) {
            let message = format!("`{}` is passed over: {why}", keyword.shown());
            self.diagnostics.warning(keyword.span(self.source), message);
        }
    }

    /// Up to three finite numbers, at least `least`, and whether all is well with them; what is
    /// missing or wrong is 0.
    fn numbers(
        &mut self,
        keyword: Word<'_>,
        statement: Statement<'_>,
        least: usize,
    ) -> ([f64; 3], bool) {
        let mut values = [0.0; 3];
        let mut count = 0;
        let mut good = true;
        for (value, word) in values.iter_mut().zip(statement) {
            match self.number(word) {
                Some(number) => *value = number,
                None => good = false,
            }
            count += 1;
        }
        if count < least {
            let message = format!("`{}` has {least} numbers, not {count}", keyword.shown());
            self.diagnostics.error(keyword.span(self.source), message);
            good = false;
        }
        (values, good)
    }

    fn number(&mut self, word: Word<'_>) -> Option<f64> {
        let what = match word.number() {
            Some(value) if value.is_finite() => return Some(value),
            Some(_) => "finite",
            None => "a number",
        };
        let message = format!("`{}` is not {what}", word.shown());
        self.diagnostics.error(word.span(self.source), message);
        None
    }

    fn vertex(&mut self, keyword: Word<'_>, statement: Statement<'_>) {
        // x y z, x y z w, x y z r g b, or x y z w r g b; w only matters for free-form surfaces.
        let after = statement.clone().skip(3).take(5);
        let extra: Vec<Option<f64>> = after.map(|word| word.number()).collect();
        let (position, good) = self.numbers(keyword, statement, 3);
        let color = match extra[..] {
            [Some(r), Some(g), Some(b)] | [_, Some(r), Some(g), Some(b)] => Some([r, g, b]),
            [] | [Some(_)] => None,
            _ => {
                if good {
                    let message = "a vertex has 3 coordinates, possibly a weight, and possibly a \
                                   colour of 3 numbers";
                    self.diagnostics.error(keyword.span(self.source), message);
                }
                None
            }
        };
        if let Some(color) = color.filter(|c| c.iter().all(|x| x.is_finite())) {
            let linear = |x: f64| srgb_to_linear(x.clamp(0.0, 1.0));
            self.model.colors.resize(self.model.positions.len(), None);
            let color = DVec3::from_array(color.map(linear));
            self.model.colors.push(Some(color));
        }
        self.model.positions.push(DVec3::from_array(position));
    }

    fn smoothing_group(&mut self, mut statement: Statement<'_>) {
        let Some(word) = statement.next() else {
            return;
        };
        self.smoothing = if word.is("off") {
            0
        } else if let Some(group) = word.integer() {
            // Only which faces share a group matters.
            (group & 0xffff_ffff) as u32
        } else {
            let message = format!("`{}` is no smoothing group", word.shown());
            self.diagnostics.warning(word.span(self.source), message);
            0
        };
    }

    fn use_material(&mut self, keyword: Word<'_>, statement: &Statement<'_>) {
        let rest = statement.rest();
        let name = rest.text().into_owned();
        let next = self.model.materials.len() as u32;
        let index = *self.material_index.entry(name.clone()).or_insert(next);
        if index == next {
            let place = if rest.bytes.is_empty() { keyword } else { rest };
            let span = place.span(self.source);
            if name.is_empty() {
                let message = "`usemtl` without a name: the default material is used";
                self.diagnostics.warning(span, message);
            }
            self.model.materials.push((name, span));
        }
        self.material = Some(index);
    }
}
