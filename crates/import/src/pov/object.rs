//! Objects as they are written: geometry, its transform, and what hangs on it.

use std::rc::Rc;
use std::sync::Arc;

use octray_geometry::{Sheet, Solid, TriangleMesh};
use octray_math::DAffine3;
use octray_scene::Interior;

use super::light::LightDef;
use super::reader::{Parsed, Reader};
use super::texture::Texture;
use super::value::Value;
use crate::Span;

/// How deep objects may be nested in one another, counted over all declarations.
const MAX_OBJECT_DEPTH: usize = 100;

/// Triangles with the textures that they have of their own.
#[derive(Clone, Debug)]
pub(super) struct MeshDef {
    pub(super) mesh: Arc<TriangleMesh>,
    /// By triangle: which of `textures`; empty where no triangle has its own.
    pub(super) texture_of: Vec<Option<u32>>,
    pub(super) textures: Vec<Rc<Texture>>,
    /// It may be an operand.
    pub(super) has_inside: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Union,
    Merge,
    Intersection,
    Difference,
}

/// What an object is, in its own frame.
#[derive(Clone, Debug)]
pub(super) enum Geometry {
    Solid(Solid),
    /// A surface that closes to a solid when it is an operand: an `open` cylinder.
    Open {
        shell: Sheet,
        solid: Solid,
    },
    Sheet(Sheet),
    /// Several surfaces without an inside.
    Sheets(Vec<Geometry>),
    Mesh(MeshDef),
    Operation(Operation, Vec<Rc<ObjectDef>>),
    Light(LightDef),
}

/// An object. Its texture, clips and companions are in the frame of its parent: they have been
/// moved by the same transforms as the geometry, as far as those came after them.
#[derive(Clone, Debug)]
pub(super) struct ObjectDef {
    pub(super) geometry: Geometry,
    /// Parent from own frame.
    pub(super) transform: DAffine3,
    pub(super) inverse: bool,
    pub(super) texture: Option<Rc<Texture>>,
    pub(super) interior: Option<Interior>,
    pub(super) clips: Vec<Rc<ObjectDef>>,
    /// Objects that come along: what a light looks like.
    pub(super) companions: Vec<Rc<ObjectDef>>,
    pub(super) no_shadow: bool,
    pub(super) name: Option<Rc<str>>,
    pub(super) span: Span,
    depth: usize,
    count: u64,
}

impl ObjectDef {
    pub(super) fn new(geometry: Geometry, span: Span) -> Self {
        Self {
            geometry,
            transform: DAffine3::IDENTITY,
            inverse: false,
            texture: None,
            interior: None,
            clips: Vec::new(),
            companions: Vec::new(),
            no_shadow: false,
            name: None,
            span,
            depth: 1,
            count: 1,
        }
    }

    /// Whether no part of it takes over the texture of what it is in.
    pub(super) fn has_its_look(&self) -> bool {
        let own = self.texture.is_some()
            || match &self.geometry {
                Geometry::Light(_) => true,
                Geometry::Operation(Operation::Union, parts) => {
                    parts.iter().all(|part| part.has_its_look())
                }
                _ => false,
            };
        own && self.companions.iter().all(|part| part.has_its_look())
    }

    /// Moves the object with all that hangs on it.
    pub(super) fn apply(&mut self, map: &DAffine3) {
        self.transform = *map * self.transform;
        self.texture = self.texture.take().map(|texture| texture.transformed(map));
        for other in self.clips.iter_mut().chain(&mut self.companions) {
            Rc::make_mut(other).apply(map);
        }
    }
}

