//! Whitted's recursive ray tracing (1980), without recursion in the call stack.

use octray_math::{DVec3, Ray, hash_combine};
use octray_world::{Hit, SurfaceHit, World};

use super::Integrator;
use super::media::{medium_of, transmission};
use crate::Plan;
use crate::bsdf::{Scattering, WhittedSurface};
use crate::light::illuminate;
use crate::path::{PathState, Queues, RayKind, ShadowState, to_single};
use crate::stats::RenderStats;
use crate::tile::TileFilm;

/// At the nearest surface: its own light, for every lamp a shadow ray with Lambert's term and
/// highlights, one reflected and one transmitted ray.
#[derive(Clone, Copy, Debug)]
pub struct Whitted<'a> {
    world: &'a World,
    max_generations: u32,
    contribution_threshold: f64,
}

impl<'a> Whitted<'a> {
    /// For this world, with the limits of the plan.
    #[must_use]
    pub const fn new(world: &'a World, plan: &Plan) -> Self {
        Self {
            world,
            max_generations: plan.max_generations,
            contribution_threshold: plan.contribution_threshold,
        }
    }

    fn background(&self, state: &PathState, hit: &Hit) -> DVec3 {
        let scene = self.world.scene();
        let medium = medium_of(scene, hit.from);
        state.weight()
            * transmission(scene, medium, f64::INFINITY)
            * scene.background().at(state.direction)
    }

    fn surface(&self, state: &PathState, hit: &SurfaceHit) -> WhittedSurface<'a> {
        let material = self.world.scene().material(hit.material);
        let side = if hit.entering { 1.0 } else { -1.0 };
        WhittedSurface {
            finish: &material.finish,
            color: material.pigment.at(hit.position),
            normal: hit.normal * side,
            shading_normal: hit.shading_normal * side,
            direction: state.direction.normalize_or_zero(),
            ior_from: hit.ior_from,
            ior_to: hit.ior_to,
        }
    }

    fn spawn_shadows(
        &self,
        shading: &Shading<'_>,
        film: &mut TileFilm,
        out: &mut Queues,
        stats: &mut RenderStats,
    ) {
        let scene = self.world.scene();
        let at = shading.hit.position;
        for light in scene.lights() {
            let Some(arriving) = illuminate(light, at) else {
                continue;
            };
            let response = shading
                .surface
                .response(arriving.direction, light.makes_highlights);
            let light_seen = shading.weight * arriving.color * response;
            if light_seen == DVec3::ZERO {
                continue;
            }
            if !light.casts_shadows {
                film.add(shading.state, light_seen, stats);
                continue;
            }
            out.shadows.push(ShadowState::new(
                shading.state,
                Ray::new(at, arriving.to_light),
                arriving.is_finite,
                shading
                    .met
                    .departure(arriving.direction.dot(shading.hit.normal) > 0.0),
                medium_of(scene, shading.met.from),
                light_seen,
            ));
        }
    }

    fn spawn(
        &self,
        shading: &Shading<'_>,
        kind: RayKind,
        scattering: &Scattering,
        out: &mut Queues,
        stats: &mut RenderStats,
    ) {
        let throughput = shading.weight * scattering.weight;
        if shading.state.generation >= self.max_generations {
            stats.ended_by_generation += 1;
            return;
        }
        if throughput.abs().max_element() < self.contribution_threshold {
            stats.ended_by_contribution += 1;
            return;
        }
        // The mirrored ray stays on the viewer's side of the surface, the other one leaves it.
        let outward = (kind == RayKind::Reflected) == shading.hit.entering;
        out.paths.push(PathState {
            origin: shading.hit.position,
            direction: scattering.direction,
            key: hash_combine(shading.state.key, kind as u64),
            throughput: to_single(throughput),
            departure: shading.met.departure(outward),
            generation: shading.state.generation + 1,
            kind,
            ..*shading.state
        });
    }
}

/// One state, what it met, and what its light is worth there.
struct Shading<'a> {
    state: &'a PathState,
    met: &'a Hit,
    hit: SurfaceHit,
    surface: WhittedSurface<'a>,
    weight: DVec3,
}

impl Integrator for Whitted<'_> {
    fn shade(
        &self,
        states: &[PathState],
        hits: &[Hit],
        film: &mut TileFilm,
        queues: &mut Queues,
        stats: &mut RenderStats,
    ) {
        let scene = self.world.scene();
        for (state, met) in states.iter().zip(hits) {
            if met.is_miss() {
                film.add(state, self.background(state, met), stats);
                continue;
            }
            let hit = self.world.interact(&state.query(), met);
            let distance = met.t * state.direction.length();
            let shading = Shading {
                state,
                met,
                hit,
                surface: self.surface(state, &hit),
                weight: state.weight() * transmission(scene, hit.medium, distance),
            };
            let own = shading.surface.own_light(scene.settings().ambient_light);
            film.add(state, shading.weight * own, stats);
            self.spawn_shadows(&shading, film, queues, stats);
            let (reflected, transmitted) = shading.surface.scatter();
            if let Some(scattering) = reflected {
                self.spawn(&shading, RayKind::Reflected, &scattering, queues, stats);
            }
            if let Some(scattering) = transmitted {
                self.spawn(&shading, RayKind::Refracted, &scattering, queues, stats);
            }
        }
    }
}
