//! What rays cost, pixel by pixel.

use octray_math::DVec3;
use octray_world::{Counters, Hit, RayQuery, World};

use crate::film::MAX_CONTRIBUTION;
use crate::stats::RenderStats;
use crate::tile::{OfPixel, TileFilm};

/// The colour of a cost picture that so much work makes: red counts steps (cells and copies entered,
/// nodes and look-ups), green surfaces intersected, blue triangles intersected.
#[must_use]
pub fn cost_channels(cost: &Counters) -> DVec3 {
    let steps = cost.cells + cost.nodes + cost.lookups + cost.instances;
    DVec3::new(
        steps as f64,
        cost.surface_tests as f64,
        cost.triangle_tests as f64,
    )
}

/// Asks the world for rays that belong to pixels; with a film, counts there what each one cost.
#[derive(Debug, Default)]
pub struct Ledger {
    film: Option<TileFilm>,
    costs: Vec<Counters>,
}

impl Ledger {
    /// Costs of pixels go to this film.
    pub(crate) const fn for_film(film: Option<TileFilm>) -> Self {
        Self {
            film,
            costs: Vec::new(),
        }
    }

    /// The film, if there is one.
    pub(crate) fn into_film(self) -> Option<TileFilm> {
        self.film
    }

    /// [`World::closest`], on the account of the pixels of `states`; returns what all cost
    /// together.
    pub(crate) fn closest<'a, S: OfPixel + 'a>(
        &mut self,
        world: &World,
        queries: &[RayQuery],
        states: impl Iterator<Item = &'a S>,
        hits: &mut Vec<Hit>,
        stats: &mut RenderStats,
    ) -> Counters {
        let mut sum = Counters::default();
        if self.film.is_none() {
            world.closest(queries, hits, &mut sum);
            return sum;
        }
        world.closest_with_costs(queries, hits, &mut self.costs);
        self.charge(states, stats)
    }

    /// [`World::occluded`] likewise.
    pub(crate) fn occluded<'a, S: OfPixel + 'a>(
        &mut self,
        world: &World,
        queries: &[RayQuery],
        states: impl Iterator<Item = &'a S>,
        blocked: &mut Vec<bool>,
        stats: &mut RenderStats,
    ) -> Counters {
        let mut sum = Counters::default();
        if self.film.is_none() {
            world.occluded(queries, blocked, &mut sum);
            return sum;
        }
        world.occluded_with_costs(queries, blocked, &mut self.costs);
        self.charge(states, stats)
    }

    /// Adds the costs to the pixels of `states`, and up.
    fn charge<'a, S: OfPixel + 'a>(
        &mut self,
        states: impl Iterator<Item = &'a S>,
        stats: &mut RenderStats,
    ) -> Counters {
        let mut sum = Counters::default();
        for (state, cost) in states.zip(&self.costs) {
            sum += *cost;
            let Some(film) = &mut self.film else {
                continue;
            };
            // Larger sums than one contribution may have are added in several.
            let mut left = cost_channels(cost);
            while left != DVec3::ZERO {
                let part = left.min(DVec3::splat(MAX_CONTRIBUTION));
                film.add(state, part, stats);
                left -= part;
            }
        }
        sum
    }
}
