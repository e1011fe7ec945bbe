//! How much one import may make out of a few numbers.

use crate::{Diagnostics, Span};

/// A face with its corners, here and in what a world builds of it.
const BYTES_PER_FACE: u64 = 256;

/// What is left of [`crate::Options::memory_budget`].
#[derive(Debug)]
pub(super) struct Budget {
    left: u64,
    all: u64,
}

impl Budget {
    pub(super) const fn new(bytes: u64) -> Self {
        Self {
            left: bytes,
            all: bytes,
        }
    }

    /// Takes the memory of this many faces, or reports that there is not enough.
    pub(super) fn take_faces(
        &mut self,
        faces: usize,
        span: Span,
        diagnostics: &mut Diagnostics,
    ) -> bool {
        let bytes = (faces as u64).saturating_mul(BYTES_PER_FACE);
        if bytes <= self.left {
            self.left -= bytes;
            return true;
        }
        let message = format!(
            "these {faces} faces do not fit into the memory budget of {} MiB",
            self.all >> 20
        );
        diagnostics.error(span, message);
        false
    }
}
