//! Material libraries.
//!
//! The colours are taken as linear. `illum` says which terms count: 0 colour alone, 1 diffuse,
//! 2 highlights too, from 3 on mirrors; 4, 6, 7 and 9 are glass.

use octray_math::DVec3;
use octray_scene::{Color, Finish, Interior, Material, Pigment, Reflection};

use super::lines::{JoinedLines, Statement};
use crate::text::Word;
use crate::{Diagnostics, SourceId, Span, text};

/// The numbers of one `newmtl`, as far as they are given.
#[derive(Default)]
struct Entry {
    name: String,
    ambient: Option<DVec3>,
    diffuse: Option<DVec3>,
    specular: Option<DVec3>,
    emission: Option<DVec3>,
    filter: Option<DVec3>,
    exponent: Option<f64>,
    opacity: Option<f64>,
    ior: Option<f64>,
    illum: Option<i64>,
    /// Where its first texture stands.
    texture: Option<Span>,
}

struct Reader<'a> {
    source: SourceId,
    diagnostics: &'a mut Diagnostics,
    materials: Vec<Material>,
    entry: Option<Entry>,
}

/// Reads a library. What is wrong is reported.
pub(super) fn read(bytes: &[u8], source: SourceId, diagnostics: &mut Diagnostics) -> Vec<Material> {
    if let Some(encoding) = text::encoding_problem(bytes) {
        let message = format!("the material library is {encoding}, not plain text: not used");
        diagnostics.warning(Span::new(source, 0..0), message);
        return Vec::new();
    }
    let mut reader = Reader {
        source,
        diagnostics,
        materials: Vec::new(),
        entry: None,
    };
    for mut statement in JoinedLines::new(bytes) {
        if let Some(keyword) = statement.next() {
            reader.statement(keyword, statement);
        }
    }
    reader.finish_entry();
    reader.materials
}

impl Reader<'_> {
    fn statement(&mut self, keyword: Word<'_>, statement: Statement<'_>) {
        if keyword.bytes == b"newmtl" {
            self.finish_entry();
            self.entry = Some(Entry {
                name: statement.rest().text().into_owned(),
                ..Entry::default()
            });
            return;
        }
        let span = keyword.span(self.source);
        let Some(mut entry) = self.entry.take() else {
            return self
                .diagnostics
                .warning(span, "passed over: it comes before any `newmtl`");
        };
        match keyword.bytes {
            b"Ka" => entry.ambient = self.color(statement).or(entry.ambient),
            b"Kd" => entry.diffuse = self.color(statement).or(entry.diffuse),
            b"Ks" => entry.specular = self.color(statement).or(entry.specular),
            b"Ke" => entry.emission = self.color(statement).or(entry.emission),
            b"Tf" => entry.filter = self.color(statement).or(entry.filter),
            b"Ns" => entry.exponent = self.number(statement).or(entry.exponent),
            b"Ni" => entry.ior = self.number(statement).or(entry.ior),
            b"d" => {
                let mut words = statement.clone();
                let halo = words.next().is_some_and(|w| w.bytes == b"-halo");
                let value = self.number(if halo { words } else { statement });
                entry.opacity = value.or(entry.opacity);
            }
            // Two names for one thing; where both are given, `d` is the standard's.
            b"Tr" if entry.opacity.is_none() => {
                entry.opacity = self.number(statement).map(|t| 1.0 - t);
            }
            b"illum" => entry.illum = self.number(statement).map(|x| x as i64),
            bytes if is_texture(bytes) => {
                entry.texture.get_or_insert(span);
            }
            _ => {}
        }
        self.entry = Some(entry);
    }

    fn number(&mut self, mut statement: Statement<'_>) -> Option<f64> {
        let word = statement.next()?;
        let number = word.number().filter(|x| x.is_finite());
        if number.is_none() {
            let message = format!("`{}` is not a finite number", word.shown());
            self.diagnostics.error(word.span(self.source), message);
        }
        number
    }

    /// One number for grey, or three.
    fn color(&mut self, mut statement: Statement<'_>) -> Option<DVec3> {
        let mut first = statement.clone();
        if let Some(word) = first.next()
            && (word.bytes == b"spectral" || word.bytes == b"xyz")
        {
            let message = format!("`{}` colours are not read", word.shown());
            self.diagnostics.warning(word.span(self.source), message);
            return None;
        }
        let red = self.number(statement.clone())?;
        statement.next();
        let green = self.number(statement.clone()).unwrap_or(red);
        statement.next();
        let blue = self.number(statement).unwrap_or(green);
        Some(DVec3::new(red, green, blue))
    }

    fn finish_entry(&mut self) {
        let Some(entry) = self.entry.take() else {
            return;
        };
        if let Some(span) = entry.texture {
            let message = format!("textures are not read: `{}` is shown without", entry.name);
            self.diagnostics.warning(span, message);
        }
        self.materials.push(entry.material());
    }
}

