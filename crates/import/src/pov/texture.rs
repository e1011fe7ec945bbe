//! `texture { ... }` and `material { ... }`.

use std::rc::Rc;

use octray_math::DAffine3;
use octray_scene::{Color, Interior, Pattern, Pigment};

use super::finish::SurfaceFinish;
use super::reader::{Parsed, Reader};
use super::value::Value;

/// One layer: a pigment, in the frame of what it is on, and a finish.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layer {
    pub(super) pigment: Pigment,
    pub(super) finish: SurfaceFinish,
}

/// Layers, the lowest first; at least one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Texture {
    /// The name of its declaration.
    pub(super) name: Option<Rc<str>>,
    pub(super) layers: Vec<Layer>,
}

impl Default for Texture {
    fn default() -> Self {
        Self {
            name: None,
            layers: vec![Layer {
                pigment: Pigment::Uniform(Color::default()),
                finish: SurfaceFinish::default(),
            }],
        }
    }
}

impl Texture {
    /// The lowest layer.
    pub(super) fn first(&self) -> &Layer {
        &self.layers[0]
    }

    /// This texture with another one over it.
    pub(super) fn under(&self, other: &Self) -> Rc<Self> {
        let layers = self.layers.iter().chain(&other.layers);
        Rc::new(Self {
            name: None,
            layers: layers.cloned().collect(),
        })
    }

    /// The same texture after what it is on was moved.
    pub(super) fn transformed(self: &Rc<Self>, map: &DAffine3) -> Rc<Self> {
        let uniform = |layer: &Layer| matches!(layer.pigment, Pigment::Uniform(_));
        if self.layers.iter().all(uniform) {
            return Rc::clone(self);
        }
        let inverse = map.inverse();
        let mut moved = (**self).clone();
        for layer in &mut moved.layers {
            layer.pigment = layer.pigment.transformed(&inverse);
        }
        Rc::new(moved)
    }
}

