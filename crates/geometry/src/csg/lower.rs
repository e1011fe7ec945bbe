//! From a user's tree of solids to an expression over faces.

use std::sync::Arc;

use octray_math::DAffine3;

use super::code::{Code, Constant, Operation, Writer};
use super::facets;
use super::operand::Operand;
use crate::mesh::FacetPlanes;
use crate::profile::Formula;
use crate::surface::{NearPair, Surface, SurfaceTable};
use crate::{
    Composite, FaceId, MaterialId, Primitive, SceneFrame, Solid, SolidNode, SurfaceId, TriangleMesh,
};

/// One face of one operand: the literal of the expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// The surface it lies on.
    pub surface: SurfaceId,
    /// Whether the expression wants the surface's positive side (complements do, and planes whose
    /// canonical normal points inwards).
    pub inside_is_positive: bool,
    /// Its own material, where it has one.
    pub material: Option<MaterialId>,
}

/// A closed mesh that is an operand: its surface id comes after those of the table.
#[derive(Clone, Debug)]
pub struct MeshOperand {
    /// The mesh in its own frame.
    pub mesh: Arc<TriangleMesh>,
    /// Where it is.
    pub scene_from_mesh: DAffine3,
    /// The planes that its triangles share with other operands.
    pub planes: FacetPlanes,
}

/// An expression, or what it always is.
pub type Lowered = Result<Code, Constant>;

/// Lowers the solids of one world, numbering faces and surfaces in the order it meets them.
#[derive(Debug)]
pub struct Lowering {
    scene_from_world: DAffine3,
    scene_size: f64,
    pub(super) table: SurfaceTable,
    faces: Vec<Face>,
    pub(super) meshes: Vec<MeshOperand>,
    operands: Option<Vec<Operand>>,
}

/// What the solids of a world became.
#[derive(Debug)]
pub struct LoweredScene {
    /// By their ids.
    pub faces: Vec<Face>,
    /// By their ids.
    pub surfaces: Vec<Surface>,
    /// The surface of mesh operand `i` is `surfaces.len() + i`.
    pub meshes: Vec<MeshOperand>,
    /// In the order of their faces; empty unless they were asked for
    /// ([`Lowering::with_operands`]).
    pub operands: Vec<Operand>,
}

/// Surfaces of meshes are numbered downwards from here until the table's size is known.
pub(super) const FIRST_MESH: u32 = u32::MAX;

/// Where one is in the tree.
#[derive(Clone, Copy)]
struct Context {
    scene_from_here: DAffine3,
    complemented: bool,
    material: Option<MaterialId>,
}

/// The sides of a composite, and the faces that stand for their insides and outsides so far.
struct Named {
    sides: Vec<(SurfaceId, bool)>,
    faces: Vec<[Option<FaceId>; 2]>,
}

impl Lowering {
    /// For a scene that is worked on in these coordinates: faces, surfaces and meshes come out in
    /// them.
    #[must_use]
    pub fn new(frame: &SceneFrame) -> Self {
        Self {
            scene_from_world: frame.scene_from_world(),
            scene_size: frame.size,
            table: SurfaceTable::new(frame.size, frame.largest()),
            faces: Vec::new(),
            meshes: Vec::new(),
            operands: None,
        }
    }

    /// Keeps a list of the operands too.
    #[must_use]
    pub fn with_operands(mut self) -> Self {
        self.operands = Some(Vec::new());
        self
    }

    /// The expression of a solid given in world coordinates.
    ///
    /// The solid's size must have been checked ([`Solid::check_size`]): this recurses.
    pub fn lower(&mut self, solid: &Solid) -> Lowered {
        let mut writer = Writer::default();
        match self.lower_to(solid, &mut writer) {
            Some(constant) => Err(constant),
            None => Ok(writer.finish()),
        }
    }

