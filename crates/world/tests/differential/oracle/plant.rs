//! From the user's tree of solids to one over primitives, each with its chain of transforms.

use std::sync::Arc;

use octray_geometry::profile::Formula;
use octray_geometry::surface::Canonical;
use octray_geometry::{CompositeFace, Polynomial, Primitive, Solid, SolidNode};
use octray_math::{Aabb, DAffine3};

use super::clearance::extent;
use super::frame::Frame;
use super::implicit;
use super::{Leaf, Node};

/// Puts a solid's primitives among the leaves, each with the transforms above it.
pub(super) fn plant(solid: &Solid, chain: &mut Vec<DAffine3>, leaves: &mut Vec<Leaf>) -> Node {
    let mut each = |solids: &[Solid]| -> Vec<Node> {
        let all = solids.iter();
        all.map(|s| plant(s, chain, leaves)).collect()
    };
    match solid.node() {
        SolidNode::Empty => Node::Any(Vec::new()),
        SolidNode::Primitive(Primitive::Composite(composite)) => {
            let faces = composite.faces().iter();
            let sides: Vec<usize> = faces.map(|face| plant_face(face, chain, leaves)).collect();
            formula(composite.formula(), &sides)
        }
        SolidNode::Primitive(primitive) => Node::Leaf(plant_leaf(primitive, chain, leaves)),
        SolidNode::Transformed {
            child,
            parent_from_child,
        } => {
            chain.push(*parent_from_child);
            let node = plant(child, chain, leaves);
            chain.pop();
            node
        }
        SolidNode::WithMaterial { child, .. } => plant(child, chain, leaves),
        SolidNode::Complement(child) => Node::Not(Box::new(plant(child, chain, leaves))),
        SolidNode::Union(all) => Node::Any(each(all)),
        SolidNode::Intersection(all) => Node::All(each(all)),
        SolidNode::Difference(all) => {
            let mut nodes = each(all).into_iter();
            let first = nodes.next().expect("a difference has operands");
            let rest = nodes.map(|n| Node::Not(Box::new(n)));
            Node::All(std::iter::once(first).chain(rest).collect())
        }
    }
}

fn plant_leaf(primitive: &Primitive, chain: &[DAffine3], leaves: &mut Vec<Leaf>) -> usize {
    leaves.push(Leaf {
        primitive: primitive.clone(),
        chain: chain.to_vec(),
        frame: Frame::new(chain),
        extent: extent(primitive),
        terms: implicit::terms(primitive),
    });
    leaves.len() - 1
}

/// The inside of one face of a prism, a lathe or a polyhedron.
fn plant_face(face: &CompositeFace, chain: &mut Vec<DAffine3>, leaves: &mut Vec<Leaf>) -> usize {
    let (canonical, from_local) = match face {
        CompositeFace::Plane { normal, point } => {
            let normal = normal.normalize();
            let offset = normal.dot(*point);
            return plant_leaf(&Primitive::HalfSpace { normal, offset }, chain, leaves);
        }
        CompositeFace::Curved {
            canonical,
            from_local,
        } => (canonical, from_local),
    };
    let primitive = match canonical {
        Canonical::Sphere => Primitive::Sphere { radius: 1.0 },
        Canonical::Cylinder => Primitive::Cylinder {
            radius: 1.0,
            z: [f64::NEG_INFINITY, f64::INFINITY],
        },
        Canonical::Torus { minor } => Primitive::Torus {
            major: 1.0,
            minor: *minor,
        },
        // Both nappes: x^2 + y^2 - (1 + slope z)^2.
        Canonical::Cone { slope } => {
            let z = [-slope * slope, -2.0 * slope, -1.0];
            let c = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, z[0], z[1], z[2]];
            Primitive::Polynomial {
                polynomial: Arc::new(Polynomial::new(2, &c).expect("a quadratic")),
                bounds: Aabb::ALL,
            }
        }
        other => panic!("no definition of {other:?}"),
    };
    chain.push(*from_local);
    let leaf = plant_leaf(&primitive, chain, leaves);
    chain.pop();
    leaf
}

fn formula(formula_of: &Formula, sides: &[usize]) -> Node {
    let each = |parts: &[Formula]| parts.iter().map(|part| formula(part, sides)).collect();
    match formula_of {
        Formula::Constant(true) => Node::All(Vec::new()),
        Formula::Constant(false) => Node::Any(Vec::new()),
        Formula::Side { side, inside } => {
            let leaf = Node::Leaf(sides[*side as usize]);
            if *inside {
                leaf
            } else {
                Node::Not(Box::new(leaf))
            }
        }
        Formula::All(parts) => Node::All(each(parts)),
        Formula::Any(parts) => Node::Any(each(parts)),
    }
}
