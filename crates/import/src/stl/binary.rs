//! Binary STL: 80 bytes of anything, a 32-bit count, and 50 bytes per triangle, little-endian:
//! normal, three corners (12 floats) and 16 bits that mean different things to different programs.

use octray_math::DVec3;

use super::{BYTES_PER_TRIANGLE, Part};
use crate::Diagnostics;
use crate::budget::Budget;

const HEADER: usize = 84;
const RECORD: usize = 50;

/// How many triangles the header announces.
pub(super) fn announced(bytes: &[u8]) -> Option<u32> {
    let count = bytes.get(80..HEADER)?;
    Some(u32::from_le_bytes(count.try_into().ok()?))
}

/// The length of a file with this many triangles.
pub(super) const fn length(triangles: u32) -> u64 {
    HEADER as u64 + RECORD as u64 * triangles as u64
}

pub(super) fn read(bytes: &[u8], budget: &mut Budget, diagnostics: &mut Diagnostics) -> Vec<Part> {
    let Some(count) = announced(bytes) else {
        diagnostics.error(
            None,
            format!(
                "the file ends after {} bytes; the header of a binary STL file has {HEADER}",
                bytes.len()
            ),
        );
        return Vec::new();
    };
    let records = &bytes[HEADER..];
    if (bytes.len() as u64) < length(count) {
        diagnostics.error(
            None,
            format!(
                "the header announces {count} triangles ({} bytes), but the file ends at byte {}, \
                 after {} triangles",
                length(count),
                bytes.len(),
                records.len() / RECORD
            ),
        );
        return Vec::new();
    }
    if (bytes.len() as u64) > length(count) {
        diagnostics.warning(
            None,
            format!(
                "{} bytes after the last of {count} triangles are passed over",
                bytes.len() as u64 - length(count)
            ),
        );
    }
    let mut part = Part::default();
    for (index, record) in records
        .chunks_exact(RECORD)
        .take(count as usize)
        .enumerate()
    {
        let mut numbers = record.chunks_exact(4).skip(3).map(|b| {
            // chunks_exact(4) gives four bytes.
            f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        });
        let mut next = || numbers.next().unwrap_or(f64::NAN);
        let corners: [DVec3; 3] = std::array::from_fn(|_| DVec3::new(next(), next(), next()));
        if let Some(corner) = corners.iter().position(|p| !p.is_finite()) {
            let p = corners[corner];
            let byte = HEADER + RECORD * index + 12 + 12 * corner;
            diagnostics.error(
                None,
                format!(
                    "at byte {byte}: corner {} of triangle {} is not finite: ({}, {}, {})",
                    corner + 1,
                    index + 1,
                    p.x,
                    p.y,
                    p.z
                ),
            );
            continue;
        }
        if !budget.take(BYTES_PER_TRIANGLE) {
            break;
        }
        part.add(corners);
    }
    if part.triangles.is_empty() {
        return Vec::new();
    }
    vec![part]
}
