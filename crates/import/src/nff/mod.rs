//! Haines' Neutral File Format, version 3.1: the language of the Standard Procedural Databases.
//!
//! The format leaves the shading to the program. It is done here as the databases' own output for
//! POV-Ray has it, so that pictures can be compared; see [`material`]. Surfaces are
//! seen from both sides. The hither plane is for hidden-surface programs and is passed over.

mod cone;
pub mod material;
mod polygons;
mod words;

use std::path::Path;

use octray_geometry::{ShapeError, Solid};
use octray_math::DVec3;
use octray_scene::{Background, Camera, Encoding, Light, MaterialId, Object, SceneBuilder, View};

use crate::polygon::Triangulator;
use crate::text::{self, Word};
use crate::{Diagnostics, FileSystem, Imported, Options, SourceId, Span};
use polygons::Polygons;
use words::NffWords;

/// Reads the bytes of the file `path`.
#[must_use]
pub fn import(
    path: &Path,
    bytes: Vec<u8>,
    _files: &dyn FileSystem,
    _options: &Options,
) -> Imported {
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
    };
    while let Some(keyword) = reader.words.next() {
        reader.entity(keyword);
    }
    let builder = reader.end();
    Imported::finish(builder, diagnostics)
}

/// What stands after `v`.
#[derive(Default)]
struct ViewPoint {
    place: Option<Span>,
    from: Option<DVec3>,
    at: Option<DVec3>,
    up: Option<DVec3>,
    /// Degrees.
    angle: Option<f64>,
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