    /// Like [`Lowering::lower`], with the words of the expression appended to others; of a constant,
    /// none.
    pub fn lower_into(&mut self, solid: &Solid, words: &mut Vec<u32>) -> Option<Constant> {
        let mut writer = Writer::behind(std::mem::take(words));
        let constant = self.lower_to(solid, &mut writer);
        *words = writer.into_words();
        constant
    }

    fn lower_to(&mut self, solid: &Solid, writer: &mut Writer) -> Option<Constant> {
        let context = Context {
            scene_from_here: self.scene_from_world,
            complemented: false,
            material: None,
        };
        self.visit(solid, &context, writer)
    }

    /// All of it.
    #[must_use]
    pub fn finish(self) -> LoweredScene {
        let tolerance = self.table.tolerance() * self.scene_size;
        let surfaces = self.table.into_surfaces();
        let mut faces = self.faces;
        faces.shrink_to_fit();
        for face in &mut faces {
            let from_last = FIRST_MESH - face.surface.0;
            if (from_last as usize) < self.meshes.len() {
                face.surface = SurfaceId(surfaces.len() as u32 + from_last);
            }
        }
        let mut meshes = self.meshes;
        facets::share_planes(&surfaces, &mut meshes, self.scene_size, tolerance);
        LoweredScene {
            faces,
            surfaces,
            meshes,
            operands: self.operands.unwrap_or_default(),
        }
    }

    /// How many faces there are so far.
    #[must_use]
    pub const fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// How many faces share a surface that another face brought.
    #[must_use]
    pub const fn merged_surfaces(&self) -> usize {
        self.table.merged()
    }

    /// How far surfaces may be apart to be one, in units of the scene's size.
    #[must_use]
    pub const fn tolerance(&self) -> f64 {
        self.table.tolerance()
    }

    /// The surfaces so far that nearly coincide with an earlier one.
    #[must_use]
    pub fn near_pairs(&self) -> Vec<NearPair> {
        self.table.near_pairs()
    }

    fn visit(&mut self, solid: &Solid, context: &Context, writer: &mut Writer) -> Option<Constant> {
        let of = |b: bool| Some(if b { Constant::True } else { Constant::False });
        match solid.node() {
            SolidNode::Empty => of(context.complemented),
            SolidNode::Primitive(Primitive::Composite(composite)) => {
                self.composite(composite, context, writer)
            }
            SolidNode::Primitive(primitive) => {
                self.primitive(primitive, context, writer);
                None
            }
            SolidNode::Transformed {
                child,
                parent_from_child,
            } => {
                let scene_from_here = context.scene_from_here * *parent_from_child;
                self.visit(
                    child,
                    &Context {
                        scene_from_here,
                        ..*context
                    },
                    writer,
                )
            }
            SolidNode::WithMaterial { child, material } => {
                let material = Some(*material);
                self.visit(
                    child,
                    &Context {
                        material,
                        ..*context
                    },
                    writer,
                )
            }
            SolidNode::Complement(child) => {
                let complemented = !context.complemented;
                self.visit(
                    child,
                    &Context {
                        complemented,
                        ..*context
                    },
                    writer,
                )
            }
            SolidNode::Union(all) => self.operation(all, 0, Operation::Or, context, writer),
            SolidNode::Intersection(all) => self.operation(all, 0, Operation::And, context, writer),
            SolidNode::Difference(all) => self.operation(all, 1, Operation::And, context, writer),
        }
    }

    /// `operation` over `solids`, those from `complement_from` on complemented (0: none are).
    fn operation(
        &mut self,
        solids: &[Solid],
        complement_from: usize,
        operation: Operation,
        context: &Context,
        writer: &mut Writer,
    ) -> Option<Constant> {
        let operation = match (operation, context.complemented) {
            (Operation::And, true) => Operation::Or,
            (Operation::Or, true) => Operation::And,
            (operation, false) => operation,
        };
        let mut open = writer.open(operation);
        for (index, solid) in solids.iter().enumerate() {
            let turned = complement_from > 0 && index >= complement_from;
            let complemented = context.complemented ^ turned;
            let start = writer.position();
            let constant = self.visit(
                solid,
                &Context {
                    complemented,
                    ..*context
                },
                writer,
            );
            if writer.operand(&mut open, start, constant) {
                return Some(match operation {
                    Operation::And => Constant::False,
                    Operation::Or => Constant::True,
                });
            }
        }
        writer.close(&open)
    }