impl Reader<'_> {
    /// An object, whose first word is next. `None` where it is not supported: a warning says so.
    pub(super) fn object(&mut self) -> Parsed<Option<Rc<ObjectDef>>> {
        let token = self.next();
        let Some(word) = token.word().cloned() else {
            return self.fail(token.span, "expected an object");
        };
        if is_unsupported(&word) {
            self.warn(
                token.span,
                format!("`{word}` is not supported: it is left out"),
            );
            self.skip_block()?;
            return Ok(None);
        }
        // The outer `None`: the head has not been read yet.
        let mut made: Option<Option<ObjectDef>> = None;
        let operation = match &*word {
            "union" | "light_group" => Some(Operation::Union),
            "merge" => Some(Operation::Merge),
            "intersection" => Some(Operation::Intersection),
            "difference" => Some(Operation::Difference),
            _ => None,
        };
        if let Some(operation) = operation {
            let geometry = Geometry::Operation(operation, Vec::new());
            made = Some(Some(ObjectDef::new(geometry, token.span)));
        }
        self.block(&word, |r| match &mut made {
            None => {
                made = Some(r.head(&word, token.span)?);
                Ok(())
            }
            Some(Some(object)) => r.object_item(object),
            Some(None) => {
                let mut unused = ObjectDef::new(Geometry::Solid(Solid::empty()), token.span);
                r.object_item(&mut unused)
            }
        })?;
        let Some(made) = made else {
            return self.fail(token.span, format!("this `{word}` is empty"));
        };
        self.book(std::mem::size_of::<ObjectDef>() as u64)?;
        made.map(|object| self.measured(object)).transpose()
    }

    /// Checks how deep and how large the object is.
    fn measured(&mut self, mut object: ObjectDef) -> Parsed<Rc<ObjectDef>> {
        let children: &[Rc<ObjectDef>] = match &object.geometry {
            Geometry::Operation(_, children) => children,
            _ => &[],
        };
        let parts = children
            .iter()
            .chain(&object.clips)
            .chain(&object.companions);
        let (mut depth, mut count) = (0, 1_u64);
        for part in parts {
            depth = depth.max(part.depth);
            count = count.saturating_add(part.count);
        }
        object.depth = depth + 1;
        object.count = count;
        if object.depth > MAX_OBJECT_DEPTH {
            let message = format!("objects are nested more than {MAX_OBJECT_DEPTH} deep");
            return self.halt(object.span, message);
        }
        if count > self.max_bytes / 256 {
            let message = format!("this object has {count} parts, which is more than fits");
            return self.halt(object.span, message);
        }
        Ok(Rc::new(object))
    }

    /// What distinguishes the object, up to its modifiers.
    fn head(&mut self, word: &str, span: Span) -> Parsed<Option<ObjectDef>> {
        match word {
            "object" => Ok(self
                .object_head()?
                .map(|object| ObjectDef { span, ..object })),
            "light_source" => self.light_head(),
            _ => {
                let token = self.peek();
                if let Some(Value::Object(object)) =
                    token.word().and_then(|name| self.scopes.get(name))
                {
                    // `sphere { Declared ... }` means the declared object.
                    let object = (**object).clone();
                    self.next();
                    return Ok(Some(object));
                }
                let geometry = self.geometry(word, span)?;
                Ok(geometry.map(|geometry| ObjectDef::new(geometry, span)))
            }
        }
    }

    fn object_head(&mut self) -> Parsed<Option<ObjectDef>> {
        let token = self.peek();
        if token.word().is_some_and(|word| OBJECTS.contains(&&**word)) {
            return Ok(self.object()?.map(|object| (*object).clone()));
        }
        match self.reference()? {
            Value::Object(object) => Ok(Some((*object).clone())),
            Value::Unknown | Value::Ignored(_) => Ok(None),
            other => {
                let found = token.describe();
                let what = other.describe();
                self.fail(
                    token.span,
                    format!("expected an object, but {found} is {what}"),
                )
            }
        }
    }

    fn object_item(&mut self, object: &mut ObjectDef) -> Parsed<()> {
        let token = self.peek();
        if let Some(map) = self.transform_item()? {
            object.apply(&map);
            return Ok(());
        }
        if self.light_item(object)? {
            return Ok(());
        }
        let Some(word) = token.word().cloned() else {
            return self.unexpected("an object");
        };
        if let Geometry::Operation(_, children) = &mut object.geometry
            && OBJECTS.contains(&&*word)
        {
            // An object that is left out is an empty one: it removes nothing, and an intersection
            // with it, or what is left of it, is nothing.
            let child = self.object()?.unwrap_or_else(|| {
                let nothing = Geometry::Operation(Operation::Union, Vec::new());
                Rc::new(ObjectDef::new(nothing, token.span))
            });
            children.push(child);
            return Ok(());
        }
        match &*word {
            "texture" => {
                if let Value::Texture(texture) = self.texture_value()? {
                    object.texture = Some(match object.texture.take() {
                        Some(below) => below.under(&texture),
                        None => texture,
                    });
                }
            }
            "pigment" | "finish" | "normal" => {
                let base = object.texture.as_ref().unwrap_or(&self.default_texture);
                let mut texture = (**base).clone();
                self.texture_part(&mut texture)?;
                object.texture = Some(Rc::new(texture));
            }
            "interior" => {
                self.next();
                object.interior = Some(self.interior()?);
            }
            "material" => {
                self.next();
                let (texture, interior) = self.material_block()?;
                object.texture = texture.or(object.texture.take());
                object.interior = interior.or(object.interior);
            }
            "clipped_by" => {
                self.next();
                let clips = self.wrapped_objects("clipped_by")?;
                object.clips.extend(clips.into_iter().map(Rc::new));
            }
            "bounded_by" => {
                // A hint for speed that we do not need.
                self.next();
                self.skip_block()?;
            }
            "inverse" => {
                self.next();
                object.inverse = !object.inverse;
            }
            "no_shadow" => {
                self.next();
                object.no_shadow = self.switch_value()?;
            }
            "hollow" | "sturm" | "hierarchy" | "split_union" | "cutaway_textures"
            | "double_illuminate" | "global_lights" => {
                self.next();
                self.switch_value()?;
            }
            "no_image" | "no_reflection" | "no_radiosity" | "uv_mapping" => {
                self.next();
                self.warn(token.span, format!("`{word}` is not supported"));
                self.switch_value()?;
            }
            "interior_texture" | "photons" | "radiosity" => {
                self.next();
                self.warn(token.span, format!("`{word}` is not supported"));
                self.skip_block()?;
            }
            "inside_vector" => {
                self.next();
                self.vector()?;
                if let Geometry::Mesh(mesh) = &mut object.geometry {
                    mesh.has_inside = true;
                }
            }
            _ => return self.unexpected("an object"),
        }
        Ok(())
    }

    /// `{ object ... }`: the objects of a `clipped_by` or `looks_like`.
    pub(super) fn wrapped_objects(&mut self, what: &str) -> Parsed<Vec<ObjectDef>> {
        let mut all: Vec<ObjectDef> = Vec::new();
        self.block(what, |r| {
            if let Some(map) = r.transform_item()? {
                all.iter_mut().for_each(|object| object.apply(&map));
                return Ok(());
            }
            let word = r.peek_word();
            match word.as_deref() {
                Some("bounded_by" | "clipped_by") => {
                    r.next();
                    Ok(())
                }
                Some(word) if OBJECTS.contains(&word) => {
                    all.extend(r.object()?.map(|object| (*object).clone()));
                    Ok(())
                }
                _ => {
                    all.extend(r.object_head()?);
                    Ok(())
                }
            }
        })?;
        Ok(all)
    }
}

/// Words that begin an object.
pub(super) const OBJECTS: [&str; 36] = [
    "object",
    "union",
    "merge",
    "intersection",
    "difference",
    "sphere",
    "box",
    "cylinder",
    "cone",
    "plane",
    "torus",
    "disc",
    "polygon",
    "triangle",
    "smooth_triangle",
    "mesh",
    "mesh2",
    "prism",
    "lathe",
    "quadric",
    "cubic",
    "quartic",
    "poly",
    "polynomial",
    "superellipsoid",
    "light_source",
    "light_group",
    // From here on they are read over.
    "bicubic_patch",
    "blob",
    "height_field",
    "isosurface",
    "julia_fractal",
    "parametric",
    "sor",
    "sphere_sweep",
    "text",
];

/// Whether objects that begin with this word are read over.
fn is_unsupported(word: &str) -> bool {
    let first = OBJECTS.iter().position(|&object| object == "bicubic_patch");
    OBJECTS[first.unwrap_or(OBJECTS.len())..].contains(&word)
}
