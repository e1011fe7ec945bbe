//! How much of a lamp's light comes through.

use octray_geometry::MaterialId;
use octray_math::DVec3;
use octray_world::{Hit, RayQuery, World};

use super::media::{medium_of, transmission};
use crate::cost::Ledger;
use crate::path::{ShadowState, to_vector};
use crate::stats::RenderStats;
use crate::tile::TileFilm;

/// Light that has not arrived after this many transparent surfaces does not arrive.
pub const MAX_INTERFACES: u32 = 1024;

/// Traces slices of shadow rays; keeps its buffers.
#[derive(Debug)]
pub struct ShadowTracer<'a> {
    world: &'a World,
    queries: Vec<RayQuery>,
    blocked: Vec<bool>,
    hits: Vec<Hit>,
    walks: Vec<Walk>,
}

/// A shadow ray that has come through everything up to its query's origin.
#[derive(Clone, Copy, Debug)]
struct Walk {
    state: usize,
    light: DVec3,
    medium: Option<MaterialId>,
}

impl<'a> ShadowTracer<'a> {
    /// For this world.
    #[must_use]
    pub const fn new(world: &'a World) -> Self {
        Self {
            world,
            queries: Vec::new(),
            blocked: Vec::new(),
            hits: Vec::new(),
            walks: Vec::new(),
        }
    }

    /// Adds the light of all `states` that arrives to the film.
    ///
    /// Opaque surfaces are looked for first, in any order. Light that meets none goes on from
    /// one transparent surface to the next, unbent, and is multiplied by each one's
    /// transmittance and by what the media between them leave. The ledger asks the world.
    pub fn trace(
        &mut self,
        states: &[ShadowState],
        film: &mut TileFilm,
        ledger: &mut Ledger,
        stats: &mut RenderStats,
    ) {
        stats.rays.shadow += states.len() as u64;
        self.queries.clear();
        self.queries.extend(states.iter().map(ShadowState::query));
        let cost = ledger.occluded(
            self.world,
            &self.queries,
            states.iter(),
            &mut self.blocked,
            stats,
        );
        stats.queries.shadow += cost;
        let open = (0..states.len()).filter(|i| !self.blocked[*i]);
        self.walks.clear();
        self.walks.extend(open.map(|i| Walk {
            state: i,
            light: to_vector(states[i].light),
            medium: states[i].medium(),
        }));
        stats.hits.shadow += (states.len() - self.walks.len()) as u64;
        if self.world.has_transparency() {
            let queries = self.walks.iter().map(|walk| states[walk.state].query());
            self.queries = queries.collect();
            for _ in 0..MAX_INTERFACES {
                if self.walks.is_empty() {
                    break;
                }
                self.step(states, film, ledger, stats);
            }
            stats.hits.shadow += self.walks.len() as u64;
        } else {
            for walk in &self.walks {
                film.add(&states[walk.state], walk.light, stats);
            }
        }
    }

    /// Takes every walk to its next surface, or to the lamp.
    fn step(
        &mut self,
        states: &[ShadowState],
        film: &mut TileFilm,
        ledger: &mut Ledger,
        stats: &mut RenderStats,
    ) {
        let walking = self.walks.iter().map(|walk| &states[walk.state]);
        let cost = ledger.closest(self.world, &self.queries, walking, &mut self.hits, stats);
        stats.queries.shadow += cost;
        let mut kept = 0;
        for index in 0..self.walks.len() {
            let (query, hit) = (self.queries[index], self.hits[index]);
            let mut walk = self.walks[index];
            if hit.is_miss() {
                let distance = query.t_max * query.ray.direction.length();
                walk.light *= transmission(self.world.scene(), walk.medium, distance);
                film.add(&states[walk.state], walk.light, stats);
                continue;
            }
            stats.shadow_interfaces += 1;
            walk.light *= self.passage(&query, &hit);
            if walk.light == DVec3::ZERO {
                stats.hits.shadow += 1;
                continue;
            }
            walk.medium = medium_of(self.world.scene(), hit.to);
            self.walks[kept] = walk;
            let mut onward = query;
            onward.ray.origin = query.ray.at(hit.t);
            onward.t_max = query.t_max - hit.t;
            onward.departure = hit.departure(!hit.entering);
            self.queries[kept] = onward;
            kept += 1;
        }
        self.walks.truncate(kept);
        self.queries.truncate(kept);
    }

    /// What the segment up to a surface and the surface leave of the light.
    fn passage(&self, query: &RayQuery, hit: &Hit) -> DVec3 {
        let scene = self.world.scene();
        let surface = self.world.interact(query, hit);
        let casts_shadow =
            |object: octray_scene::ObjectId| scene.objects()[object.0 as usize].casts_shadows;
        let mut left = DVec3::ONE;
        if hit.from.object().is_some_and(casts_shadow) {
            let distance = hit.t * query.ray.direction.length();
            left *= transmission(scene, surface.medium, distance);
        }
        if casts_shadow(surface.object) {
            let color = scene
                .material(surface.material)
                .pigment
                .at(surface.position);
            left *= color.transmittance();
        }
        left
    }
}
