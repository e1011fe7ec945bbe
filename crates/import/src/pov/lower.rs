//! From objects as they are written to objects of a scene.

use std::collections::BTreeMap;
use std::rc::Rc;

use octray_geometry::{CornerAttribute, MaterialId, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3};
use octray_scene::{Interior, Object, SceneBuilder};

use super::object::{Geometry, MeshDef, ObjectDef, Operation};
use super::texture::Texture;
use crate::mesh_object::mesh_solid;
use crate::{Diagnostics, Span};

/// What a part takes over from the objects that it is in.
#[derive(Clone)]
pub(super) struct Context {
    /// World from the frame of the part's parent.
    world: DAffine3,
    /// The texture in force, and world from its frame.
    pub(super) texture: Rc<Texture>,
    pub(super) texture_world: DAffine3,
    pub(super) interior: Option<Interior>,
    no_shadow: bool,
    /// In world coordinates.
    clips: Vec<Solid>,
    name: Option<Rc<str>>,
}

/// Triangles of one look, collected from many objects.
#[derive(Default)]
struct Batch {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    normal_of: Vec<[u32; 3]>,
}

pub(super) struct Lowering<'a> {
    diagnostics: &'a mut Diagnostics,
    pub(super) builder: &'a mut SceneBuilder,
    default_texture: Rc<Texture>,
    /// By what a material says, spelled out.
    pub(super) materials: BTreeMap<String, MaterialId>,
    triangles: BTreeMap<(MaterialId, bool), Batch>,
    warned: std::collections::BTreeSet<(u32, usize, String)>,
}

impl<'a> Lowering<'a> {
    pub(super) fn new(
        diagnostics: &'a mut Diagnostics,
        builder: &'a mut SceneBuilder,
        default_texture: Rc<Texture>,
    ) -> Self {
        Self {
            diagnostics,
            builder,
            default_texture,
            materials: BTreeMap::new(),
            triangles: BTreeMap::new(),
            warned: std::collections::BTreeSet::new(),
        }
    }

    pub(super) fn warn(&mut self, span: Span, message: impl Into<String>) {
        let message = message.into();
        if self
            .warned
            .insert((span.source.0, span.start, message.clone()))
        {
            self.diagnostics.warning(span, message);
        }
    }

    /// Adds an object of the top level to the scene.
    pub(super) fn add(&mut self, object: &ObjectDef) {
        let context = Context {
            world: DAffine3::IDENTITY,
            texture: Rc::clone(&self.default_texture),
            texture_world: DAffine3::IDENTITY,
            interior: None,
            no_shadow: false,
            clips: Vec::new(),
            name: None,
        };
        self.emit(object, &context);
    }

    /// The context of what is in `object`.
    fn inner(&mut self, object: &ObjectDef, outer: &Context) -> Context {
        let mut context = outer.clone();
        context.world = outer.world * object.transform;
        if let Some(texture) = &object.texture {
            context.texture = Rc::clone(texture);
            context.texture_world = outer.world;
        }
        context.interior = object.interior.or(outer.interior);
        context.no_shadow |= object.no_shadow;
        context.name = object.name.clone().or_else(|| outer.name.clone());
        for clip in &object.clips {
            if let Some(solid) = self.operand(clip, &outer.world, None) {
                context.clips.push(solid);
            }
        }
        context
    }

    /// Adds the object, part by part where its parts are independent of one another.
    fn emit(&mut self, object: &ObjectDef, outer: &Context) {
        let context = self.inner(object, outer);
        for companion in &object.companions {
            self.emit(companion, outer);
        }
        match &object.geometry {
            Geometry::Light(light) => {
                if let Some(light) = light.light(&context.world) {
                    self.builder.add_light(light);
                } else {
                    self.warn(object.span, "this light points nowhere: it is left out");
                }
            }
            // Every surface of a union's parts is seen, the inner ones too.
            Geometry::Operation(Operation::Union, children) => {
                for child in children {
                    self.emit(child, &context);
                }
            }
            Geometry::Solid(_) | Geometry::Operation(..) => {
                let solid = self.geometry_as_solid(object, &context.world, Some(&context));
                if let Some(solid) = solid {
                    self.push_solid(solid, object, &context);
                }
            }
            Geometry::Open { shell, .. } | Geometry::Sheet(shell) => {
                self.push_sheet(shell, object, &context);
            }
            Geometry::Sheets(parts) => {
                for part in parts {
                    if let Geometry::Open { shell, .. } | Geometry::Sheet(shell) = part {
                        self.push_sheet(shell, object, &context);
                    }
                }
            }
            Geometry::Mesh(mesh) => self.push_mesh(mesh, object, &context),
        }
    }

