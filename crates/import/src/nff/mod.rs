//! Haines' Neutral File Format, version 3.1: the language of the Standard Procedural Databases.
//!
//! The format leaves the shading to the program. It is done here as the databases' own output for
//! POV-Ray has it, so that pictures can be compared; see [`material`]. Surfaces are
//! seen from both sides. The hither plane is for hidden-surface programs and is passed over.

mod cone;
pub mod material;
mod polygons;
mod shapes;
mod view;
mod words;

use std::path::Path;

use octray_math::DVec3;
use octray_scene::{Background, Encoding, Light, MaterialId, SceneBuilder, View};

use crate::budget::Budget;
use crate::polygon::Triangulator;
use crate::text::{self, Word};
use crate::{Diagnostics, FileSystem, Imported, Options, SourceId};
use polygons::Polygons;
use view::ViewPoint;
use words::NffWords;

/// An object with its shape, or a material.
const BYTES_PER_ENTITY: usize = 1024;
/// A corner of a polygon, with vertex and normal and their places in the tables.
const BYTES_PER_CORNER: usize = 256;

/// Reads the bytes of the file `path`.
#[must_use]
pub fn import(path: &Path, bytes: Vec<u8>, _files: &dyn FileSystem, options: &Options) -> Imported {
    let mut diagnostics = Diagnostics::default();
    let source = diagnostics.add_source(path, bytes);
    let bytes = diagnostics.shared_source(source);
    if bytes.is_empty() {
        diagnostics.error(None, "the file is empty");
        return Imported::failed(diagnostics);
    }
    if let Some(encoding) = text::encoding_problem(&bytes) {
        let message = format!("the file is {encoding}: an NFF file is plain text");
        diagnostics.error(None, message);
        return Imported::failed(diagnostics);
    }
    let mut builder = SceneBuilder::new();
    let settings = builder.settings_mut();
    // The databases' pictures are made without gamma correction.
    settings.encoding = Encoding::Srgb;
    settings.view = View::Standard;
    settings.max_generations = material::MAX_GENERATIONS;
    settings.contribution_threshold = material::CONTRIBUTION_THRESHOLD;
    let mut reader = Reader {
        source,
        diagnostics: &mut diagnostics,
        words: NffWords::new(&bytes),
        builder,
        view: ViewPoint::default(),
        lights: Vec::new(),
        material: None,
        polygons: Polygons::default(),
        triangulator: Triangulator::new(),
        counts: [0; 3],
        budget: Budget::new(options.memory_budget),
    };
    while let Some(keyword) = reader.words.next() {
        reader.budget.take(BYTES_PER_ENTITY);
        reader.entity(keyword);
        if reader.budget.is_exhausted() {
            reader.budget.report(reader.diagnostics);
            break;
        }
    }
    let builder = reader.end();
    Imported::finish(builder, diagnostics)
}

struct Reader<'a> {
    source: SourceId,
    diagnostics: &'a mut Diagnostics,
    words: NffWords<'a>,
    builder: SceneBuilder,
    view: ViewPoint,
    lights: Vec<(DVec3, Option<DVec3>)>,
    material: Option<MaterialId>,
    polygons: Polygons,
    triangulator: Triangulator,
    /// Spheres, cones and polygon groups so far, for names.
    counts: [usize; 3],
    budget: Budget,
}

impl Reader<'_> {
    fn entity(&mut self, keyword: Word<'_>) {
        let span = keyword.span(self.source);
        match keyword.bytes {
            b"v" => self.view.place = Some(span),
            b"from" => self.view.from = self.vector(keyword).or(self.view.from),
            b"at" => self.view.at = self.vector(keyword).or(self.view.at),
            b"up" => self.view.up = self.vector(keyword).or(self.view.up),
            b"angle" => self.angle(keyword),
            b"hither" => {
                self.numbers::<1>(keyword);
            }
            b"resolution" => self.resolution(keyword),
            b"b" => {
                if let Some(color) = self.vector(keyword) {
                    self.builder.set_background(Background::Uniform(color));
                }
            }
            b"l" => self.light(keyword),
            b"f" => self.fill(keyword),
            b"s" => self.sphere(keyword),
            b"c" => self.cone(keyword),
            b"p" => self.polygon(keyword, false),
            b"pp" => self.polygon(keyword, true),
            _ => {
                let what = if keyword.number().is_some() {
                    "expected here"
                } else {
                    "an NFF entity"
                };
                let message = format!("`{}` is not {what}", keyword.shown());
                self.diagnostics.error(span, message);
                self.skip();
            }
        }
    }

    /// Goes on to the next word that is no number.
    fn skip(&mut self) {
        let is_number = |word: Word<'_>| word.number().is_some();
        while self.words.peek().is_some_and(is_number) {
            self.words.next();
        }
    }

    fn number(&mut self) -> Option<f64> {
        let value = self.words.peek()?.number()?;
        let word = self.words.next()?;
        if !value.is_finite() {
            let message = format!("`{}` is not finite", word.shown());
            self.diagnostics.error(word.span(self.source), message);
        }
        Some(value)
    }

    /// Exactly `N` finite numbers; otherwise it has been reported.
    fn numbers<const N: usize>(&mut self, keyword: Word<'_>) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (count, value) in values.iter_mut().enumerate() {
            let Some(number) = self.number() else {
                self.too_few(keyword, N, count);
                return None;
            };
            *value = number;
        }
        values.iter().all(|v| v.is_finite()).then_some(values)
    }

    fn too_few(&mut self, keyword: Word<'_>, needed: usize, given: usize) {
        let found = match self.words.peek() {
            Some(word) => format!("then comes `{}`", word.shown()),
            None => "then the file ends".to_owned(),
        };
        let message = format!(
            "`{}` needs {needed} numbers here; there are {given}, {found}",
            keyword.shown()
        );
        self.diagnostics.error(keyword.span(self.source), message);
        self.skip();
    }

    fn vector(&mut self, keyword: Word<'_>) -> Option<DVec3> {
        self.numbers::<3>(keyword).map(DVec3::from_array)
    }

    fn light(&mut self, keyword: Word<'_>) {
        let Some(position) = self.vector(keyword) else {
            return;
        };
        let has_color = self.words.peek().is_some_and(|w| w.number().is_some());
        let color = if has_color {
            self.vector(keyword)
        } else {
            None
        };
        self.lights.push((position, color));
    }

    fn fill(&mut self, keyword: Word<'_>) {
        self.end_polygons();
        let Some([r, g, b, kd, ks, shine, t, ior]) = self.numbers::<8>(keyword) else {
            return;
        };
        let fill = material::Fill {
            color: DVec3::new(r, g, b),
            kd,
            ks,
            shine,
            t,
            ior,
        };
        let name = format!("fill {}", self.builder.so_far().materials().len() + 1);
        self.material = Some(self.builder.add_material(fill.material(&name)));
    }

    fn end(mut self) -> SceneBuilder {
        self.end_polygons();
        let count = self.lights.len();
        for (position, color) in std::mem::take(&mut self.lights) {
            let color = color.unwrap_or_else(|| material::light_color(count));
            self.builder.add_light(Light::point(position, color));
        }
        self.camera();
        self.builder
    }
}
