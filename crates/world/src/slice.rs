//! Slices of rays: the nearest surface on each, or whether light comes through; what they cost, all
//! together or one by one.

use octray_geometry::FaceId;

use crate::{Counters, Hit, RayQuery, World};

/// Where costs are counted.
pub(crate) enum Account<'a> {
    /// All rays together.
    Sum(&'a mut Counters),
    /// Every ray for itself.
    Each(&'a mut [Counters]),
}

impl Account<'_> {
    /// Where the costs of one of the slice's rays are counted.
    pub(crate) fn of(&mut self, index: usize) -> &mut Counters {
        match self {
            Self::Sum(counters) => counters,
            Self::Each(counters) => &mut counters[index],
        }
    }

    /// An account of its own for each of so many rays, nothing counted yet.
    fn each(costs: &mut Vec<Counters>, rays: usize) -> Account<'_> {
        costs.clear();
        costs.resize(rays, Counters::default());
        Account::Each(costs)
    }
}

impl World {
    /// The nearest surface on each ray; `hits` is cleared and gets one hit per query.
    ///
    /// A ray that is not finite or has no direction meets nothing.
    pub fn closest(&self, queries: &[RayQuery], hits: &mut Vec<Hit>, counters: &mut Counters) {
        self.closest_on_account(queries, hits, Account::Sum(counters));
    }

    /// The same with the costs of each ray in `costs`, which is cleared first: they add up to what
    /// [`World::closest`] counts.
    pub fn closest_with_costs(
        &self,
        queries: &[RayQuery],
        hits: &mut Vec<Hit>,
        costs: &mut Vec<Counters>,
    ) {
        self.closest_on_account(queries, hits, Account::each(costs, queries.len()));
    }

    fn closest_on_account(
        &self,
        queries: &[RayQuery],
        hits: &mut Vec<Hit>,
        mut account: Account<'_>,
    ) {
        hits.clear();
        self.scratch.with(|scratch| {
            if self.has_beams() {
                hits.resize(queries.len(), Hit::MISS);
                self.answer_in_beams(
                    queries,
                    scratch,
                    &mut account,
                    |index, line, scratch, counters| {
                        hits[index] = self.closest_on_line(*line, scratch, counters);
                    },
                );
                return;
            }
            if self.has_triangle_slices() {
                self.closest_by_triangles(queries, scratch, &mut account, hits);
                return;
            }
            hits.extend(queries.iter().enumerate().map(|(index, query)| {
                let counters = account.of(index);
                counters.rays += 1;
                self.closest_one(query, scratch, counters)
            }));
        });
    }

    /// Whether a surface that no light passes, of an object that casts shadows, lies on each ray;
    /// `blocked` is cleared and gets one answer per query.
    pub fn occluded(&self, queries: &[RayQuery], blocked: &mut Vec<bool>, counters: &mut Counters) {
        self.meets_on_account(
            queries,
            &|face| self.blocks(face),
            blocked,
            Account::Sum(counters),
        );
    }

    /// The same with the costs of each ray in `costs`, which is cleared first.
    pub fn occluded_with_costs(
        &self,
        queries: &[RayQuery],
        blocked: &mut Vec<bool>,
        costs: &mut Vec<Counters>,
    ) {
        let account = Account::each(costs, queries.len());
        self.meets_on_account(queries, &|face| self.blocks(face), blocked, account);
    }

    /// Whether any of the faces that count lies on each ray.
    pub(crate) fn meets_on_account(
        &self,
        queries: &[RayQuery],
        counts: &impl Fn(FaceId) -> bool,
        blocked: &mut Vec<bool>,
        mut account: Account<'_>,
    ) {
        blocked.clear();
        self.scratch.with(|scratch| {
            if self.has_beams() {
                blocked.resize(queries.len(), false);
                self.answer_in_beams(
                    queries,
                    scratch,
                    &mut account,
                    |index, line, scratch, counters| {
                        blocked[index] = self.line_meets_any(line, counts, scratch, counters);
                    },
                );
                return;
            }
            if self.has_triangle_slices() {
                self.meets_by_triangles(queries, counts, scratch, &mut account, blocked);
                return;
            }
            blocked.extend(queries.iter().enumerate().map(|(index, query)| {
                let counters = account.of(index);
                counters.rays += 1;
                self.meets_any(query, counts, scratch, counters)
            }));
        });
    }
}
