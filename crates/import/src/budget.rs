//! How much one import may make out of a few numbers.

use crate::{Diagnostics, Span};

/// A face with its corners, here and in what a world builds of it.
const BYTES_PER_FACE: u64 = 256;

/// What is left of [`crate::Options::memory_budget`].
#[derive(Debug)]
pub(crate) struct Budget {
    left: u64,
    all: u64,
    exhausted: bool,
}

impl Budget {
    pub(crate) const fn new(bytes: u64) -> Self {
        Self {
            left: bytes,
            all: bytes,
            exhausted: false,
        }
    }

    /// Takes the memory of a piece of a mesh; `false` from when there is not enough.
    pub(crate) const fn take(&mut self, bytes: usize) -> bool {
        self.exhausted |= bytes as u64 > self.left;
        self.left = self.left.saturating_sub(bytes as u64);
        !self.exhausted
    }

    /// Takes the memory of so many more entries of a list at once, so that they need not be moved as
    /// they become more; exhausted where there is not so much.
    pub(crate) fn reserve<T>(&mut self, list: &mut Vec<T>, more: u64) {
        let bytes = (size_of::<T>() as u64).saturating_mul(more);
        if self.take(usize::try_from(bytes).unwrap_or(usize::MAX)) {
            self.exhausted |= list.try_reserve_exact(more as usize).is_err();
        }
    }

    /// Whether [`Budget::take`] has failed.
    pub(crate) const fn is_exhausted(&self) -> bool {
        self.exhausted
    }

    /// Reports that a mesh is too large, if it is.
    pub(crate) fn report(&self, diagnostics: &mut Diagnostics) {
        if self.exhausted {
            let message = format!(
                "the mesh does not fit into the memory budget of {} MiB",
                self.all >> 20
            );
            diagnostics.error(None, message);
        }
    }

    /// Takes the memory of this many faces, or reports that there is not enough.
    pub(crate) fn take_faces(
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