    fn title(object: &ObjectDef, context: &Context) -> String {
        context.name.as_ref().map_or_else(
            || {
                match &object.geometry {
                    Geometry::Operation(Operation::Difference, _) => "difference",
                    Geometry::Operation(Operation::Intersection, _) => "intersection",
                    Geometry::Operation(..) => "merge",
                    Geometry::Solid(_) => "solid",
                    Geometry::Mesh(_) => "mesh",
                    _ => "surface",
                }
                .to_owned()
            },
            |name| name.to_string(),
        )
    }

    fn push_solid(&mut self, solid: Solid, object: &ObjectDef, context: &Context) {
        let material = self.material(context, object.span);
        let title = Self::title(object, context);
        let mut made = if context.clips.is_empty() {
            Object::solid(title, solid, material)
        } else {
            let clip = Solid::intersection(context.clips.iter().cloned());
            Object::sheet(title, Sheet::Shell { solid, clip }, material)
        };
        made.casts_shadows = !context.no_shadow;
        self.builder.add_object(made);
    }

    fn push_sheet(&mut self, sheet: &Sheet, object: &ObjectDef, context: &Context) {
        let Ok(mut sheet) = sheet.transform(context.world) else {
            self.warn(object.span, "this is too thin to be shown: it is left out");
            return;
        };
        if let (Sheet::Shell { clip, .. }, false) = (&mut sheet, context.clips.is_empty()) {
            let all = context.clips.iter().cloned().chain([clip.clone()]);
            *clip = Solid::intersection(all);
        }
        let material = self.material(context, object.span);
        let mut made = Object::sheet(Self::title(object, context), sheet, material);
        made.casts_shadows = !context.no_shadow;
        self.builder.add_object(made);
    }

    /// Triangles go to one mesh per look, so that a thousand lone triangles are one object.
    fn push_mesh(&mut self, def: &MeshDef, object: &ObjectDef, context: &Context) {
        if !context.clips.is_empty() {
            self.warn(object.span, "`clipped_by` of triangles is not supported");
        }
        if object.inverse {
            self.warn(object.span, "`inverse` of triangles is not supported");
        }
        let general = self.material(context, object.span);
        let own: Vec<MaterialId> = def
            .textures
            .iter()
            .map(|texture| {
                let inner = Context {
                    texture: Rc::clone(texture),
                    texture_world: context.world,
                    ..context.clone()
                };
                self.material(&inner, object.span)
            })
            .collect();
        let turn = context.world.matrix3.inverse().transpose();
        // A mirrored frame turns the corners' order round.
        let mirrored = context.world.matrix3.determinant() < 0.0;
        for (index, corners) in def.mesh.triangles().iter().enumerate() {
            let texture = def.texture_of.get(index).copied().flatten();
            let material = texture
                .and_then(|t| own.get(t as usize).copied())
                .unwrap_or(general);
            let batch = self
                .triangles
                .entry((material, !context.no_shadow))
                .or_default();
            let first = batch.positions.len() as u32;
            let order = if mirrored { [0, 2, 1] } else { [0, 1, 2] };
            for corner in order.map(|i| corners[i]) {
                let p = def.mesh.positions()[corner as usize];
                batch.positions.push(context.world.transform_point3(p));
            }
            batch.triangles.push([first, first + 1, first + 2]);
            let first = batch.normals.len() as u32;
            for i in order {
                let normal = def.mesh.normals().map_or(DVec3::ZERO, |normals| {
                    normals.values[normals.triangles[index][i] as usize]
                });
                batch.normals.push((turn * normal).normalize_or_zero());
            }
            batch.normal_of.push([first, first + 1, first + 2]);
        }
    }

