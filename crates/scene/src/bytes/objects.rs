//! Shapes, prototypes, names and objects.

use std::collections::BTreeMap;
use std::sync::Arc;

use octray_geometry::{MaterialId, ShapeWriter, Shapes, Sheet};
use octray_math::bytes::{ByteReader, ByteWriter, BytesError};
use octray_math::{DAffine3, transform};

use crate::{Instances, Object, Prototype, Scene, SceneBuilder, Shape};

const SOLID: u8 = 0;
const MESH: u8 = 1;
const SHELL: u8 = 2;
const INSTANCES: u8 = 3;

pub(super) fn write(scene: &Scene, out: &mut ByteWriter) {
    let mut shapes = ShapeWriter::new();
    // By address, in the order in which they are met.
    let mut prototype_ids: BTreeMap<usize, u32> = BTreeMap::new();
    let mut prototypes = ByteWriter::new();
    let mut name_ids: BTreeMap<&str, u32> = BTreeMap::new();
    let mut names = ByteWriter::new();
    let mut objects = ByteWriter::new();
    for object in scene.objects() {
        let next = name_ids.len() as u32;
        let name = *name_ids.entry(&object.name).or_insert(next);
        if name == next {
            names.str(&object.name);
        }
        if let Shape::Instances(instances) = &object.shape {
            let next = prototype_ids.len() as u32;
            let prototype = instances.prototype();
            let id = *prototype_ids
                .entry(Arc::as_ptr(prototype) as usize)
                .or_insert(next);
            if id == next {
                let parts = prototype.parts().objects();
                prototypes.u64(parts.len() as u64);
                for part in parts {
                    write_part(&part.shape, &mut shapes, &mut prototypes);
                }
            }
            objects.u8(INSTANCES);
            objects.u32(id);
            let numbers: Vec<f64> = instances
                .world_from_prototype()
                .iter()
                .flat_map(DAffine3::to_cols_array)
                .collect();
            objects.f64s(&numbers);
        } else {
            write_part(&object.shape, &mut shapes, &mut objects);
        }
        objects.u32(name);
        objects.u32(object.material.0);
        objects.i32(object.priority);
        objects.bool(object.casts_shadows);
    }
    shapes.write(out);
    for (count, part) in [
        (prototype_ids.len(), prototypes),
        (name_ids.len(), names),
        (scene.objects().len(), objects),
    ] {
        out.u64(count as u64);
        let bytes = part.into_bytes();
        out.raw(&bytes);
        out.align();
    }
}

/// A solid or sheet.
fn write_part(shape: &Shape, shapes: &mut ShapeWriter, out: &mut ByteWriter) {
    match shape {
        Shape::Solid(solid) => {
            out.u8(SOLID);
            out.u32(shapes.solid(solid));
        }
        Shape::Sheet(Sheet::Mesh {
            mesh,
            world_from_mesh,
        }) => {
            out.u8(MESH);
            out.u32(shapes.mesh(mesh));
            out.affine(world_from_mesh);
        }
        Shape::Sheet(Sheet::Shell { solid, clip }) => {
            out.u8(SHELL);
            out.u32(shapes.solid(solid));
            out.u32(shapes.solid(clip));
        }
        // The caller writes them; a prototype has none.
        Shape::Instances(_) => {}
    }
}

pub(super) fn read(
    reader: &mut ByteReader<'_>,
    builder: &mut SceneBuilder,
) -> Result<(), BytesError> {
    let mut shapes = Shapes::read(reader)?;
    let mut prototypes = Vec::new();
    for _ in 0..reader.count(8)? {
        let mut parts = Vec::new();
        for _ in 0..reader.count(5)? {
            let kind = reader.u8()?;
            parts.push(read_part(kind, &mut shapes, reader)?);
        }
        let prototype = Prototype::new(parts).map_err(|error| reader.error(error))?;
        prototypes.push(Arc::new(prototype));
    }
    reader.align()?;
    let mut names: Vec<Arc<str>> = Vec::new();
    for _ in 0..reader.count(8)? {
        names.push(reader.str()?.into());
    }
    reader.align()?;
    for _ in 0..reader.count(18)? {
        let shape = match reader.u8()? {
            INSTANCES => {
                let id = reader.u32()? as usize;
                let prototype = prototypes.get(id).map(Arc::clone);
                let prototype = prototype.ok_or_else(|| reader.error("an unknown prototype"))?;
                let numbers = reader.f64s()?;
                let (rows, rest) = numbers.as_chunks::<12>();
                if !rest.is_empty() {
                    return Err(reader.error("an array that ends within a row"));
                }
                let placed: Vec<DAffine3> = rows.iter().map(DAffine3::from_cols_array).collect();
                let instances = Instances::new(prototype, placed);
                Shape::Instances(instances.map_err(|error| reader.error(error))?)
            }
            kind => read_part(kind, &mut shapes, reader)?,
        };
        let name = names.get(reader.u32()? as usize).map(Arc::clone);
        let name = name.ok_or_else(|| reader.error("an unknown name"))?;
        let mut object = Object::new(name, shape, MaterialId(reader.u32()?));
        object.priority = reader.i32()?;
        object.casts_shadows = reader.bool()?;
        builder.add_object(object);
    }
    reader.align()
}

fn read_part(
    kind: u8,
    shapes: &mut Shapes,
    reader: &mut ByteReader<'_>,
) -> Result<Shape, BytesError> {
    Ok(match kind {
        SOLID => Shape::Solid(shapes.solid(reader)?),
        MESH => {
            let mesh = shapes.mesh(reader)?;
            let world_from_mesh = reader.affine()?;
            if !transform::is_invertible(&world_from_mesh) {
                return Err(reader.error("a transform that has no inverse"));
            }
            Shape::Sheet(Sheet::Mesh {
                mesh,
                world_from_mesh: Box::new(world_from_mesh),
            })
        }
        SHELL => Shape::Sheet(Sheet::Shell {
            solid: shapes.solid(reader)?,
            clip: shapes.solid(reader)?,
        }),
        other => return Err(reader.error(format_args!("a shape of unknown kind {other}"))),
    })
}