impl Reader<'_> {
    /// `texture { ... }`, once or more: the layers from below.
    pub(super) fn texture_value(&mut self) -> Parsed<Value> {
        let mut all: Option<Rc<Texture>> = None;
        while self.eat_word("texture") {
            let one = self.texture_block()?;
            match &mut all {
                Some(all) => Rc::make_mut(all).layers.extend_from_slice(&one.layers),
                None => all = Some(one),
            }
        }
        Ok(Value::Texture(all.unwrap_or_default()))
    }

    /// `{ ... }` behind `texture`; a declared one as it is, if only its name stands there.
    pub(super) fn texture_block(&mut self) -> Parsed<Rc<Texture>> {
        let mut made = Rc::clone(&self.default_texture);
        let mut tiles: Vec<Rc<Texture>> = Vec::new();
        self.block("texture", |r| {
            let token = r.peek();
            if let Some(map) = r.transform_item()? {
                let inverse = map.inverse();
                for layer in &mut Rc::make_mut(&mut made).layers {
                    layer.pigment = layer.pigment.transformed(&inverse);
                }
                return Ok(());
            }
            let word = r.peek_word();
            match word.as_deref() {
                Some("pigment" | "finish" | "normal") => r.texture_part(Rc::make_mut(&mut made)),
                Some("checker" | "tiles") => {
                    r.next();
                    r.tiles(&mut tiles)?;
                    made = checkered(&tiles, &made);
                    if tiles.windows(2).any(|t| t[0].first().finish != t[1].first().finish) {
                        r.warn(token.span, "textures of different finish in one pattern are not supported: the first finish is taken");
                    }
                    Ok(())
                }
                Some("uv_mapping") => {
                    r.next();
                    r.switch_value().map(drop)
                }
                Some("texture_map" | "material_map" | "image_map") => {
                    r.next();
                    r.warn(token.span, "texture maps are not supported: the default texture is taken");
                    r.skip_block()
                }
                Some(_) => r.named_texture(&mut made),
                None => r.unexpected("a texture"),
            }
        })?;
        Ok(made)
    }

    fn named_texture(&mut self, made: &mut Rc<Texture>) -> Parsed<()> {
        let token = self.peek();
        if let Some(word) = token.word() {
            let word = Rc::clone(word);
            if self.scopes.get(&word).is_none() && super::KEYWORDS.contains(&&*word) {
                // A pattern that chooses between textures.
                self.warn(
                    token.span,
                    format!("`{word}` in a texture is not supported"),
                );
                self.next();
                let value = self.peek();
                if !matches!(value.kind, super::lexer::Kind::Word(_)) && !value.is("}") {
                    self.terms()?;
                }
                return Ok(());
            }
        }
        match self.reference()? {
            Value::Texture(texture) => *made = texture,
            Value::Unknown => {
                let grey = Pigment::Uniform(Color::rgb(0.5, 0.5, 0.5));
                Rc::make_mut(made).layers[0].pigment = grey;
            }
            Value::Ignored(_) => {}
            other => {
                let message = format!("expected a texture, found {}", other.describe());
                return self.fail(token.span, message);
            }
        }
        Ok(())
    }

    /// `pigment`, `finish` or `normal`, which change the lowest layer.
    pub(super) fn texture_part(&mut self, texture: &mut Texture) -> Parsed<()> {
        let token = self.next();
        let layer = &mut texture.layers[0];
        match token.word().map(|word| &**word) {
            Some("pigment") => layer.pigment = self.pigment(Some(&layer.pigment))?,
            Some("finish") => layer.finish = self.finish(layer.finish)?,
            _ => {
                self.warn(
                    token.span,
                    "`normal` is not supported: the surface stays smooth",
                );
                self.skip_block()?;
            }
        }
        Ok(())
    }

    /// Two textures, as `checker texture{} texture{}` or `tiles { texture{} tile2 texture{} }`.
    fn tiles(&mut self, tiles: &mut Vec<Rc<Texture>>) -> Parsed<()> {
        if self.at("{") {
            return self.block("tiles", |r| {
                if r.eat_word("tile2") {
                    return Ok(());
                }
                r.tile(tiles)
            });
        }
        for _ in 0..2 {
            self.comma();
            self.tile(tiles)?;
        }
        Ok(())
    }

    fn tile(&mut self, tiles: &mut Vec<Rc<Texture>>) -> Parsed<()> {
        if self.eat_word("texture") {
            tiles.push(self.texture_block()?);
        } else {
            let mut named = Rc::default();
            self.named_texture(&mut named)?;
            tiles.push(named);
        }
        Ok(())
    }

    /// `{ texture{} interior{} }` behind `material`.
    pub(super) fn material_block(&mut self) -> Parsed<(Option<Rc<Texture>>, Option<Interior>)> {
        let mut texture: Option<Rc<Texture>> = None;
        let mut interior = None;
        self.block("material", |r| {
            if let Some(map) = r.transform_item()? {
                texture = texture.take().map(|t| t.transformed(&map));
                return Ok(());
            }
            match r.peek_word().as_deref() {
                Some("texture") => {
                    if let Value::Texture(made) = r.texture_value()? {
                        texture = Some(made);
                    }
                }
                Some("interior") => {
                    r.next();
                    interior = Some(r.interior()?);
                }
                Some("interior_texture") => {
                    let token = r.next();
                    r.warn(token.span, "`interior_texture` is not supported");
                    r.skip_block()?;
                }
                _ => match r.reference()? {
                    Value::Texture(made) => texture = Some(made),
                    Value::Material(its_texture, its_interior) => {
                        (texture, interior) = (its_texture, its_interior);
                    }
                    Value::Unknown | Value::Ignored(_) => {}
                    _ => return r.unexpected("a material"),
                },
            }
            Ok(())
        })?;
        Ok((texture, interior))
    }

    /// `#default { ... }`.
    pub(super) fn default_directive(&mut self) -> Parsed<()> {
        let mut made = (*self.default_texture).clone();
        self.block("#default", |r| match r.peek_word().as_deref() {
            Some("texture") => {
                if let Value::Texture(texture) = r.texture_value()? {
                    made = (*texture).clone();
                }
                Ok(())
            }
            Some("pigment" | "finish" | "normal") => r.texture_part(&mut made),
            Some("camera") => {
                r.next();
                r.skip_block()
            }
            _ => r.unexpected("`#default`"),
        })?;
        made.name = None;
        self.default_texture = Rc::new(made);
        Ok(())
    }
}

fn checkered(tiles: &[Rc<Texture>], base: &Rc<Texture>) -> Rc<Texture> {
    let [a, b, ..] = tiles else {
        return Rc::clone(base);
    };
    let mut made = (**a).clone();
    made.name = None;
    made.layers.truncate(1);
    made.layers[0].pigment = Pigment::Pattern {
        pattern: Pattern::Checker(Box::new([
            a.first().pigment.clone(),
            b.first().pigment.clone(),
        ])),
        pattern_from_world: DAffine3::IDENTITY,
    };
    Rc::new(made)
}
