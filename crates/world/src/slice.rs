//! Slices of rays: the nearest surface on each, or whether light comes through; what they cost, all
//! together or one by one.

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
            if self.solids.has_beams() {
                self.answer_in_beams(queries, scratch, &mut account, |line, scratch, counters| {
                    hits.push(line.map_or(Hit::MISS, |line| {
                        self.closest_on_line(line, scratch, counters)
                    }));
                });
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
        self.occluded_on_account(queries, blocked, Account::Sum(counters));
    }

    /// The same with the costs of each ray in `costs`, which is cleared first.
    pub fn occluded_with_costs(
        &self,
        queries: &[RayQuery],
        blocked: &mut Vec<bool>,
        costs: &mut Vec<Counters>,
    ) {
        self.occluded_on_account(queries, blocked, Account::each(costs, queries.len()));
    }

    fn occluded_on_account(
        &self,
        queries: &[RayQuery],
        blocked: &mut Vec<bool>,
        mut account: Account<'_>,
    ) {
        blocked.clear();
        let stops = |face| self.blocks(face);
        self.scratch.with(|scratch| {
            if self.solids.has_beams() {
                self.answer_in_beams(queries, scratch, &mut account, |line, scratch, counters| {
                    blocked.push(
                        line.is_some_and(|line| {
                            self.line_meets_any(&line, &stops, scratch, counters)
                        }),
                    );
                });
                return;
            }
            blocked.extend(queries.iter().enumerate().map(|(index, query)| {
                let counters = account.of(index);
                counters.rays += 1;
                self.meets_any(query, &stops, scratch, counters)
            }));
        });
    }
}
