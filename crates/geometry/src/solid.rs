//! Set operations on primitives, as the user writes them.

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3, transform};

use crate::MaterialId;
use crate::mesh::{MeshRule, TriangleMesh};
use crate::polyhedron;
use crate::primitive::{ConvexPolyhedron, Primitive, ShapeError};
use crate::profile::{self, Region, Turning};

/// An immutable CSG tree, shared on clone.
///
/// Every method returns a new solid. Boundaries belong to no operand in particular: operations
/// are regularised, so a difference with a coincident face leaves no skin.
#[derive(Clone, Debug)]
pub struct Solid(Arc<Measured>);

/// A node with what decides whether the tree can be worked on at all.
#[derive(Debug)]
struct Measured {
    node: SolidNode,
    /// Nodes on the longest way down.
    depth: u32,
    /// Primitives, those of shared subtrees counted at every use.
    operands: u64,
    /// Faces, likewise.
    faces: u64,
}

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

pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, ShapeError> {
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

impl SolidNode {
    pub(crate) fn children(&self) -> &[Solid] {
        match self {
            Self::Empty | Self::Primitive(_) => &[],
            Self::Transformed { child, .. }
            | Self::WithMaterial { child, .. }
            | Self::Complement(child) => std::slice::from_ref(child),
            Self::Union(all) | Self::Intersection(all) | Self::Difference(all) => all,
        }
    }
}

impl From<SolidNode> for Solid {
    fn from(node: SolidNode) -> Self {
        let below = node.children().iter();
        let depth = 1 + below.clone().map(|s| s.0.depth).max().unwrap_or(0);
        let own = match &node {
            SolidNode::Primitive(primitive) => (1_u64, primitive.face_count()),
            _ => (0, 0),
        };
        let (operands, faces) = below.fold(own, |(operands, faces), s| {
            (
                operands.saturating_add(s.0.operands),
                faces.saturating_add(s.0.faces),
            )
        });
        Self(Arc::new(Measured {
            node,
            depth,
            operands,
            faces,
        }))
    }
}

impl Drop for Measured {
    /// Takes a deep tree apart in a loop: the compiler's own way recurses.
    fn drop(&mut self) {
        if self.depth < 64 {
            return;
        }
        let mut stack = vec![std::mem::replace(&mut self.node, SolidNode::Empty)];
        while let Some(mut node) = stack.pop() {
            let children = match &mut node {
                SolidNode::Union(all)
                | SolidNode::Intersection(all)
                | SolidNode::Difference(all) => std::mem::take(all),
                SolidNode::Transformed { child, .. }
                | SolidNode::WithMaterial { child, .. }
                | SolidNode::Complement(child) => vec![std::mem::replace(child, Solid::empty())],
                SolidNode::Empty | SolidNode::Primitive(_) => Vec::new(),
            };
            for mut child in children {
                if let Some(last_owner) = Arc::get_mut(&mut child.0) {
                    stack.push(std::mem::replace(&mut last_owner.node, SolidNode::Empty));
                    last_owner.depth = 0;
                }
            }
        }
    }
}

/// Up to this product of faces and corners it is tried whether a polyhedron is convex.
pub(crate) const CONVEX_TESTS: usize = 50_000_000;
/// The deepest tree of solids that is worked on.
pub const MAX_NESTING: u32 = 1000;
/// The most operands a solid may have, shared subtrees counted at every use.
pub const MAX_OPERANDS: u64 = 1 << 26;

impl Solid {
    /// The top node.
    #[must_use]
    pub fn node(&self) -> &SolidNode {
        &self.0.node
    }

    /// How many primitives it has, those of shared subtrees counted at every use.
    #[must_use]
    pub fn operands(&self) -> u64 {
        self.0.operands
    }

    /// How many faces the primitives have together.
    #[must_use]
    pub fn faces(&self) -> u64 {
        self.0.faces
    }

    /// Checks that the tree is not too deep or too large to be worked on.
    ///
    /// Bounds and lowering recurse; scenes check this before they accept a solid.
    ///
    /// # Errors
    /// [`ShapeError::TooDeep`] or [`ShapeError::TooManyOperands`].
    pub fn check_size(&self) -> Result<(), ShapeError> {
        if self.0.depth > MAX_NESTING {
            return Err(ShapeError::TooDeep(self.0.depth));
        }
        if self.0.operands > MAX_OPERANDS {
            return Err(ShapeError::TooManyOperands(self.0.operands));
        }
        Ok(())
    }

    /// `operands` with those that are themselves nodes of the same kind replaced by theirs, so
    /// that `a + b + c + ...` is one flat node.
    fn spliced(
        operands: impl IntoIterator<Item = Self>,
        same: impl Fn(usize, &SolidNode) -> Option<&[Self]>,
    ) -> Vec<Self> {
        let mut flat = Vec::new();
        for (index, operand) in operands.into_iter().enumerate() {
            match same(index, operand.node()) {
                Some(inner) => flat.extend_from_slice(inner),
                None => flat.push(operand),
            }
        }
        flat
    }

    pub(crate) fn primitive(primitive: Primitive) -> Self {
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

    /// A closed polyhedron, which need not be convex: corners, and faces as corner indices,
    /// counter-clockwise seen from outside. All faces the wrong way round are turned.
    ///
    /// Of a few hundred planar faces every plane is exact; others become triangles.
    ///
    /// # Errors
    /// An index is out of range, a coordinate is not finite, or the faces do not enclose a volume:
    /// each edge must be shared by two faces, in opposite directions.
    pub fn polyhedron(vertices: &[DVec3], faces: &[Vec<u32>]) -> Result<Self, ShapeError> {
        let mut mesh = polyhedron::triangulated(vertices.to_vec(), faces)?;
        let mut faces = faces.to_vec();
        if mesh.check_closed().is_ok() && mesh.is_inside_out() {
            mesh = mesh.reversed();
            faces.iter_mut().for_each(|face| face.reverse());
        }
        let solid = Self::mesh(Arc::new(mesh), MeshRule::Strict)?;
        Ok(Self::exact_polyhedron(vertices, &faces).unwrap_or(solid))
    }

    /// Like [`Solid::polyhedron`], with the exact plane of every face: for faces that are known to
    /// be closed and counter-clockwise seen from outside.
    ///
    /// # Errors
    /// The faces are not planar, or so many or so intricate that a mesh is the better
    /// representation.
    pub fn exact_polyhedron(vertices: &[DVec3], faces: &[Vec<u32>]) -> Result<Self, ShapeError> {
        if faces.len().saturating_mul(vertices.len()) <= CONVEX_TESTS
            && let Ok(convex) = ConvexPolyhedron::from_faces(vertices.to_vec(), faces)
        {
            return Ok(Self::convex(Arc::new(convex)));
        }
        let concave = polyhedron::polyhedron(vertices, faces)?;
        Ok(Self::primitive(Primitive::Composite(Arc::new(concave))))
    }

    /// A region of the xy plane drawn out along z, from `z0` to `z1`.
    ///
    /// # Errors
    /// A height is not finite, or `z1 - z0` is not positive.
    pub fn prism(region: &Region, z0: f64, z1: f64) -> Result<Self, ShapeError> {
        Self::tapered_prism(region, [z0, z1], [1.0, 1.0])
    }

    /// The solid whose section at height `z` is the region scaled about the z axis, by `scale[0]`
    /// at `z[0]` and `scale[1]` at `z[1]`, linearly in between: a pyramid where one of them is 0.
    ///
    /// # Errors
    /// A height is not finite, `z[1] - z[0]` is not positive, a scale is negative or not finite,
    /// both are 0, or they differ and the region has Bézier curves or edges that cross.
    pub fn tapered_prism(
        region: &Region,
        z: [f64; 2],
        scale: [f64; 2],
    ) -> Result<Self, ShapeError> {
        finite("z0", z[0])?;
        positive("height", z[1] - z[0])?;
        for value in scale {
            if finite("scale", value)? < 0.0 {
                return Err(ShapeError::NotPositive {
                    what: "scale",
                    value,
                });
            }
        }
        positive("largest scale", scale[0].max(scale[1]))?;
        let prism = profile::prism(region, z, scale)?;
        Ok(Self::primitive(Primitive::Composite(Arc::new(prism))))
    }

    /// A region turned about the z axis: its x is the distance from the axis, its y the height.
    ///
    /// # Errors
    /// A part of the region lies at negative x.
    pub fn lathe(region: &Region) -> Result<Self, ShapeError> {
        Self::turned_lathe(region, Turning::ROUND)
    }

    /// Like [`Solid::lathe`], but not all the way round, or in straight steps.
    ///
    /// # Errors
    /// Like [`Solid::lathe`]; the turn is not finite, not positive or more than 360 degrees; a step
    /// is 180 degrees or more, or the region has curves or edges that cross and is to turn in
    /// steps.
    pub fn turned_lathe(region: &Region, turning: Turning) -> Result<Self, ShapeError> {
        let lathe = profile::lathe(region, turning)?;
        Ok(Self::primitive(Primitive::Composite(Arc::new(lathe))))
    }

    /// The inside of a closed mesh: where its winding number is not 0.
    ///
    /// # Errors
    /// The mesh does not comply with `rule` ([`TriangleMesh::check_solid`]): the error says what is
    /// wrong and where.
    pub fn mesh(mesh: Arc<TriangleMesh>, rule: MeshRule) -> Result<Self, ShapeError> {
        mesh.check_solid(rule)?;
        Ok(Self::primitive(Primitive::Mesh(mesh)))
    }

    /// Points in any of the operands; of none, the empty solid.
    #[must_use]
    pub fn union(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut operands = Self::spliced(operands, |_, node| match node {
            SolidNode::Union(all) => Some(all),
            _ => None,
        });
        match operands.len() {
            0 => Self::empty(),
            1 => operands.swap_remove(0),
            _ => SolidNode::Union(operands).into(),
        }
    }

    /// Points in all operands; of none, the empty solid (as in OpenSCAD and POV-Ray).
    #[must_use]
    pub fn intersection(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut operands = Self::spliced(operands, |_, node| match node {
            SolidNode::Intersection(all) => Some(all),
            _ => None,
        });
        match operands.len() {
            0 => Self::empty(),
            1 => operands.swap_remove(0),
            _ => SolidNode::Intersection(operands).into(),
        }
    }

    /// Points in the first operand and in none of the others; of none, the empty solid.
    #[must_use]
    pub fn difference(operands: impl IntoIterator<Item = Self>) -> Self {
        let mut operands = Self::spliced(operands, |index, node| match node {
            SolidNode::Difference(all) if index == 0 => Some(all),
            _ => None,
        });
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
        self.enclosure_in(world_from_here, 0.0)
    }

    /// Like [`Solid::bounds_in`], but operands whose boxes are apart by up to `slack` still have an
    /// intersection: where rounding moves boundaries by less, it cannot leave the box.
    #[must_use]
    pub fn enclosure_in(&self, world_from_here: &DAffine3, slack: f64) -> Aabb {
        let of = |solid: &Self| solid.enclosure_in(world_from_here, slack);
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
            } => child.enclosure_in(&(*world_from_here * *parent_from_child), slack),
            SolidNode::WithMaterial { child, .. } => of(child),
            SolidNode::Union(solids) => solids.iter().map(of).fold(Aabb::EMPTY, Aabb::union),
            SolidNode::Intersection(solids) => {
                let common = solids.iter().map(of).fold(Aabb::ALL, Aabb::intersection);
                if common.inflated(0.5 * slack).is_empty() {
                    Aabb::EMPTY
                } else {
                    Aabb::new(common.min.min(common.max), common.max.max(common.min))
                }
            }
            SolidNode::Difference(solids) => solids.first().map_or(Aabb::EMPTY, of),
            SolidNode::Complement(_) => Aabb::ALL,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_of_operations_stay_flat() {
        let ball = Solid::sphere(1.0).expect("valid");
        let sum = (0..5000).fold(Solid::empty(), |sum, _| Solid::union([sum, ball.clone()]));
        assert!(sum.check_size().is_ok());
        assert_eq!(sum.operands(), 5000);
    }

    #[test]
    fn deep_and_exponential_trees_are_refused_and_dropped_without_recursion() {
        let ball = Solid::sphere(1.0).expect("valid");
        let mut deep = ball.clone();
        for _ in 0..200_000 {
            deep = deep.complement();
        }
        assert!(matches!(deep.check_size(), Err(ShapeError::TooDeep(_))));
        let mut wide = ball;
        for _ in 0..60 {
            let moved = wide.translate(DVec3::X).expect("finite");
            wide = Solid::intersection([wide.complement(), moved]);
        }
        assert!(matches!(
            wide.check_size(),
            Err(ShapeError::TooManyOperands(_))
        ));
    }
}
