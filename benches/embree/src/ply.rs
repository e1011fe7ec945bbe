//! Meshes as PLY files, for programs that cannot make them.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::meshes::Subject;

/// Writes `NAME.ply` into the folder, binary.
pub fn write(folder: &Path, subject: &Subject) -> io::Result<()> {
    let file = std::fs::File::create(folder.join(format!("{}.ply", subject.name)))?;
    let mut file = BufWriter::new(file);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n\
         property float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        subject.positions.len(),
        subject.triangles.len(),
    )?;
    for coordinate in subject.positions.as_flattened() {
        file.write_all(&coordinate.to_le_bytes())?;
    }
    for triangle in &subject.triangles {
        file.write_all(&[3])?;
        for corner in triangle {
            file.write_all(&corner.to_le_bytes())?;
        }
    }
    file.flush()
}
