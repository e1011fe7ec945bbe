//! What is the same as what: the names that survive every accelerator and every machine.

/// A canonical surface: two coincident planes of different operands are one `SurfaceId`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SurfaceId(pub u32);

/// One face of one operand (or one triangle of one mesh) of the world, unique.
///
/// It leads to the object and the material it belongs to, and to its [`SurfaceId`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FaceId(pub u32);

impl FaceId {
    /// No face: the start of a ray in empty space.
    pub const NONE: Self = Self(u32::MAX);
}

/// The index of a material in the scene; geometry only carries it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialId(pub u32);
