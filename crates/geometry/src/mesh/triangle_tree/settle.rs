//! Exact tests that were put off until the walks of a slice's lines were over, eight at a time.
//!
//! By then most triangles have been overtaken, and the corners of those that are left are fetched for many
//! lines at once instead of being waited for one after the other.

use octray_kernels::crossings::PAIRS;
use octray_kernels::{Crossings, Kernels, Pairs};
use octray_tree::wide_tree::BEAM;

use super::TriangleRay;
use super::divide::Triangles;
use super::nearest::{NearestTriangle, TriangleQuery};

/// A query and a triangle that may be its nearest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Undecided {
    pub(super) query: u32,
    pub(super) triangle: u32,
}

/// The nearest triangles of the queries of a slice, and what is still to be decided.
#[derive(Clone, Debug)]
pub(super) struct Settlement {
    pub(super) best: [Option<NearestTriangle>; BEAM],
    pub(super) undecided: Vec<Undecided>,
    /// Whether a walk ended because of a triangle that is undecided.
    pub(super) is_early: [bool; BEAM],
    pub(super) met: [bool; BEAM],
    pairs: Pairs,
    found: Crossings,
}

impl Default for Settlement {
    fn default() -> Self {
        Self {
            best: [None; BEAM],
            undecided: Vec::new(),
            is_early: [false; BEAM],
            met: [false; BEAM],
            pairs: Pairs::default(),
            found: Crossings::default(),
        }
    }
}

impl Settlement {
    /// Nothing is known about so many queries.
    pub(super) fn clear(&mut self, queries: usize) {
        self.best[..queries].fill(None);
        self.is_early[..queries].fill(false);
        self.met[..queries].fill(false);
        self.undecided.clear();
    }

    /// Decides which triangles are the nearest.
    #[inline(always)]
    pub(super) fn settle(
        &mut self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
    ) {
        let mut best = self.best;
        self.each(kernels, exact, queries, |query, nearest| {
            let known = &mut best[query % BEAM];
            if nearest.is_before(known.as_ref()) && !queries[query].leaves(nearest.triangle, &exact)
            {
                *known = Some(nearest);
            }
        });
        self.best = best;
    }

    /// Shows `visit` the crossings with undecided triangles that count by their parameter, with the
    /// query's index. Nothing is undecided then.
    #[inline(always)]
    pub(super) fn each(
        &mut self,
        kernels: impl Kernels,
        exact: Triangles<'_>,
        queries: &[TriangleQuery],
        mut visit: impl FnMut(usize, NearestTriangle),
    ) {
        let Self {
            undecided,
            pairs,
            found,
            ..
        } = self;
        for some in undecided.chunks(PAIRS) {
            for (lane, one) in some.iter().enumerate() {
                let ray = &queries[one.query as usize].ray;
                let corners = exact.corners(one.triangle);
                let axes = TriangleRay::axes(ray.direction);
                for (place, axis) in axes.into_iter().enumerate() {
                    pairs.origins[place][lane] = ray.origin[axis];
                    pairs.directions[place][lane] = ray.direction[axis];
                    for (corner, point) in corners.iter().enumerate() {
                        pairs.corners[corner][place][lane] = point[axis];
                    }
                }
            }
            kernels.cross(pairs, found);
            for (lane, one) in some.iter().enumerate() {
                let query = &queries[one.query as usize];
                let bit = |mask: u32| mask >> lane & 1 != 0;
                let (t, entering) = if bit(found.decided) {
                    if !bit(found.crossed) {
                        continue;
                    }
                    (found.t[lane & (PAIRS - 1)], !bit(found.leaving))
                } else {
                    let line = TriangleRay::new(&query.ray);
                    let Some(hit) = line.intersect(exact.corners(one.triangle)) else {
                        continue;
                    };
                    (hit.t, hit.entering)
                };
                if query.counts(t) {
                    let nearest = NearestTriangle {
                        t,
                        triangle: one.triangle,
                        entering,
                    };
                    visit(one.query as usize, nearest);
                }
            }
        }
        undecided.clear();
    }
}