fn is_texture(keyword: &[u8]) -> bool {
    let names: [&[u8]; 6] = [b"bump", b"disp", b"decal", b"refl", b"norm", b"map_Kd"];
    keyword.starts_with(b"map_") || names.contains(&keyword)
}

impl Entry {
    /// The closest of our materials.
    fn material(self) -> Material {
        let illum = self.illum.unwrap_or(2);
        let diffuse = self.diffuse.unwrap_or(DVec3::splat(0.8));
        let specular = self.specular.unwrap_or(DVec3::ZERO).max(DVec3::ZERO);
        let ior = self.ior.filter(|&n| n > 0.0).unwrap_or(1.0);
        let is_glass = matches!(illum, 4 | 6 | 7 | 9);
        let opacity = self.opacity.unwrap_or(1.0).clamp(0.0, 1.0);
        // Glass that is said to be opaque is meant as glass: its transparency stands in `illum`.
        let clear = if is_glass && opacity == 1.0 {
            1.0
        } else {
            1.0 - opacity
        };
        let (rgb, filter, transmit) = match self.filter {
            Some(tint) if is_glass => (tint.clamp(DVec3::ZERO, DVec3::ONE), clear, 0.0),
            _ => (diffuse, 0.0, clear),
        };
        let mut finish = Finish {
            ambient: self
                .ambient
                .map_or(DVec3::splat(0.1), |ka| ka.max(DVec3::ZERO) * 0.1),
            diffuse: 1.0,
            ..Finish::default()
        };
        let mut pigment = Color {
            rgb,
            filter,
            transmit,
        };
        if illum == 0 {
            finish.ambient = DVec3::ZERO;
            finish.diffuse = 0.0;
            finish.emission = DVec3::ONE;
        }
        if illum >= 2 {
            finish.specular = specular.max_element();
            // The exponent of the cosine to the half vector.
            finish.roughness = 1.0 / self.exponent.unwrap_or(30.0).clamp(1.0, 1e6);
        }
        if illum >= 3 && illum != 8 && illum != 10 {
            finish.reflection = if is_glass || illum == 5 {
                Reflection {
                    max: DVec3::ONE,
                    fresnel: true,
                    ..Reflection::constant(DVec3::ZERO)
                }
            } else {
                Reflection::constant(specular.min(DVec3::ONE))
            };
            finish.conserve_energy = is_glass;
        }
        if let Some(glow) = self.emission.filter(|ke| ke.max_element() > 0.0) {
            if pigment.rgb.cmpgt(DVec3::ZERO).all() {
                finish.emission += glow / pigment.rgb;
            } else {
                // Emission is tinted by the pigment, and black tints to black: the glow comes first.
                pigment.rgb = glow;
                finish.emission = DVec3::ONE;
                finish.diffuse = 0.0;
            }
        }
        Material {
            name: self.name,
            pigment: Pigment::Uniform(pigment),
            finish,
            interior: Interior {
                ior: if is_glass || illum == 5 { ior } else { 1.0 },
                ..Interior::default()
            },
        }
    }
}
