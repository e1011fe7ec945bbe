//! `triangle`, `smooth_triangle`, `mesh` and `mesh2`.

use std::rc::Rc;
use std::sync::Arc;

use octray_geometry::{CornerAttribute, TriangleMesh};
use octray_math::DVec3;

use super::object::{Geometry, MeshDef};
use super::reader::{Parsed, Reader};
use super::texture::Texture;
use super::value::Value;
use crate::Span;

/// Triangles being collected. Normal 0 is the zero vector: "use the face's".
struct Collected {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    normal_of: Vec<[u32; 3]>,
    texture_of: Vec<Option<u32>>,
    textures: Vec<Rc<Texture>>,
    has_inside: bool,
}

impl Default for Collected {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            triangles: Vec::new(),
            normals: vec![DVec3::ZERO],
            normal_of: Vec::new(),
            texture_of: Vec::new(),
            textures: Vec::new(),
            has_inside: false,
        }
    }
}

impl Collected {
    fn texture(&mut self, texture: Rc<Texture>) -> u32 {
        let known = self.textures.iter().position(|t| Rc::ptr_eq(t, &texture));
        let index = known.unwrap_or_else(|| {
            self.textures.push(texture);
            self.textures.len() - 1
        });
        index as u32
    }

    /// Most meshes have no textures of their own, and keep no list of them.
    fn texture_triangle(&mut self, triangle: usize, texture: Option<u32>) {
        if texture.is_some() {
            self.texture_of.resize(triangle, None);
            self.texture_of.push(texture);
        }
    }
}