    /// Goes on to the next word that may begin an entity.
    fn skip(&mut self) {
        let begins = |word: &Word<'_>| {
            let keywords: [&[u8]; 14] = [
                b"v",
                b"from",
                b"at",
                b"up",
                b"angle",
                b"hither",
                b"resolution",
                b"b",
                b"l",
                b"f",
                b"s",
                b"c",
                b"p",
                b"pp",
            ];
            keywords.contains(&word.bytes)
        };
        while self.words.peek().is_some_and(|word| !begins(&word)) {
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

    fn angle(&mut self, keyword: Word<'_>) {
        let Some([degrees]) = self.numbers::<1>(keyword) else {
            return;
        };
        if degrees > 0.0 && degrees < 180.0 {
            self.view.angle = Some(degrees);
        } else {
            let message = format!("the angle must lie between 0 and 180 degrees, not {degrees}");
            self.diagnostics.error(keyword.span(self.source), message);
        }
    }

    fn resolution(&mut self, keyword: Word<'_>) {
        let Some(size) = self.numbers::<2>(keyword) else {
            return;
        };
        if size
            .iter()
            .all(|&n| libm::trunc(n) == n && (1.0..=65536.0).contains(&n))
        {
            let [width, height] = size.map(|n| n as u32);
            self.builder.settings_mut().size = Some((width, height));
        } else {
            let [width, height] = size;
            let message = format!("a picture of {width} by {height} pixels cannot be made");
            self.diagnostics.error(keyword.span(self.source), message);
        }
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

    fn current_material(&mut self, keyword: Word<'_>) -> MaterialId {
        if let Some(material) = self.material {
            return material;
        }
        let message = "no `f` comes before this: it gets the default material";
        self.diagnostics.warning(keyword.span(self.source), message);
        let material = self.builder.add_material(crate::dress::default_material());
        self.material = Some(material);
        material
    }

    fn sphere(&mut self, keyword: Word<'_>) {
        let Some([x, y, z, radius]) = self.numbers::<4>(keyword) else {
            return;
        };
        let material = self.current_material(keyword);
        // A negative radius shows only the inside; here both sides are always seen.
        let sphere = Solid::sphere(radius.abs()).and_then(|s| s.translate(DVec3::new(x, y, z)));
        let Some(solid) = self.made(keyword, sphere) else {
            return;
        };
        self.counts[0] += 1;
        let name = format!("sphere {}", self.counts[0]);
        self.builder
            .add_object(Object::solid(name, solid, material));
    }

    fn cone(&mut self, keyword: Word<'_>) {
        let Some([x0, y0, z0, r0, x1, y1, z1, r1]) = self.numbers::<8>(keyword) else {
            return;
        };
        let material = self.current_material(keyword);
        let (base, apex) = (DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1));
        let cone = cone::open_cone(base, r0.abs(), apex, r1.abs());
        let Some(sheet) = self.made(keyword, cone) else {
            return;
        };
        self.counts[1] += 1;
        let kind = if r0 == r1 { "cylinder" } else { "cone" };
        let name = format!("{kind} {}", self.counts[1]);
        self.builder
            .add_object(Object::sheet(name, sheet, material));
    }

    /// A shape, or a warning: what has no extent cannot be seen.
    fn made<T>(&mut self, keyword: Word<'_>, shape: Result<T, ShapeError>) -> Option<T> {
        match shape {
            Ok(shape) => Some(shape),
            Err(error) => {
                let message = format!("passed over: {error}");
                self.diagnostics.warning(keyword.span(self.source), message);
                None
            }
        }
    }

    fn polygon(&mut self, keyword: Word<'_>, with_normals: bool) {
        let span = keyword.span(self.source);
        let Some([count]) = self.numbers::<1>(keyword) else {
            return;
        };
        if !(count >= 3.0 && libm::trunc(count) == count) {
            let message = format!("a polygon has at least 3 vertices, not {count}");
            self.diagnostics.error(span, message);
            return self.skip();
        }
        self.current_material(keyword);
        let (mut corners, mut normals) = (Vec::new(), Vec::new());
        let mut finite = true;
        // The numbers there are decide how far this goes, not the count that is claimed.
        while (corners.len() as f64) < count {
            let mut values = [0.0; 6];
            let needed = if with_normals { 6 } else { 3 };
            for value in &mut values[..needed] {
                let Some(number) = self.number() else {
                    let message = format!(
                        "the polygon has {count} vertices, but only {} are complete",
                        corners.len()
                    );
                    self.diagnostics.error(span, message);
                    return self.skip();
                };
                finite &= number.is_finite();
                *value = number;
            }
            let [x, y, z, nx, ny, nz] = values;
            corners.push(DVec3::new(x, y, z));
            normals.push(DVec3::new(nx, ny, nz));
        }
        if !finite {
            return;
        }
        match self.triangulator.triangulate(&corners) {
            Ok(triangles) => {
                let normals = with_normals.then_some(&normals[..]);
                self.polygons.add(&corners, normals, &triangles);
            }
            Err(error) => self.diagnostics.error(span, error.to_string()),
        }
    }

    /// The polygons since the last `f` become one object.
    fn end_polygons(&mut self) {
        let polygons = std::mem::take(&mut self.polygons);
        let Some(material) = self.material.filter(|_| !polygons.is_empty()) else {
            return;
        };
        self.counts[2] += 1;
        let name = format!("polygons {}", self.counts[2]);
        match polygons.into_mesh() {
            Ok(mesh) => {
                let object = Object::sheet(name, octray_geometry::Sheet::mesh(mesh), material);
                self.builder.add_object(object);
            }
            Err(error) => self.diagnostics.error(None, format!("{name}: {error}")),
        }
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

    fn camera(&mut self) {
        let ViewPoint {
            place,
            from,
            at,
            up,
            angle,
        } = std::mem::take(&mut self.view);
        if let Some(up) = up.and_then(DVec3::try_normalize) {
            self.builder.settings_mut().up = up;
        }
        let Some(place) = place else {
            if from.is_none() {
                self.diagnostics
                    .warning(None, "no viewpoint `v`: all of the scene is shown");
            }
            return;
        };
        let (Some(from), Some(at), Some(up), Some(angle)) = (from, at, up, angle) else {
            let message = "a viewpoint needs `from`, `at`, `up` and `angle`";
            return self.diagnostics.error(place, message);
        };
        match Camera::look_at(from, at, up, angle.to_radians()) {
            Some(camera) => self.builder.set_camera(camera),
            None => self.diagnostics.error(
                place,
                "`from` and `at` must be apart, and `up` must not point along the view",
            ),
        }
    }
}
