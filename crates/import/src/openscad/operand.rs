//! Set operations as OpenSCAD does them with operands that are missing, flat or empty.

use std::sync::Arc;

use octray_geometry::{Solid, SolidNode, TriangleMesh};
use octray_math::DAffine3;

use crate::Span;

/// What a statement came to.
#[derive(Debug)]
pub(super) enum Operand {
    /// Switched off: as if it were not written.
    Absent,
    /// Flat where solids are needed, or solid where something flat is: OpenSCAD leaves it out.
    OfOtherDimension,
    /// Not supported, and reported: its shape is not known.
    Unknown,
    /// Faces that enclose nothing.
    Open(OpenFaces),
    /// Has an inside.
    Solid(Part),
}

/// The faces of a `polyhedron` that is not closed.
#[derive(Debug)]
pub(super) struct OpenFaces {
    pub(super) mesh: Arc<TriangleMesh>,
    pub(super) place: DAffine3,
    pub(super) why: String,
    pub(super) span: Span,
}

/// A solid with the number of nodes below each other in it, or more.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) solid: Solid,
    pub(super) depth: u32,
}

impl Part {
    pub(super) const fn leaf(solid: Solid) -> Self {
        Self { solid, depth: 1 }
    }

    pub(super) fn is_empty(&self) -> bool {
        matches!(self.solid.node(), SolidNode::Empty)
    }
}

/// The operations that combine solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Union,
    Intersection,
    Difference,
}

impl Operation {
    /// For messages.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
        }
    }

    /// Combines the operands. `lose` is told of open faces that cannot take part.
    ///
    /// As in OpenSCAD, an operand without points makes an intersection empty, and a difference if
    /// it is the first. What is of the other dimension takes no part. Of what is not known, nothing is taken away,
    /// and nothing is limited by it.
    pub(super) fn combine(
        self,
        operands: Vec<Operand>,
        lose: &mut impl FnMut(OpenFaces),
    ) -> Operand {
        let mut present: Vec<Operand> = operands
            .into_iter()
            .filter(|operand| !matches!(operand, Operand::Absent))
            .collect();
        if present.len() == 1 {
            return present.swap_remove(0);
        }
        let had_any = !present.is_empty();
        present.retain(|operand| !matches!(operand, Operand::OfOtherDimension));
        if had_any && present.is_empty() {
            return Operand::OfOtherDimension;
        }
        let first_is_solid = matches!(present.first(), Some(Operand::Solid(_)));
        let mut unknown = false;
        let mut parts = Vec::with_capacity(present.len());
        for operand in present {
            match operand {
                Operand::Solid(part) => parts.push(part),
                Operand::Open(faces) => {
                    lose(faces);
                    unknown = true;
                }
                _ => unknown = true,
            }
        }
        if unknown && (parts.is_empty() || (self == Self::Difference && !first_is_solid)) {
            return Operand::Unknown;
        }
        Operand::Solid(self.of_solids(parts))
    }

    fn of_solids(self, parts: Vec<Part>) -> Part {
        let empty = match self {
            Self::Union => parts.iter().all(Part::is_empty),
            Self::Intersection => parts.is_empty() || parts.iter().any(Part::is_empty),
            Self::Difference => parts.first().is_none_or(Part::is_empty),
        };
        if empty {
            return Part::leaf(Solid::empty());
        }
        let mut depth = 1;
        let mut solids = Vec::with_capacity(parts.len());
        for (index, part) in parts.into_iter().enumerate() {
            // (a + b) + c = a + b + c, likewise for intersections; (a - b) - c = a - b - c;
            // a - (b + c) = a - b - c.
            let nested = match (part.solid.node(), self) {
                (SolidNode::Empty, _) => continue,
                (SolidNode::Union(nested), Self::Union)
                | (SolidNode::Intersection(nested), Self::Intersection) => Some(nested),
                (SolidNode::Difference(nested), Self::Difference) if index == 0 => Some(nested),
                (SolidNode::Union(nested), Self::Difference) if index > 0 => Some(nested),
                _ => None,
            };
            if let Some(nested) = nested {
                solids.extend(nested.iter().cloned());
                depth = depth.max(part.depth);
            } else {
                depth = depth.max(part.depth + 1);
                solids.push(part.solid);
            }
        }
        let solid = match self {
            Self::Union => Solid::union(solids),
            Self::Intersection => Solid::intersection(solids),
            Self::Difference => Solid::difference(solids),
        };
        Part { solid, depth }
    }
}