    /// Adds the collected triangles.
    pub(super) fn finish(self) {
        for ((material, casts_shadows), batch) in self.triangles {
            let smooth = batch.normals.iter().any(|n| *n != DVec3::ZERO);
            let mesh = TriangleMesh::new(batch.positions, batch.triangles).and_then(|mesh| {
                if smooth {
                    mesh.with_normals(CornerAttribute {
                        values: batch.normals,
                        triangles: batch.normal_of,
                    })
                } else {
                    Ok(mesh)
                }
            });
            match mesh {
                Ok(mesh) => {
                    let sheet = Sheet::mesh(std::sync::Arc::new(mesh));
                    let mut object = Object::sheet("triangles", sheet, material);
                    object.casts_shadows = casts_shadows;
                    self.builder.add_object(object);
                }
                Err(error) => {
                    let message = format!("triangles are left out: {error}");
                    self.diagnostics.warning(None, message);
                }
            }
        }
    }

    /// An operand in world coordinates; `context` paints it, where its look matters.
    fn operand(
        &mut self,
        object: &ObjectDef,
        world: &DAffine3,
        context: Option<&Context>,
    ) -> Option<Solid> {
        let inner = context.map(|outer| {
            let mut inner = outer.clone();
            inner.world = outer.world * object.transform;
            if let Some(texture) = &object.texture {
                inner.texture = Rc::clone(texture);
                inner.texture_world = outer.world;
            }
            inner.interior = object.interior.or(outer.interior);
            inner
        });
        let frame = *world * object.transform;
        let mut solid = self.geometry_as_solid(object, &frame, inner.as_ref())?;
        if !object.clips.is_empty() {
            self.warn(
                object.span,
                "`clipped_by` of an operand is taken as an intersection",
            );
            let clips: Vec<Solid> = object
                .clips
                .iter()
                .filter_map(|clip| self.operand(clip, world, None))
                .collect();
            solid = Solid::intersection([solid].into_iter().chain(clips));
        }
        if let (Some(inner), true) = (&inner, object.texture.is_some()) {
            let material = self.material(inner, object.span);
            solid = solid.with_material(material);
        }
        Some(if object.inverse {
            solid.complement()
        } else {
            solid
        })
    }

    /// The geometry alone, without the object's own clips, inversion and texture.
    fn geometry_as_solid(
        &mut self,
        object: &ObjectDef,
        frame: &DAffine3,
        context: Option<&Context>,
    ) -> Option<Solid> {
        match &object.geometry {
            Geometry::Solid(solid) => {
                let made = solid.transform(*frame);
                if made.is_err() {
                    self.warn(object.span, "this is too thin to be shown: it is left out");
                }
                made.ok()
            }
            Geometry::Operation(operation, children) => {
                let solids = children
                    .iter()
                    .filter(|child| !matches!(child.geometry, Geometry::Light(_)))
                    .map(|child| self.operand(child, frame, context))
                    // What cannot be an operand counts as empty.
                    .map(|operand| operand.unwrap_or_else(Solid::empty));
                let solids: Vec<Solid> = solids.collect();
                Some(match operation {
                    Operation::Union | Operation::Merge => Solid::union(solids),
                    Operation::Intersection => Solid::intersection(solids),
                    Operation::Difference => Solid::difference(solids),
                })
            }
            Geometry::Open { solid, .. } => {
                self.warn(object.span, "an open surface as operand is taken as closed");
                solid.transform(*frame).ok()
            }
            Geometry::Mesh(def) if def.has_inside => {
                let made = mesh_solid(&def.mesh)
                    .and_then(|(solid, doubt)| Ok((solid.transform(*frame)?, doubt)));
                match made {
                    Ok((solid, doubt)) => {
                        if let Some(doubt) = doubt {
                            self.warn(object.span, doubt);
                        }
                        Some(solid)
                    }
                    Err(error) => {
                        let message = format!("as operand this mesh is left out: {error}");
                        self.warn(object.span, message);
                        None
                    }
                }
            }
            _ => {
                self.warn(
                    object.span,
                    "a surface without an inside cannot be an operand: it is left out",
                );
                None
            }
        }
    }
}
