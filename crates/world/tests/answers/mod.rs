//! Everything that a world answers about some rays.

use octray_math::{DVec3, Ray};
use octray_world::{Chord, Counters, Hit, Method, Overlaps, RayQuery, Region, World};

/// Every method, and grids of other sizes.
pub(crate) fn methods() -> Vec<Method> {
    let grids = ["grid:1", "grid:3", "grid:40"].map(|name| name.parse().expect("a grid"));
    Method::all().into_iter().chain(grids).collect()
}

/// All answers of a world.
#[derive(Debug, PartialEq)]
pub(crate) struct Answers {
    pub(crate) closest: Vec<Hit>,
    pub(crate) occluded: Vec<bool>,
    /// Whether the surfaces that were met see a lamp at a point.
    pub(crate) dark: Vec<bool>,
    pub(crate) crossings: Vec<Vec<Hit>>,
    pub(crate) chords: Vec<Vec<Chord>>,
    pub(crate) regions: Vec<Region>,
}

const LAMP: DVec3 = DVec3::new(3.0, -2.0, 4.0);

pub(crate) fn answers(world: &World, rays: &[Ray]) -> Answers {
    let mut counters = Counters::default();
    let queries: Vec<RayQuery> = rays.iter().map(|ray| RayQuery::new(*ray)).collect();
    let (mut closest, mut occluded) = (Vec::new(), Vec::new());
    world.closest(&queries, &mut closest, &mut counters);
    // Secondary rays, from the surfaces that were found.
    let departing: Vec<RayQuery> = queries
        .iter()
        .zip(&closest)
        .filter(|(_, hit)| !hit.is_miss())
        .map(|(query, hit)| {
            let surface = world.interact(query, hit);
            RayQuery {
                ray: Ray::new(surface.position, surface.normal),
                departure: hit.departure(true),
                ..*query
            }
        })
        .collect();
    world.occluded(&departing, &mut occluded, &mut counters);
    // To a lamp, on whichever side of the surface it is; `departing` goes along the normal.
    let to_lamp: Vec<RayQuery> = departing
        .iter()
        .map(|query| {
            let ray = Ray::new(query.ray.origin, LAMP - query.ray.origin);
            let mut departure = query.departure;
            departure.outward = ray.direction.dot(query.ray.direction) > 0.0;
            RayQuery {
                ray,
                t_max: 1.0,
                departure,
            }
        })
        .collect();
    let mut dark = Vec::new();
    world.occluded(&to_lamp, &mut dark, &mut counters);
    let mut next = Vec::new();
    world.closest(&departing, &mut next, &mut counters);
    closest.extend(next);
    let lists = |query: &RayQuery| {
        let (mut hits, mut chords) = (Vec::new(), Vec::new());
        world.crossings(query, true, &mut hits, &mut Counters::default());
        world.chords(
            query,
            true,
            Overlaps::Objects,
            &mut chords,
            &mut Counters::default(),
        );
        (hits, chords)
    };
    let (crossings, chords) = queries.iter().map(lists).unzip();
    let points: Vec<DVec3> = rays.iter().map(|ray| ray.origin).collect();
    let mut regions = Vec::new();
    world.regions(&points, &mut regions, &mut counters);
    Answers {
        closest,
        occluded,
        dark,
        crossings,
        chords,
        regions,
    }
}

/// Rays at, past and along what lies about `center`.
pub(crate) fn rays_about(center: DVec3, size: f64) -> Vec<Ray> {
    let mut rays = Vec::new();
    for i in -3..=3_i32 {
        for j in -3..=3_i32 {
            let aside = DVec3::new(f64::from(i) * 0.3, f64::from(j) * 0.3, 0.0) * size;
            let from = center + DVec3::new(0.0, 0.0, -5.0 * size);
            rays.push(Ray::new(from + aside, DVec3::Z));
            rays.push(Ray::new(from, DVec3::Z * 5.0 * size + aside));
            rays.push(Ray::new(center + aside, DVec3::new(1.0, 0.1, -0.2)));
        }
    }
    rays
}
