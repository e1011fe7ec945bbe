//! Set operations on primitives, as the user writes them.

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3, transform};

use crate::MaterialId;
use crate::mesh::TriangleMesh;
use crate::primitive::{ConvexPolyhedron, Primitive, ShapeError};

/// An immutable CSG tree, shared on clone.
///
/// Every method returns a new solid. Boundaries belong to no operand in particular: operations
/// are regularised, so a difference with a coincident face leaves no skin.
#[derive(Clone, Debug)]
pub struct Solid(Arc<SolidNode>);

/// One node of a [`Solid`].
#[derive(Clone, Debug)]
pub enum SolidNode {
    /// No point.
    Empty,
    /// A primitive in its own frame.
    Primitive(Primitive),
    /// The child, moved.
    Transformed {
        /// What is moved.
        child: Solid,
        /// Maps the child's frame to this node's; invertible.
        parent_from_child: DAffine3,
    },
    /// The child, with a material on every face below that has none of its own.
    WithMaterial {
        /// What is painted.
        child: Solid,
        /// With what.
        material: MaterialId,
    },
    /// Points in any operand.
    Union(Vec<Solid>),
    /// Points in every operand.
    Intersection(Vec<Solid>),
    /// Points in the first operand and in none of the others.
    Difference(Vec<Solid>),
    /// Points not in the operand.
    Complement(Solid),
}

fn finite(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ShapeError::NotFinite { what, value })
    }
}

fn positive(what: &'static str, value: f64) -> Result<f64, ShapeError> {
    if finite(what, value)? > 0.0 {
        Ok(value)
    } else {
        Err(ShapeError::NotPositive { what, value })
    }
}

impl From<SolidNode> for Solid {
    fn from(node: SolidNode) -> Self {
        Self(Arc::new(node))
    }
}

impl Solid {
    /// The top node.
    #[must_use]
    pub fn node(&self) -> &SolidNode {
        &self.0
    }

    fn primitive(primitive: Primitive) -> Self {
        SolidNode::Primitive(primitive).into()
    }

    /// The solid without points.
    #[must_use]
    pub fn empty() -> Self {
        SolidNode::Empty.into()
    }

    /// A ball about the origin.
    ///
    /// # Errors
    /// `radius` is not finite and positive.
    pub fn sphere(radius: f64) -> Result<Self, ShapeError> {
        let radius = positive("radius", radius)?;
        Ok(Self::primitive(Primitive::Sphere { radius }))
    }

    /// The box between two corners given in any order.
    ///
    /// # Errors
    /// A coordinate is not finite, or an edge has no length.
    pub fn cuboid(a: DVec3, b: DVec3) -> Result<Self, ShapeError> {
        let (min, max) = (a.min(b), a.max(b));
        for (axis, what) in ["size along x", "size along y", "size along z"]
            .into_iter()
            .enumerate()
        {
            finite(what, min[axis])?;
            positive(what, max[axis] - min[axis])?;
        }
        Ok(Self::primitive(Primitive::Box { min, max }))
    }

    /// A capped cylinder about the z axis from `z0` to `z1`.
    ///
    /// # Errors
    /// `radius` or `z1 - z0` is not finite and positive.
    pub fn cylinder(radius: f64, z0: f64, z1: f64) -> Result<Self, ShapeError> {
        let radius = positive("radius", radius)?;
        finite("z0", z0)?;
        positive("height", z1 - z0)?;
        Ok(Self::primitive(Primitive::Cylinder {
            radius,
            z: [z0, z1],
        }))
    }

    /// The points within `radius` of the z axis, without ends.
    ///
    /// # Errors
    /// `radius` is not finite and positive.
    pub fn infinite_cylinder(radius: f64) -> Result<Self, ShapeError> {
        let radius = positive("radius", radius)?;
        let z = [f64::NEG_INFINITY, f64::INFINITY];
        Ok(Self::primitive(Primitive::Cylinder { radius, z }))
    }

    /// A capped cone or frustum about the z axis: radius `r0` at `z0`, `r1` at `z1`.
    ///
    /// # Errors
    /// A radius is negative or not finite, both are 0, or `z1 - z0` is not finite and positive.
    pub fn cone(r0: f64, r1: f64, z0: f64, z1: f64) -> Result<Self, ShapeError> {
        for (what, value) in [("bottom radius", r0), ("top radius", r1)] {
            if finite(what, value)? < 0.0 {
                return Err(ShapeError::NotPositive { what, value });
            }
        }
        positive("largest radius", r0.max(r1))?;
        finite("z0", z0)?;
        positive("height", z1 - z0)?;
        if r0 == r1 {
            return Self::cylinder(r0, z0, z1);
        }
        Ok(Self::primitive(Primitive::Cone {
            radius: [r0, r1],
            z: [z0, z1],
        }))
    }

    /// A torus about the z axis.
    ///
    /// # Errors
    /// A radius is not finite and positive.
    pub fn torus(major: f64, minor: f64) -> Result<Self, ShapeError> {
        let major = positive("major radius", major)?;
        let minor = positive("minor radius", minor)?;
        Ok(Self::primitive(Primitive::Torus { major, minor }))
    }

