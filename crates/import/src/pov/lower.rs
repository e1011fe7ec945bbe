//! From objects as they are written to objects of a scene.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use octray_geometry::{MaterialId, Sheet, Solid};
use octray_math::DAffine3;
use octray_scene::{Interior, Object, SceneBuilder};

use super::materials::RecentMaterial;
use super::object::{Geometry, MeshDef, ObjectDef, Operation};
use super::texture::Texture;
use super::triangles::Triangles;
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

/// Makes the scene out of objects.
#[derive(Default)]
pub(super) struct Lowering {
    pub(super) diagnostics: Diagnostics,
    pub(super) builder: SceneBuilder,
    pub(super) default_texture: Rc<Texture>,
    /// By what a material says, spelled out.
    pub(super) materials: BTreeMap<String, MaterialId>,
    /// Those found last.
    pub(super) recent: Vec<RecentMaterial>,
    triangles: Triangles,
    /// Names of objects that have none of their own.
    titles: BTreeMap<&'static str, Arc<str>>,
    warned: std::collections::BTreeSet<(u32, usize, String)>,
}

impl Lowering {
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

    fn title(&mut self, object: &ObjectDef, context: &Context) -> Arc<str> {
        if let Some(name) = &context.name {
            return Arc::from(&**name);
        }
        let title = match &object.geometry {
            Geometry::Operation(Operation::Difference, _) => "difference",
            Geometry::Operation(Operation::Intersection, _) => "intersection",
            Geometry::Operation(..) => "merge",
            Geometry::Solid(_) => "solid",
            Geometry::Mesh(_) => "mesh",
            _ => "surface",
        };
        Arc::clone(self.titles.entry(title).or_insert_with(|| title.into()))
    }

    fn push_solid(&mut self, solid: Solid, object: &ObjectDef, context: &Context) {
        let material = self.material(context, object.span);
        let title = self.title(object, context);
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
        let mut made = Object::sheet(self.title(object, context), sheet, material);
        made.casts_shadows = !context.no_shadow;
        self.builder.add_object(made);
    }

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
        let casts_shadows = !context.no_shadow;
        self.triangles
            .add(def, &context.world, general, &own, casts_shadows);
    }

    /// Adds the collected triangles.
    pub(super) fn finish(&mut self) {
        for ((material, casts_shadows), mesh) in std::mem::take(&mut self.triangles).into_meshes() {
            match mesh {
                Ok(mesh) => {
                    let sheet = Sheet::mesh(Arc::new(mesh));
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
            // As it is: moving it nowhere would make another node.
            Geometry::Solid(solid) if *frame == DAffine3::IDENTITY => Some(solid.clone()),
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
