//! How much a mesh holds, and which side of it is out.

use super::{CornerAttribute, TriangleMesh};

impl TriangleMesh {
    /// The volume inside a closed mesh: the sum of the signed tetrahedra between a fixed point and
    /// the triangles (Gauss). Negative if the fronts of the triangles face inwards; where shells
    /// overlap, space counts once for each.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        let (volume, size) = self.relative_volume();
        volume * size * size * size
    }

    /// Whether the fronts of a closed mesh's triangles face inwards on the whole.
    #[must_use]
    pub fn is_inside_out(&self) -> bool {
        self.relative_volume().0 < 0.0
    }

    /// The volume in units of the cube of half the longest side of the bounds, and that length:
    /// so no product leaves the range, and a fixed point near by loses few digits.
    fn relative_volume(&self) -> (f64, f64) {
        let bounds = self.bounds();
        let (center, size) = (bounds.center(), bounds.half_size().max_element());
        if bounds.is_empty() || size == 0.0 {
            return (0.0, 0.0);
        }
        let six_volumes = (0..self.triangles().len() as u32).map(|triangle| {
            let [a, b, c] = self.corners(triangle).map(|p| (p - center) / size);
            a.dot(b.cross(c))
        });
        (six_volumes.sum::<f64>() / 6.0, size)
    }

    /// The same triangles with front and back exchanged. Shading normals stay.
    #[must_use]
    pub fn reversed(&self) -> Self {
        fn flipped<T: Clone>(of: &CornerAttribute<T>) -> CornerAttribute<T> {
            CornerAttribute {
                values: of.values.clone(),
                triangles: of.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
            }
        }
        Self {
            positions: self.positions.clone(),
            triangles: self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
            normals: self.normals.as_ref().map(flipped),
            texcoords: self.texcoords.as_ref().map(flipped),
            materials: self.materials.clone(),
        }
    }
}
