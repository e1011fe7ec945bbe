//! Primitives as what they are made from.

use std::collections::BTreeMap;
use std::sync::Arc;

use octray_math::bytes::{ByteReader, ByteWriter, BytesError};

use super::profile;
use crate::surface::QuadricForm;
use crate::{
    ConvexPolyhedron, MeshRule, Polynomial, Primitive, ShapeError, Solid, SolidNode, TriangleMesh,
};

const SPHERE: u8 = 0;
const BOX: u8 = 1;
const CYLINDER: u8 = 2;
const CONE: u8 = 3;
const TORUS: u8 = 4;
const QUADRIC: u8 = 5;
const POLYNOMIAL: u8 = 6;
const SUPERELLIPSOID: u8 = 7;
const HALF_SPACE: u8 = 8;
const CONVEX: u8 = 9;
const COMPOSITE: u8 = 10;
const MESH: u8 = 11;

const FORMS: [QuadricForm; 7] = [
    QuadricForm::OneSheet,
    QuadricForm::TwoSheets,
    QuadricForm::DoubleCone,
    QuadricForm::EllipticParaboloid,
    QuadricForm::HyperbolicParaboloid,
    QuadricForm::HyperbolicCylinder,
    QuadricForm::ParabolicCylinder,
];

pub(super) fn write(primitive: &Primitive, mesh_ids: &BTreeMap<usize, u32>, out: &mut ByteWriter) {
    match primitive {
        Primitive::Sphere { radius } => {
            out.u8(SPHERE);
            out.f64(*radius);
        }
        Primitive::Box { min, max } => {
            out.u8(BOX);
            out.vec3(*min);
            out.vec3(*max);
        }
        Primitive::Cylinder { radius, z } => {
            out.u8(CYLINDER);
            numbers(&[*radius, z[0], z[1]], out);
        }
        Primitive::Cone { radius, z } => {
            out.u8(CONE);
            numbers(&[radius[0], radius[1], z[0], z[1]], out);
        }
        Primitive::Torus { major, minor } => {
            out.u8(TORUS);
            numbers(&[*major, *minor], out);
        }
        Primitive::Quadric(form) => {
            out.u8(QUADRIC);
            let place = FORMS.iter().position(|known| known == form);
            out.u8(place.unwrap_or_default() as u8);
        }
        Primitive::Polynomial { polynomial, .. } => {
            out.u8(POLYNOMIAL);
            out.u8(polynomial.degree() as u8);
            out.f64s(polynomial.coefficients());
        }
        Primitive::Superellipsoid { exponents } => {
            out.u8(SUPERELLIPSOID);
            numbers(exponents, out);
        }
        Primitive::HalfSpace { normal, offset } => {
            out.u8(HALF_SPACE);
            out.vec3(*normal);
            out.f64(*offset);
        }
        Primitive::Convex(polyhedron) => {
            out.u8(CONVEX);
            out.u64(polyhedron.planes.len() as u64);
            for (normal, offset) in &polyhedron.planes {
                out.vec3(*normal);
                out.f64(*offset);
            }
            out.f64s(bytemuck::cast_slice(&polyhedron.vertices));
        }
        Primitive::Composite(composite) => {
            out.u8(COMPOSITE);
            profile::write(composite.boundary(), out);
        }
        Primitive::Mesh(mesh) => {
            out.u8(MESH);
            let id = mesh_ids.get(&(Arc::as_ptr(mesh) as usize));
            out.u32(id.copied().unwrap_or_default());
        }
    }
}

fn numbers(all: &[f64], out: &mut ByteWriter) {
    all.iter().for_each(|&x| out.f64(x));
}

pub(super) fn read(
    reader: &mut ByteReader<'_>,
    meshes: &[Arc<TriangleMesh>],
) -> Result<Solid, BytesError> {
    let solid = match reader.u8()? {
        SPHERE => Solid::sphere(reader.f64()?),
        BOX => Solid::cuboid(reader.vec3()?, reader.vec3()?),
        CYLINDER => {
            let (radius, z0, z1) = (reader.f64()?, reader.f64()?, reader.f64()?);
            if z0 == f64::NEG_INFINITY && z1 == f64::INFINITY {
                Solid::infinite_cylinder(radius)
            } else {
                Solid::cylinder(radius, z0, z1)
            }
        }
        CONE => Solid::cone(reader.f64()?, reader.f64()?, reader.f64()?, reader.f64()?),
        TORUS => Solid::torus(reader.f64()?, reader.f64()?),
        QUADRIC => {
            let form = reader.u8()?;
            let form = FORMS.get(usize::from(form)).copied();
            let form = form.ok_or_else(|| reader.error("an unknown quadric"))?;
            Ok(Solid::primitive(Primitive::Quadric(form)))
        }
        POLYNOMIAL => {
            let degree = usize::from(reader.u8()?);
            Polynomial::new(degree, &reader.f64s()?).and_then(Solid::polynomial)
        }
        SUPERELLIPSOID => Solid::superellipsoid(reader.f64()?, reader.f64()?),
        HALF_SPACE => {
            let (normal, offset) = (reader.vec3()?, reader.f64()?);
            // Not normalised again: that would change its last bits.
            if !normal.is_normalized() || !offset.is_finite() {
                return Err(reader.error("a plane that is none"));
            }
            let node = SolidNode::Primitive(Primitive::HalfSpace { normal, offset });
            Ok(Solid::from(node))
        }
        CONVEX => {
            let count = reader.count(32)?;
            let mut planes = Vec::with_capacity(count);
            for _ in 0..count {
                planes.push((reader.vec3()?, reader.f64()?));
            }
            let numbers = reader.f64s()?;
            let (rows, rest) = numbers.as_chunks::<3>();
            if !rest.is_empty() {
                return Err(reader.error("an array that ends within a row"));
            }
            let vertices = rows.iter().copied().map(Into::into).collect();
            ConvexPolyhedron::from_parts(planes, vertices)
                .map(|polyhedron| Solid::convex(Arc::new(polyhedron)))
        }
        COMPOSITE => profile::read(reader)?,
        MESH => {
            let id = reader.u32()? as usize;
            match meshes.get(id) {
                // It may have been taken under the stricter rule; this one suffices for an inside.
                Some(mesh) => Solid::mesh(Arc::clone(mesh), MeshRule::Winding),
                None => return Err(reader.error(format_args!("mesh {id}, which does not exist"))),
            }
        }
        other => return Err(reader.error(format_args!("a primitive of unknown kind {other}"))),
    };
    solid.map_err(|error: ShapeError| reader.error(error))
}