    fn composite(
        &mut self,
        composite: &Arc<Composite>,
        context: &Context,
        writer: &mut Writer,
    ) -> Option<Constant> {
        let primitive = Primitive::Composite(Arc::clone(composite));
        let sides = self.sides(&primitive, &context.scene_from_here);
        let mut named = Named {
            sides,
            faces: vec![[None; 2]; composite.faces().len()],
        };
        let (first, start) = (self.face_count(), writer.position());
        let constant = self.formula(composite.formula(), &mut named, context, writer);
        let expression = || constant.map_or_else(|| Ok(writer.since(start)), Err);
        self.note_operand(&primitive, first, context, expression);
        constant
    }

    /// Lists an operand whose faces are those from `first` on.
    fn note_operand(
        &mut self,
        primitive: &Primitive,
        first: usize,
        context: &Context,
        expression: impl FnOnce() -> Lowered,
    ) {
        let faces = first as u32..self.face_count() as u32;
        if let Some(operands) = &mut self.operands {
            operands.push(Operand {
                primitive: primitive.clone(),
                scene_from_local: context.scene_from_here,
                faces,
                complemented: context.complemented,
                expression: expression(),
            });
        }
    }

    fn formula(
        &mut self,
        formula: &Formula,
        named: &mut Named,
        context: &Context,
        writer: &mut Writer,
    ) -> Option<Constant> {
        let (operation, parts) = match formula {
            Formula::Constant(value) if *value != context.complemented => {
                return Some(Constant::True);
            }
            Formula::Constant(_) => return Some(Constant::False),
            Formula::Side { side, inside } => {
                let turned = context.complemented == *inside;
                let (surface, inside_is_positive) = named.sides[*side as usize];
                let next = FaceId(self.faces.len() as u32);
                let face = *named.faces[*side as usize][usize::from(turned)].get_or_insert(next);
                if face == next {
                    self.faces.push(Face {
                        surface,
                        inside_is_positive: inside_is_positive ^ turned,
                        material: context.material,
                    });
                }
                writer.literal(face);
                return None;
            }
            Formula::All(parts) if context.complemented => (Operation::Or, parts),
            Formula::Any(parts) if context.complemented => (Operation::And, parts),
            Formula::All(parts) => (Operation::And, parts),
            Formula::Any(parts) => (Operation::Or, parts),
        };
        let mut open = writer.open(operation);
        for part in parts {
            let start = writer.position();
            let constant = self.formula(part, named, context, writer);
            if writer.operand(&mut open, start, constant) {
                return Some(match operation {
                    Operation::And => Constant::False,
                    Operation::Or => Constant::True,
                });
            }
        }
        writer.close(&open)
    }

