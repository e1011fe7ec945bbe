//! The primitives of a scene one by one, for octrees that are built over them.

use std::ops::Range;

use octray_math::DAffine3;

use super::lower::Lowered;
use crate::Primitive;

/// One occurrence of a primitive in the solids of a scene.
///
/// Where no boundary of it passes, all of its faces may be taken for one constant: whether the
/// primitive holds the place, or the opposite if it is complemented.
#[derive(Clone, Debug)]
pub struct Operand {
    /// The solid in its own frame.
    pub primitive: Primitive,
    /// Where it is; invertible.
    pub scene_from_local: DAffine3,
    /// The ids of its faces.
    pub faces: Range<u32>,
    /// Whether the expression wants its outside.
    pub complemented: bool,
    /// What the expression wants, by itself.
    pub expression: Lowered,
}
