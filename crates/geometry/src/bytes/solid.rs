//! Nodes of solids, children first.

use octray_math::bytes::{ByteReader, BytesError};
use octray_math::transform;

use super::{MAX_NODES, ShapeWriter, Shapes, primitive};
use crate::{MaterialId, Solid, SolidNode};

const EMPTY: u8 = 0;
const PRIMITIVE: u8 = 1;
const TRANSFORMED: u8 = 2;
const WITH_MATERIAL: u8 = 3;
const UNION: u8 = 4;
const INTERSECTION: u8 = 5;
const DIFFERENCE: u8 = 6;
const COMPLEMENT: u8 = 7;

fn address(solid: &Solid) -> usize {
    std::ptr::from_ref(solid.node()) as usize
}

impl ShapeWriter {
    /// Collects a solid with everything below it; gives its number.
    pub fn solid(&mut self, solid: &Solid) -> u32 {
        let mut stack = vec![(solid, false)];
        let mut last = 0;
        while let Some((solid, children_are_written)) = stack.pop() {
            if let Some(&id) = self.solid_ids.get(&address(solid)) {
                last = id;
            } else if children_are_written {
                last = self.node(solid);
            } else {
                stack.push((solid, true));
                // The first child comes first.
                stack.extend(solid.node().children().iter().rev().map(|s| (s, false)));
            }
        }
        last
    }

    fn node(&mut self, solid: &Solid) -> u32 {
        let id = self.solid_ids.len() as u32;
        if let SolidNode::Primitive(crate::Primitive::Mesh(mesh)) = solid.node() {
            self.mesh(mesh);
        }
        let ids: Vec<u32> = solid
            .node()
            .children()
            .iter()
            .filter_map(|child| self.solid_ids.get(&address(child)).copied())
            .collect();
        let out = &mut self.solids;
        out.u8(tag(solid.node()));
        match solid.node() {
            SolidNode::Empty => {}
            SolidNode::Primitive(primitive) => {
                primitive::write(primitive, &self.mesh_ids, out);
            }
            SolidNode::Transformed {
                parent_from_child, ..
            } => {
                out.u32(ids[0]);
                out.affine(parent_from_child);
            }
            SolidNode::WithMaterial { material, .. } => {
                out.u32(ids[0]);
                out.u32(material.0);
            }
            SolidNode::Complement(_) => out.u32(ids[0]),
            SolidNode::Union(_) | SolidNode::Intersection(_) | SolidNode::Difference(_) => {
                out.u64(ids.len() as u64);
                ids.iter().for_each(|&id| out.u32(id));
            }
        }
        self.solid_ids.insert(address(solid), id);
        id
    }
}

const fn tag(node: &SolidNode) -> u8 {
    match node {
        SolidNode::Empty => EMPTY,
        SolidNode::Primitive(_) => PRIMITIVE,
        SolidNode::Transformed { .. } => TRANSFORMED,
        SolidNode::WithMaterial { .. } => WITH_MATERIAL,
        SolidNode::Union(_) => UNION,
        SolidNode::Intersection(_) => INTERSECTION,
        SolidNode::Difference(_) => DIFFERENCE,
        SolidNode::Complement(_) => COMPLEMENT,
    }
}

impl Shapes {
    /// Reads the next node and keeps it.
    pub(super) fn read_node(&mut self, reader: &mut ByteReader<'_>) -> Result<(), BytesError> {
        let mut size: u64 = 1;
        let mut child = |reader: &mut ByteReader<'_>| {
            let id = reader.u32()? as usize;
            match (self.solids.get(id), self.sizes.get(id)) {
                (Some(solid), Some(below)) => {
                    size = size.saturating_add(*below);
                    Ok(solid.clone())
                }
                _ => Err(reader.error(format_args!("solid {id} before it is there"))),
            }
        };
        let solid: Solid = match reader.u8()? {
            EMPTY => Solid::empty(),
            PRIMITIVE => primitive::read(reader, &self.meshes)?,
            TRANSFORMED => {
                let child = child(reader)?;
                let parent_from_child = reader.affine()?;
                if !transform::is_invertible(&parent_from_child) {
                    return Err(reader.error("a transform that has no inverse"));
                }
                SolidNode::Transformed {
                    child,
                    parent_from_child,
                }
                .into()
            }
            WITH_MATERIAL => SolidNode::WithMaterial {
                child: child(reader)?,
                material: MaterialId(reader.u32()?),
            }
            .into(),
            COMPLEMENT => SolidNode::Complement(child(reader)?).into(),
            operation @ (UNION | INTERSECTION | DIFFERENCE) => {
                let count = reader.count(4)?;
                if count < 2 {
                    return Err(reader.error("an operation on fewer than two solids"));
                }
                let mut operands = Vec::with_capacity(count);
                for _ in 0..count {
                    operands.push(child(reader)?);
                }
                match operation {
                    UNION => SolidNode::Union(operands),
                    INTERSECTION => SolidNode::Intersection(operands),
                    _ => SolidNode::Difference(operands),
                }
                .into()
            }
            other => return Err(reader.error(format_args!("a node of unknown kind {other}"))),
        };
        solid.check_size().map_err(|error| reader.error(error))?;
        if size > MAX_NODES {
            return Err(reader.error("a solid that is too large"));
        }
        self.solids.push(solid);
        self.sizes.push(size);
        Ok(())
    }
}
