//! The surfaces of the primitives.

use std::sync::Arc;

use octray_math::{DAffine3, DMat3, DVec3};

use super::lower::{FIRST_MESH, Lowering, MeshOperand};
use crate::mesh::FacetPlanes;
use crate::surface::{Canonical, QuadricForm, Surface, points_upward};
use crate::{CompositeFace, Primitive, SurfaceId};

impl Lowering {
    /// The surfaces of a primitive, each with whether the inside is on its positive side.
    pub(super) fn sides(
        &mut self,
        primitive: &Primitive,
        scene: &DAffine3,
    ) -> Vec<(SurfaceId, bool)> {
        match primitive {
            Primitive::Sphere { radius } => {
                let frame = *scene * DAffine3::from_scale(DVec3::splat(*radius));
                vec![self.curved(Canonical::Sphere, &frame)]
            }
            Primitive::Box { min, max } => [DVec3::X, DVec3::Y, DVec3::Z]
                .into_iter()
                .flat_map(|axis| [(axis, *max), (-axis, *min)])
                .map(|(normal, corner)| self.plane(scene, normal, corner))
                .collect(),
            Primitive::Cylinder { radius, z } => {
                let frame = *scene * DAffine3::from_scale(DVec3::new(*radius, *radius, 1.0));
                let mut sides = vec![self.curved(Canonical::Cylinder, &frame)];
                sides.extend(self.caps(scene, *z));
                sides
            }
            Primitive::Cone { radius, z } => {
                // The frame stands on the wide end; its height reaches the narrow one at 1.
                let [(wide, from), (narrow, to)] = if radius[0] > radius[1] {
                    [(radius[0], z[0]), (radius[1], z[1])]
                } else {
                    [(radius[1], z[1]), (radius[0], z[0])]
                };
                let frame = *scene
                    * DAffine3::from_translation(DVec3::new(0.0, 0.0, from))
                    * DAffine3::from_scale(DVec3::new(wide, wide, to - from));
                let slope = (narrow - wide) / wide;
                let mut sides = vec![self.curved(Canonical::Cone { slope }, &frame)];
                sides.extend(self.caps(scene, *z));
                sides
            }
            Primitive::Torus { major, minor } => {
                let frame = *scene * DAffine3::from_scale(DVec3::splat(*major));
                let minor = minor / major;
                vec![self.curved(Canonical::Torus { minor }, &frame)]
            }
            Primitive::Quadric(QuadricForm::HyperbolicParaboloid)
                if !points_upward(scene.matrix3.z_axis.normalize()) =>
            {
                // Upside down, and x for y, it is the same surface with its sides exchanged.
                let turned = DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::NEG_Z);
                let frame = *scene * DAffine3::from_mat3(turned);
                let form = Canonical::Quadric(QuadricForm::HyperbolicParaboloid);
                let (surface, _) = self.curved(form, &frame);
                vec![(surface, true)]
            }
            Primitive::Quadric(form) => vec![self.curved(Canonical::Quadric(*form), scene)],
            Primitive::Polynomial { polynomial, .. } => {
                let canonical = Canonical::Polynomial(Arc::clone(polynomial));
                vec![self.curved(canonical, scene)]
            }
            Primitive::Superellipsoid { exponents } => {
                let exponents = *exponents;
                vec![self.curved(Canonical::Superellipsoid { exponents }, scene)]
            }
            Primitive::HalfSpace { normal, offset } => {
                vec![self.plane(scene, *normal, *normal * *offset)]
            }
            Primitive::Convex(polyhedron) => polyhedron
                .planes
                .iter()
                .map(|(normal, offset)| self.plane(scene, *normal, *normal * *offset))
                .collect(),
            Primitive::Composite(composite) => composite
                .faces()
                .iter()
                .map(|face| self.composite_face(scene, face))
                .collect(),
            Primitive::Mesh(mesh) => {
                let surface = SurfaceId(FIRST_MESH - self.meshes.len() as u32);
                self.meshes.push(MeshOperand {
                    planes: FacetPlanes::default(),
                    mesh: Arc::clone(mesh),
                    scene_from_mesh: *scene,
                });
                vec![(surface, false)]
            }
        }
    }

    fn composite_face(&mut self, scene: &DAffine3, face: &CompositeFace) -> (SurfaceId, bool) {
        match face {
            CompositeFace::Plane { normal, point } => self.plane(scene, *normal, *point),
            CompositeFace::Curved {
                canonical,
                from_local,
            } => self.curved(canonical.clone(), &(*scene * *from_local)),
        }
    }

    /// A surface whose inside is its negative side.
    fn curved(&mut self, canonical: Canonical, scene_from_local: &DAffine3) -> (SurfaceId, bool) {
        let surface = Surface::Curved {
            canonical,
            local_from_scene: scene_from_local.inverse(),
        };
        (self.table.insert(surface), false)
    }

    fn caps(&mut self, scene: &DAffine3, z: [f64; 2]) -> Vec<(SurfaceId, bool)> {
        [(DVec3::Z, z[1]), (DVec3::NEG_Z, z[0])]
            .into_iter()
            .filter(|(_, height)| height.is_finite())
            .map(|(normal, height)| self.plane(scene, normal, DVec3::new(0.0, 0.0, height)))
            .collect()
    }

    /// The plane through `point` whose outward normal is `normal`, both in the local frame.
    fn plane(&mut self, scene: &DAffine3, normal: DVec3, point: DVec3) -> (SurfaceId, bool) {
        // Normals go by the cofactor matrix, which keeps axis-aligned ones exact; its sign is the
        // determinant's, so a mirrored frame still points outwards.
        let m = scene.matrix3;
        let cofactor = m.y_axis.cross(m.z_axis) * normal.x
            + m.z_axis.cross(m.x_axis) * normal.y
            + m.x_axis.cross(m.y_axis) * normal.z;
        let handed = if m.determinant() < 0.0 {
            -cofactor
        } else {
            cofactor
        };
        let outward = (handed / handed.abs().max_element()).normalize();
        let offset = outward.dot(scene.transform_point3(point));
        let upward = points_upward(outward);
        let surface = if upward {
            Surface::Plane {
                normal: outward,
                offset,
            }
        } else {
            Surface::Plane {
                normal: -outward,
                offset: -offset,
            }
        };
        (self.table.insert(surface), !upward)
    }
}
