//! Bounded solids that are a formula over their own faces.

use octray_math::{Aabb, DAffine3, DVec3};

use crate::ShapeError;
use crate::boundary::FlatBoundary;
use crate::profile::{Formula, MAX_FORMULA_DEPTH};
use crate::surface::Canonical;

/// The most faces of one composite.
pub(crate) const MAX_FACES: usize = 1 << 24;

/// What a composite was made as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompositeKind {
    /// A region drawn out along z.
    Prism,
    /// A region turned about z.
    Lathe,
    /// A polyhedron that is not convex.
    Polyhedron,
}

/// A surface of a composite, with its inside, in the composite's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum CompositeFace {
    /// Inside is where `normal . (x - point) < 0`.
    Plane {
        /// Not zero, of any length.
        normal: DVec3,
        /// On the plane.
        point: DVec3,
    },
    /// Inside is the negative side.
    Curved {
        /// The surface in its own frame.
        canonical: Canonical,
        /// Maps that frame to the composite's; invertible.
        from_local: DAffine3,
    },
}

/// A bounded solid given as a formula over faces: what prisms, lathes and concave polyhedra are.
#[derive(Clone, Debug, PartialEq)]
pub struct Composite {
    kind: CompositeKind,
    faces: Vec<CompositeFace>,
    formula: Formula,
    bounds: Aabb,
    flat: Option<FlatBoundary>,
}

impl Composite {
    /// The solid where `formula` holds, whose side `i` is `faces[i]`; all of it lies in `bounds`.
    pub(crate) fn new(
        kind: CompositeKind,
        faces: Vec<CompositeFace>,
        formula: Formula,
        bounds: Aabb,
    ) -> Result<Self, ShapeError> {
        if faces.len() > MAX_FACES || formula.depth() > MAX_FORMULA_DEPTH {
            return Err(ShapeError::BadProfile("is too intricate"));
        }
        if !bounds.is_bounded() {
            return Err(ShapeError::BadProfile("is too large"));
        }
        Ok(Self {
            kind,
            faces,
            formula,
            bounds,
            flat: None,
        })
    }

    /// The same solid, knowing that its boundary consists of plane polygons.
    pub(crate) fn with_flat_boundary(self, flat: FlatBoundary) -> Self {
        Self {
            flat: Some(flat),
            ..self
        }
    }

    /// The plane polygons of its boundary, where there are no others.
    pub(crate) const fn flat(&self) -> Option<&FlatBoundary> {
        self.flat.as_ref()
    }

    /// What it was made as.
    #[must_use]
    pub const fn kind(&self) -> CompositeKind {
        self.kind
    }

    /// Its surfaces.
    #[must_use]
    pub fn faces(&self) -> &[CompositeFace] {
        &self.faces
    }

    /// Which points are inside, over the insides of [`Composite::faces`].
    #[must_use]
    pub const fn formula(&self) -> &Formula {
        &self.formula
    }

    /// A box around it.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }
}
