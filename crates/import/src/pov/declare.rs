//! `#declare`, `#local`, `#undef`, and the values that they take.

use std::rc::Rc;

use super::lexer::Kind;
use super::reader::{Parsed, Reader};
use super::value::{Array, Value};
use crate::Span;

/// Arrays of arrays of ... may be this deep.
const MAX_ARRAY_DEPTH: usize = 8;

impl Reader<'_> {
    /// `#declare Name = value [;]`, also of an element of an array.
    pub(super) fn declare(&mut self, local: bool, span: Span) -> Parsed<()> {
        let before = std::mem::replace(&mut self.raw_names, true);
        let name = self.new_name();
        self.raw_names = before;
        let name = name?;
        if super::STATEMENTS.contains(&&*name) {
            return self.fail(self.last, format!("`{name}` is a word of the language"));
        }
        let mut indices = Vec::new();
        while self.eat("[") {
            indices.push(self.expression()?.v[0]);
            self.expect("]")?;
        }
        self.expect("=")?;
        let value = self.held(|r| {
            let value = r.rvalue()?;
            r.eat(";");
            Ok(value)
        })?;
        if indices.is_empty() {
            let value = named(value, &name);
            if local {
                self.scopes.local(name, value);
            } else {
                self.scopes.declare(name, value);
            }
            Ok(())
        } else {
            self.set_element(&name, &indices, value, span)
        }
    }

    pub(super) fn undef(&mut self) -> Parsed<()> {
        let before = std::mem::replace(&mut self.raw_names, true);
        let name = self.new_name();
        self.raw_names = before;
        self.scopes.remove(&name?);
        self.held(|r| {
            r.eat(";");
            Ok(())
        })
    }

    fn set_element(&mut self, name: &str, indices: &[f64], value: Value, span: Span) -> Parsed<()> {
        let depth = match &value {
            Value::Array(inner) => inner.depth,
            _ => 0,
        };
        if depth >= MAX_ARRAY_DEPTH {
            return self.halt(span, format!("arrays are nested {depth} deep"));
        }
        let Some(Value::Array(array)) = self.scopes.get_mut(name) else {
            return self.fail(span, format!("`{name}` is not a declared array"));
        };
        match element_index(array, indices) {
            Ok(index) => {
                let array = Rc::make_mut(array);
                array.depth = array.depth.max(depth + 1);
                array.items[index] = Some(value);
                Ok(())
            }
            Err(message) => self.fail(span, format!("`{name}`{message}")),
        }
    }

    /// The value of a declared name; of an element where it is an array and `[` follows.
    pub(super) fn reference(&mut self) -> Parsed<Value> {
        let token = self.next();
        let Some(name) = token.word().cloned() else {
            let found = token.describe();
            return self.fail(token.span, format!("expected a name, found {found}"));
        };
        let Some(mut value) = self.scopes.get(&name).cloned() else {
            if self.partial_includes && !super::is_reserved(&name) {
                return self.unknown(&name, token.span);
            }
            return self.undeclared(&name, token.span);
        };
        while let Value::Array(array) = &value {
            let array = Rc::clone(array);
            let mut indices = Vec::new();
            while indices.len() < array.sizes.len() && self.eat("[") {
                indices.push(self.expression()?.v[0]);
                self.expect("]")?;
            }
            if indices.is_empty() {
                break;
            }
            value = match element_index(&array, &indices) {
                Ok(index) => match &array.items[index] {
                    Some(value) => value.clone(),
                    None => {
                        let message = format!("this element of `{name}` has no value yet");
                        return self.fail(token.span, message);
                    }
                },
                Err(message) => return self.fail(token.span, format!("`{name}`{message}")),
            };
        }
        Ok(value)
    }

    /// A name that an include we do not know in full may have declared.
    fn unknown(&mut self, name: &str, span: Span) -> Parsed<Value> {
        self.warn(
            span,
            format!("`{name}` is not known; it is taken to come from a standard include that octray has not in full, and is left out"),
        );
        if self.eat("(") {
            let mut depth = 1_usize;
            while depth > 0 {
                let token = self.next();
                match token.kind {
                    Kind::Sign("(") => depth += 1,
                    Kind::Sign(")") => depth -= 1,
                    Kind::End => return self.fail(span, "the arguments are not closed by `)`"),
                    _ => {}
                }
            }
        }
        Ok(Value::Unknown)
    }

    /// Anything that can be declared.
    pub(super) fn rvalue(&mut self) -> Parsed<Value> {
        let token = self.peek();
        let Some(word) = token.word().cloned() else {
            return match token.kind {
                Kind::Text(_) => Ok(Value::Text(self.text()?)),
                _ => Ok(Value::Terms(self.expression()?)),
            };
        };
        if super::object::OBJECTS.contains(&&*word) {
            return Ok(match self.object()? {
                Some(object) => Value::Object(object),
                None => Value::Unknown,
            });
        }
        if super::functions::is_text_function(&word) {
            return Ok(Value::Text(self.text()?));
        }
        match &*word {
            "texture" => self.texture_value(),
            "pigment" => {
                self.next();
                Ok(Value::Pigment(Rc::new(self.pigment(None)?)))
            }
            "finish" => {
                self.next();
                let base = Rc::clone(&self.default_texture);
                Ok(Value::Finish(self.finish(base.first().finish)?))
            }
            "interior" => {
                self.next();
                Ok(Value::Interior(self.interior()?))
            }
            "material" => {
                self.next();
                let (texture, interior) = self.material_block()?;
                Ok(Value::Material(texture, interior))
            }
            "color_map" | "colour_map" => {
                self.next();
                Ok(Value::ColorMap(Rc::new(self.color_map()?)))
            }
            "transform" => {
                self.next();
                Ok(Value::Transform(self.transform_block()?))
            }
            "camera" => {
                self.next();
                Ok(Value::Camera(Box::new(self.camera_block()?)))
            }
            "sky_sphere" => {
                self.next();
                Ok(Value::Sky(Rc::new(self.sky_block()?)))
            }
            "array" => self.array(),
            "function" => {
                self.next();
                self.function()
            }
            other => {
                if let Some(what) = super::ignored(other) {
                    self.next();
                    self.skip_block()?;
                    return Ok(Value::Ignored(what));
                }
                self.named_rvalue(&word)
            }
        }
    }

    fn named_rvalue(&mut self, word: &str) -> Parsed<Value> {
        match self.scopes.get(word) {
            None if self.partial_includes && !super::is_reserved(word) => self.reference(),
            None | Some(Value::Terms(_) | Value::Function(_)) => {
                Ok(Value::Terms(self.expression()?))
            }
            Some(Value::Array(_)) => {
                let value = self.reference()?;
                match value {
                    Value::Terms(terms) => Ok(Value::Terms(self.continue_expression(terms)?)),
                    other => Ok(other),
                }
            }
            Some(_) => self.reference(),
        }
    }

    /// `array[n][m] { ... }`.
    fn array(&mut self) -> Parsed<Value> {
        let token = self.next();
        let mut sizes = Vec::new();
        let mut count = 1_usize;
        while self.eat("[") {
            let size = self.expression()?.v[0];
            self.expect("]")?;
            if !(size >= 1.0 && size <= f64::from(u32::MAX)) {
                return self.fail(token.span, format!("an array cannot have {size} elements"));
            }
            sizes.push(size as usize);
            count = count.saturating_mul(size as usize);
        }
        let fill = self.at("{");
        if sizes.is_empty() && !fill {
            return self.fail(token.span, "an array needs a size: `array[n]`");
        }
        self.book((count as u64).saturating_mul(std::mem::size_of::<Value>() as u64))?;
        let mut items = Vec::new();
        let mut depth = 1;
        if fill {
            self.array_items(&mut items, &mut depth)?;
        }
        if sizes.is_empty() {
            sizes.push(items.len());
            count = items.len();
        }
        if items.len() > count {
            let given = items.len();
            return self.fail(
                token.span,
                format!("the array has {count} elements, but {given} values are given"),
            );
        }
        items.resize(count, None);
        Ok(Value::Array(Rc::new(Array {
            sizes,
            items,
            depth,
        })))
    }

    /// Nested braces are the rows; the values come out in row-major order.
    fn array_items(&mut self, items: &mut Vec<Option<Value>>, depth: &mut usize) -> Parsed<()> {
        self.block("array", |r| {
            if r.at("{") {
                return r.array_items(items, depth);
            }
            let value = r.rvalue()?;
            if let Value::Array(inner) = &value {
                *depth = (*depth).max(inner.depth + 1);
                if *depth > MAX_ARRAY_DEPTH {
                    return r.halt(r.last, format!("arrays are nested {depth} deep"));
                }
            }
            r.book(std::mem::size_of::<Value>() as u64)?;
            items.push(Some(value));
            Ok(())
        })
    }
}

/// The place of an element, or the end of a message that begins with the array's name.
fn element_index(array: &Array, indices: &[f64]) -> Result<usize, String> {
    if indices.len() != array.sizes.len() {
        let (has, given) = (array.sizes.len(), indices.len());
        return Err(format!(" has {has} dimensions, but {given} are given"));
    }
    let mut place = 0;
    for (&index, &size) in indices.iter().zip(&array.sizes) {
        let rounded = index + 1e-8;
        if !(rounded >= 0.0 && rounded < size as f64) {
            return Err(format!(
                " has elements 0 to {}, not {index}",
                size.saturating_sub(1)
            ));
        }
        place = place * size + rounded as usize;
    }
    Ok(place)
}

/// Objects and textures keep the name of their first declaration, for listings.
fn named(value: Value, name: &Rc<str>) -> Value {
    match value {
        Value::Object(object) if object.name.is_none() => {
            let mut object = object;
            Rc::make_mut(&mut object).name = Some(Rc::clone(name));
            Value::Object(object)
        }
        Value::Texture(texture) if texture.name.is_none() => {
            let mut texture = texture;
            Rc::make_mut(&mut texture).name = Some(Rc::clone(name));
            Value::Texture(texture)
        }
        other => other,
    }
}
