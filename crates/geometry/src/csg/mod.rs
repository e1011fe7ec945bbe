//! Set operations as boolean expressions over sides of surfaces.
//!
//! A box is not an operand here but the conjunction of six sides; a difference is a conjunction
//! with complements; after De Morgan nothing is left but *and*, *or* and [`Face`]s. That is what
//! lets an octree cell forget every *face* that does not matter in it, not only every operand, and
//! what makes coincident faces one variable: at a parameter where some surfaces are crossed, all
//! of them change at once, and there is a boundary only where the expression changes.

mod code;
mod facets;
mod lower;
mod operand;
mod plane_index;
mod sides;

pub use code::{
    Code, Constant, Term, changed_face, evaluate, faces, flat, operands, reduce, term, truth_on,
};
pub use lower::{Face, Lowered, LoweredScene, Lowering, MeshOperand};
pub use operand::Operand;