    /// The points with `normal . x <= distance * |normal|`: `distance` is measured along the
    /// normal, whatever its length.
    ///
    /// # Errors
    /// `normal` is zero or not finite, or `distance` is not finite.
    pub fn half_space(normal: DVec3, distance: f64) -> Result<Self, ShapeError> {
        for axis in 0..3 {
            finite("normal", normal[axis])?;
        }
        let offset = finite("distance", distance)?;
        // Scaled first, so that a tiny or huge normal is as good as any.
        let normal = (normal / normal.abs().max_element()).try_normalize();
        let normal = normal.ok_or(ShapeError::ZeroVector { what: "normal" })?;
        Ok(Self::primitive(Primitive::HalfSpace { normal, offset }))
    }

    /// A convex polyhedron.
    #[must_use]
    pub fn convex(polyhedron: Arc<ConvexPolyhedron>) -> Self {
        Self::primitive(Primitive::Convex(polyhedron))
    }

    /// The inside of a closed mesh.
    ///
    /// # Errors
    /// The mesh is empty, open, non-manifold or not consistently oriented.
    pub fn mesh(mesh: Arc<TriangleMesh>) -> Result<Self, ShapeError> {
        mesh.check_closed()?;
        Ok(Self::primitive(Primitive::Mesh(mesh)))
    }

    /// Points in any of the operands; of none, the empty solid.
    #[must_use]
    pub fn union(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut operands: Vec<Self> = operands.into_iter().collect();
        match operands.len() {
            0 => Self::empty(),
            1 => operands.swap_remove(0),
            _ => SolidNode::Union(operands).into(),
        }
    }

    /// Points in all operands; of none, the empty solid (as in OpenSCAD and POV-Ray).
    #[must_use]
    pub fn intersection(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut operands: Vec<Self> = operands.into_iter().collect();
        match operands.len() {
            0 => Self::empty(),
            1 => operands.swap_remove(0),
            _ => SolidNode::Intersection(operands).into(),
        }
    }

    /// Points in the first operand and in none of the others; of none, the empty solid.
    #[must_use]
    pub fn difference(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut operands: Vec<Self> = operands.into_iter().collect();
        match operands.len() {
            0 => Self::empty(),
            1 => operands.swap_remove(0),
            _ => SolidNode::Difference(operands).into(),
        }
    }

    /// Points not in this solid.
    #[must_use]
    pub fn complement(&self) -> Self {
        SolidNode::Complement(self.clone()).into()
    }

    /// This solid under an affine map, which may scale unevenly or mirror.
    ///
    /// # Errors
    /// [`ShapeError::SingularTransform`].
    pub fn transform(&self, parent_from_child: DAffine3) -> Result<Self, ShapeError> {
        if !transform::is_invertible(&parent_from_child) {
            return Err(ShapeError::SingularTransform);
        }
        let (child, parent_from_child) = match self.node() {
            SolidNode::Transformed {
                child,
                parent_from_child: inner,
            } => (child.clone(), parent_from_child * *inner),
            _ => (self.clone(), parent_from_child),
        };
        Ok(SolidNode::Transformed {
            child,
            parent_from_child,
        }
        .into())
    }

    /// This solid moved by `offset`.
    ///
    /// # Errors
    /// `offset` is not finite.
    pub fn translate(&self, offset: DVec3) -> Result<Self, ShapeError> {
        self.transform(DAffine3::from_translation(offset))
    }

    /// This solid with `material` on every face that has none yet.
    #[must_use]
    pub fn with_material(&self, material: MaterialId) -> Self {
        SolidNode::WithMaterial {
            child: self.clone(),
            material,
        }
        .into()
    }

    /// A box around the solid: not always the smallest, never too small.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds_in(&DAffine3::IDENTITY)
    }

    /// Like [`Solid::bounds`], after `world_from_here`; transforms are applied once, at the
    /// primitives, so that nested rotations do not inflate the box at every level.
    #[must_use]
    pub fn bounds_in(&self, world_from_here: &DAffine3) -> Aabb {
        let each = |solids: &[Self]| -> Vec<Aabb> {
            solids
                .iter()
                .map(|s| s.bounds_in(world_from_here))
                .collect()
        };
        match self.node() {
            SolidNode::Empty => Aabb::EMPTY,
            SolidNode::Primitive(Primitive::Convex(polyhedron)) => Aabb::from_points(
                polyhedron
                    .vertices
                    .iter()
                    .map(|&v| world_from_here.transform_point3(v)),
            ),
            SolidNode::Primitive(primitive) => primitive.bounds().transformed(world_from_here),
            SolidNode::Transformed {
                child,
                parent_from_child,
            } => child.bounds_in(&(*world_from_here * *parent_from_child)),
            SolidNode::WithMaterial { child, .. } => child.bounds_in(world_from_here),
            SolidNode::Union(solids) => each(solids).into_iter().fold(Aabb::EMPTY, Aabb::union),
            SolidNode::Intersection(solids) => {
                let common = each(solids).into_iter().fold(Aabb::ALL, Aabb::intersection);
                if common.is_empty() {
                    Aabb::EMPTY
                } else {
                    common
                }
            }
            SolidNode::Difference(solids) => solids
                .first()
                .map_or(Aabb::EMPTY, |first| first.bounds_in(world_from_here)),
            SolidNode::Complement(_) => Aabb::ALL,
        }
    }
}