    fn primitive(&mut self, primitive: &Primitive, context: &Context, writer: &mut Writer) {
        let sides = self.sides(primitive, &context.scene_from_here);
        let operation = if context.complemented {
            Operation::Or
        } else {
            Operation::And
        };
        let first = self.face_count();
        let position = writer.position();
        let mut open = writer.open(operation);
        for (surface, inside_is_positive) in sides {
            let face = FaceId(self.faces.len() as u32);
            self.faces.push(Face {
                surface,
                inside_is_positive: inside_is_positive ^ context.complemented,
                material: context.material,
            });
            let start = writer.position();
            writer.literal(face);
            writer.operand(&mut open, start, None);
        }
        writer.close(&open);
        self.note_operand(primitive, first, context, || Ok(writer.since(position)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csg::{evaluate, faces};
    use crate::surface::implicit_value;
    use octray_math::DVec3;

    fn contains(solid: &Solid, p: DVec3) -> bool {
        let mut lowering = Lowering::new(&SceneFrame::around_origin(10.0));
        let lowered = lowering.lower(solid);
        let LoweredScene {
            faces, surfaces, ..
        } = lowering.finish();
        match lowered {
            Err(constant) => constant == Constant::True,
            Ok(code) => evaluate(code.words(), &|id: FaceId| {
                let face = faces[id.0 as usize];
                (implicit_value(&surfaces[face.surface.0 as usize], p) > 0.0)
                    == face.inside_is_positive
            }),
        }
    }

    #[test]
    fn primitives_contain_what_their_definitions_say() {
        let at = DVec3::new;
        let cone = Solid::cone(2.0, 1.0, 0.0, 2.0).expect("valid");
        assert!(contains(&cone, at(1.4, 0.0, 1.0)) && !contains(&cone, at(1.6, 0.0, 1.0)));
        assert!(!contains(&cone, at(0.0, 0.0, 2.1)) && !contains(&cone, at(0.0, 0.0, 5.0)));
        let tip = Solid::cone(0.0, 1.0, 0.0, 1.0).expect("valid");
        assert!(contains(&tip, at(0.0, 0.4, 0.5)) && !contains(&tip, at(0.0, 0.6, 0.5)));
        let torus = Solid::torus(3.0, 1.0).expect("valid");
        assert!(contains(&torus, at(0.0, 3.5, 0.5)) && !contains(&torus, at(0.0, 1.0, 0.0)));
        let half = Solid::half_space(at(-1.0, -1.0, 0.0), 1.0).expect("valid");
        assert!(contains(&half, at(0.0, -1.4, 0.0)) && !contains(&half, at(-1.0, -1.4, 0.0)));
    }

    #[test]
    fn mirrored_and_sheared_frames_keep_the_inside_inside() {
        let cuboid = Solid::cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)).expect("valid");
        let shear = DAffine3::from_cols(
            DVec3::new(-1.0, 0.0, 0.0),
            DVec3::new(0.5, 1.0, 0.0),
            DVec3::new(0.0, 0.3, 1.0),
            DVec3::new(4.0, 0.0, 0.0),
        );
        let moved = cuboid.transform(shear).expect("invertible");
        for i in 0..4_i32 {
            for j in 0..4_i32 {
                let local = DVec3::new(f64::from(i) * 0.4 - 0.3, f64::from(j) * 0.7 - 0.2, 1.0);
                let world = shear.transform_point3(local);
                assert_eq!(contains(&cuboid, local), contains(&moved, world), "{local}");
            }
        }
    }

    #[test]
    fn a_cutter_that_ends_in_the_face_it_cuts_shares_its_plane() {
        let plate = Solid::cuboid(DVec3::ZERO, DVec3::splat(10.0)).expect("valid");
        let drill = Solid::cylinder(2.0, 0.0, 10.0).expect("valid");
        let mut lowering = Lowering::new(&SceneFrame::around_origin(10.0));
        let code = lowering
            .lower(&Solid::difference([plate, drill]))
            .expect("not constant");
        assert_eq!(faces(code.words()).count(), 9);
        assert_eq!(lowering.merged_surfaces(), 2);
        let surfaces = lowering.finish().surfaces;
        assert_eq!(surfaces.len(), 7);
    }

    #[test]
    fn the_empty_solid_disappears_from_every_operation() {
        let ball = Solid::sphere(1.0).expect("valid");
        let mut lowering = Lowering::new(&SceneFrame::around_origin(1.0));
        let with_empty = Solid::union([ball.clone(), Solid::empty()]);
        assert_eq!(lowering.lower(&with_empty).expect("a ball").literals(), 1);
        let nothing = Solid::intersection([ball.clone(), Solid::empty()]);
        assert_eq!(lowering.lower(&nothing), Err(Constant::False));
        let everything = Solid::difference([Solid::empty(), ball]).complement();
        assert_eq!(lowering.lower(&everything), Err(Constant::True));
    }
}