impl Reader<'_> {
    /// The corners of one triangle.
    fn corners(&mut self, smooth: bool, into: &mut Collected) -> Parsed<()> {
        self.book(200)?;
        let mut normals = [0_u32; 3];
        let first = into.positions.len() as u32;
        for normal in &mut normals {
            let corner = self.vector()?;
            into.positions.push(corner);
            self.comma();
            if smooth {
                *normal = into.normals.len() as u32;
                let direction = self.vector()?;
                into.normals.push(direction);
                self.comma();
            }
        }
        into.triangles.push([first, first + 1, first + 2]);
        into.normal_of.push(normals);
        Ok(())
    }

    /// What stands in the braces of a lone triangle, up to its modifiers.
    pub(super) fn triangle(&mut self, smooth: bool) -> Parsed<Option<Geometry>> {
        let mut all = Collected::default();
        self.corners(smooth, &mut all)?;
        self.made_mesh(all, self.last)
    }

    /// `triangle{} smooth_triangle{} ...`, up to the modifiers of the mesh.
    pub(super) fn mesh(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let mut all = Collected::default();
        loop {
            self.comma();
            let smooth = match self.peek_word().as_deref() {
                Some("triangle") => false,
                Some("smooth_triangle") => true,
                _ => break,
            };
            self.next();
            let mut begun = false;
            self.block("triangle", |r| {
                if !begun {
                    begun = true;
                    return r.corners(smooth, &mut all);
                }
                if r.eat_word("texture") {
                    r.mesh_texture(&mut all)
                } else if r.eat_word("uv_vectors") {
                    for _ in 0..3 {
                        r.terms()?;
                        r.comma();
                    }
                    Ok(())
                } else {
                    r.unexpected("a triangle")
                }
            })?;
        }
        if all.triangles.is_empty() {
            return self.unexpected("a mesh, which begins with a triangle");
        }
        self.made_mesh(all, span)
    }

    fn mesh_texture(&mut self, all: &mut Collected) -> Parsed<()> {
        let texture = self.texture_block()?;
        // A declared texture that is used many times is kept once.
        let known = all.textures.iter().find(|t| **t == texture).cloned();
        let index = all.texture(known.unwrap_or(texture));
        let triangle = all.triangles.len().saturating_sub(1);
        all.texture_triangle(triangle, Some(index));
        Ok(())
    }

    fn made_mesh(&mut self, all: Collected, span: Span) -> Parsed<Option<Geometry>> {
        let smooth = all.normals.len() > 1;
        let made = TriangleMesh::new(all.positions, all.triangles).and_then(|mesh| {
            if smooth {
                mesh.with_normals(CornerAttribute {
                    values: all.normals,
                    triangles: all.normal_of,
                })
            } else {
                Ok(mesh)
            }
        });
        match made {
            Ok(mesh) => Ok(Some(Geometry::Mesh(MeshDef {
                mesh: Arc::new(mesh),
                texture_of: all.texture_of,
                textures: all.textures,
                has_inside: all.has_inside,
            }))),
            Err(error) => self.fail(
                span.to(self.last),
                format!("this mesh is not usable: {error}"),
            ),
        }
    }

    /// `vertex_vectors{} normal_vectors{} texture_list{} face_indices{} normal_indices{} ...`.
    pub(super) fn mesh2(&mut self, span: Span) -> Parsed<Option<Geometry>> {
        let mut all = Collected::default();
        let mut normals: Vec<DVec3> = Vec::new();
        let mut normal_indices: Option<Vec<[u32; 3]>> = None;
        loop {
            self.comma();
            let word = self.peek_word();
            match word.as_deref() {
                Some("vertex_vectors") => all.positions = self.vectors()?,
                Some("normal_vectors") => normals = self.vectors()?,
                Some("uv_vectors") => drop(self.vectors()?),
                Some("texture_list") => self.texture_list(&mut all)?,
                Some("face_indices") => self.face_indices(&mut all)?,
                Some("normal_indices") => {
                    let mut indices = Collected::default();
                    self.face_indices(&mut indices)?;
                    normal_indices = Some(indices.triangles);
                }
                Some("uv_indices") => {
                    let mut ignored = Collected::default();
                    self.face_indices(&mut ignored)?;
                }
                _ => break,
            }
        }
        if all.positions.is_empty() || all.triangles.is_empty() {
            return self.fail(span, "a `mesh2` needs vertex_vectors and face_indices");
        }
        all.normal_of = match normal_indices {
            Some(indices) => indices,
            None if normals.is_empty() => Vec::new(),
            // Without indices of their own normals go with the vertices.
            None => all.triangles.clone(),
        };
        if normals.is_empty() {
            all.normal_of.clear();
        } else {
            all.normals = normals;
            // A single normal would be taken for none.
            all.normals.push(DVec3::ZERO);
        }
        self.made_mesh(all, span)
    }

    /// `{ count, item, ... }` behind a word.
    fn counted(&mut self, what: &str, mut item: impl FnMut(&mut Self) -> Parsed<()>) -> Parsed<()> {
        let head = self.next();
        let mut count: Option<f64> = None;
        let mut read = 0.0;
        self.block(what, |r| {
            if count.is_none() {
                count = Some(r.float()?);
                return Ok(());
            }
            read += 1.0;
            r.book(48)?;
            item(r)
        })?;
        let count = count.unwrap_or(0.0);
        if read != count {
            let message = format!("{what} says it has {count} items, but has {read}");
            return self.fail(head.span, message);
        }
        Ok(())
    }

    fn vectors(&mut self) -> Parsed<Vec<DVec3>> {
        let mut all = Vec::new();
        self.counted("this list of vectors", |r| {
            all.push(r.vector()?);
            Ok(())
        })?;
        Ok(all)
    }

    /// `<a, b, c> [, texture [, texture, texture]]`.
    fn face_indices(&mut self, all: &mut Collected) -> Parsed<()> {
        self.counted("this list of faces", |r| {
            if !r.at("<") && !all.triangles.is_empty() && r.at_number() {
                // Textures behind the face before; of one for each corner the first is taken.
                return r.unexpected("a list of faces");
            }
            let corners = r.vector()?;
            let index = |x: f64| (x >= 0.0 && x < f64::from(u32::MAX)).then_some(x as u32);
            let [Some(a), Some(b), Some(c)] = corners.to_array().map(index) else {
                return r.fail(r.last, "an index is not a whole number from 0 on");
            };
            all.triangles.push([a, b, c]);
            let mut texture = None;
            loop {
                r.comma();
                if !r.at_number() {
                    break;
                }
                let which = r.float()?;
                texture.get_or_insert(which as u32);
            }
            if texture.is_some_and(|t| t as usize >= all.textures.len()) {
                return r.fail(r.last, "the texture list has no texture of this number");
            }
            let triangle = all.triangles.len() - 1;
            all.texture_triangle(triangle, texture);
            Ok(())
        })
    }

    fn at_number(&mut self) -> bool {
        matches!(self.look().kind, super::lexer::Kind::Number(_))
    }

    fn texture_list(&mut self, all: &mut Collected) -> Parsed<()> {
        let mut textures = Vec::new();
        self.counted("this list of textures", |r| {
            if r.peek_word().as_deref() == Some("texture") {
                r.next();
                let made = r.texture_block()?;
                textures.push(made);
            } else if let Value::Texture(texture) = r.reference()? {
                textures.push(texture);
            } else {
                textures.push(Rc::clone(&r.default_texture));
            }
            Ok(())
        })?;
        all.textures = textures;
        Ok(())
    }
}
