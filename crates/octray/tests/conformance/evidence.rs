//! What a world shows and answers, and where two differ.

use std::ops::Range;

use octray::math::{Aabb, DVec3, Ray, hash_combine, unit_f64};
use octray::render::{Film, RenderConfig, RenderError, Rendering, render};
use octray::world::{Chord, Counters, Hit, Method, Overlaps, RayQuery, Region, World, WorldConfig};
use rayon::prelude::*;

use crate::combination::Combination;
use crate::scenes::Specimen;

/// What is asked of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Questions {
    /// The size of the picture to render, with all the rays that shading spawns.
    pub(crate) picture: Option<(u32, u32)>,
    /// How many rays to ask.
    pub(crate) rays: u64,
    /// Whether brute force goes along each ray's whole line once only, where all is opaque: the
    /// nearest surface and whether there is one then follow from the list of all.
    pub(crate) one_pass: bool,
}

/// The answers about one ray.
#[derive(Clone, Debug, PartialEq)]
struct Answers {
    closest: Hit,
    occluded: bool,
    /// Of every eighth ray: from the surface that was found, back into the scene.
    next: Option<Hit>,
    crossings: Vec<Hit>,
    chords: Vec<Chord>,
    region: Region,
}

/// What a world shows and answers; or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Evidence {
    refusal: Option<String>,
    film: Option<Film>,
    answers: Vec<Answers>,
}

impl Evidence {
    /// Makes the world and asks it.
    pub(crate) fn of(specimen: &Specimen, config: &WorldConfig, questions: Questions) -> Self {
        match World::prepare(specimen.scene.clone(), config) {
            Err(error) => Self {
                refusal: Some(error.to_string()),
                film: None,
                answers: Vec::new(),
            },
            Ok(world) => Self {
                refusal: None,
                film: questions
                    .picture
                    .and_then(|size| picture(&world, size))
                    .map(|r| r.film),
                answers: answers(&world, questions.rays, {
                    let is_brute = config.method == Method::Brute;
                    is_brute && questions.one_pass && !world.has_transparency()
                }),
            },
        }
    }

    /// Pixels and rays.
    pub(crate) fn counts(&self) -> (u64, u64) {
        let pixels = self.film.as_ref().map_or(0, |film| pixels(film).count());
        (pixels as u64, self.answers.len() as u64)
    }

    /// The first difference from what brute force says.
    pub(crate) fn difference(&self, brute: &Self) -> Option<String> {
        if self == brute {
            return None;
        }
        if self.refusal != brute.refusal {
            return Some(format!("{:?}, not {:?}", self.refusal, brute.refusal));
        }
        if let (Some(film), Some(expected)) = (&self.film, &brute.film) {
            let differs = |&(x, y): &(u32, u32)| film.half_means(x, y) != expected.half_means(x, y);
            let mut all = pixels(film).filter(differs);
            if let Some((x, y)) = all.next() {
                return Some(format!(
                    "pixel ({x}, {y}) and {} more: {} instead of {}",
                    all.count(),
                    film.mean(x, y),
                    expected.mean(x, y)
                ));
            }
        }
        let pairs = self.answers.iter().zip(&brute.answers);
        let mut differing = pairs.enumerate().filter(|(_, (a, b))| a != b);
        let (ray, (found, expected)) = differing.next()?;
        let others = differing.count();
        Some(format!(
            "ray {ray} and {others} more: {found:#?}\ninstead of {expected:#?}"
        ))
    }
}

fn pixels(film: &Film) -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = (film.crop().width, film.crop().height);
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// `None` where there is nothing to aim a camera at.
fn picture(world: &World, size: (u32, u32)) -> Option<Rendering> {
    let config = RenderConfig {
        size: Some(size),
        ..RenderConfig::default()
    };
    let rendering = match render(world, None, &config, &()) {
        Err(RenderError::NoCamera) => return None,
        rendering => rendering.expect("a picture"),
    };
    assert!(rendering.is_complete());
    Some(rendering)
}

/// Intersection tests that brute force makes for a picture: the work that the scene is.
pub(crate) fn brute_force_tests(specimen: &Specimen, size: (u32, u32)) -> u64 {
    let config = Combination::BRUTE.config();
    let world = World::prepare(specimen.scene.clone(), &config);
    let rendering = world.ok().and_then(|world| picture(&world, size));
    rendering.map_or(0, |rendering| {
        let cost = rendering.stats.queries.total();
        cost.surface_tests + cost.triangle_tests
    })
}

/// The ray of this number about a scene: from around it or from within, towards points in it; every
/// fourth along an axis.
pub(crate) fn ray(bounds: &Aabb, number: u64) -> Ray {
    let bounds = if bounds.is_empty() || !bounds.is_bounded() {
        Aabb::new(DVec3::NEG_ONE, DVec3::ONE)
    } else {
        *bounds
    };
    let key = |what: u64| hash_combine(number, what);
    let unit = |what: u64| unit_f64(key(what));
    let vector = |what: u64| DVec3::new(unit(what), unit(what + 1), unit(what + 2));
    let target = bounds.min + vector(0) * bounds.size();
    if number.is_multiple_of(4) {
        let axis = [DVec3::X, DVec3::NEG_Y, DVec3::Z][(key(9) % 3) as usize];
        return Ray::new(target - axis * bounds.diagonal(), axis);
    }
    let away = (vector(3) * 2.0 - 1.0) * bounds.diagonal();
    let origin = if number % 4 == 1 {
        bounds.min + vector(6) * bounds.size()
    } else {
        bounds.center() + away
    };
    Ray::new(origin, target - origin)
}

/// Rays are asked in slices of so many.
const SLICE: u64 = 64;

fn answers(world: &World, rays: u64, one_pass: bool) -> Vec<Answers> {
    let slices = rays.div_ceil(SLICE);
    let slice = |i: u64| answers_of(world, i * SLICE..rays.min((i + 1) * SLICE), one_pass);
    (0..slices).into_par_iter().flat_map_iter(slice).collect()
}

fn answers_of(world: &World, numbers: Range<u64>, one_pass: bool) -> Vec<Answers> {
    let bounds = world.bounds();
    let queries: Vec<RayQuery> = numbers
        .map(|number| RayQuery::new(ray(&bounds, number)))
        .collect();
    let mut counters = Counters::default();
    let (mut closest, mut next) = (Vec::new(), Vec::new());
    let (mut occluded, mut regions) = (Vec::new(), Vec::new());
    let lines: Vec<Vec<Hit>> = queries
        .iter()
        .map(|query| {
            let mut hits = Vec::new();
            world.crossings(query, true, &mut hits, &mut counters);
            hits
        })
        .collect();
    if one_pass {
        let ahead = |hits: &Vec<Hit>| hits.iter().copied().find(|hit| hit.t > 0.0);
        closest.extend(lines.iter().map(|hits| ahead(hits).unwrap_or(Hit::MISS)));
        occluded.extend(closest.iter().map(|hit| !hit.is_miss()));
    } else {
        world.closest(&queries, &mut closest, &mut counters);
        world.occluded(&queries, &mut occluded, &mut counters);
    }
    let departing = |(query, hit): (&RayQuery, &Hit)| {
        if hit.is_miss() {
            return *query;
        }
        let surface = world.interact(query, hit);
        let back = bounds.center() - surface.position;
        let direction = if back == DVec3::ZERO { DVec3::X } else { back };
        RayQuery {
            ray: Ray::new(surface.position, direction),
            departure: hit.departure(direction.dot(surface.normal) > 0.0),
            ..*query
        }
    };
    // Brute force takes time: not of all rays.
    let first = queries.iter().zip(&closest).step_by(8);
    let departing: Vec<RayQuery> = first.map(departing).collect();
    world.closest(&departing, &mut next, &mut counters);
    let points: Vec<DVec3> = queries.iter().map(|query| query.ray.origin).collect();
    world.regions(&points, &mut regions, &mut counters);
    let of_line = |(index, crossings): (usize, Vec<Hit>)| {
        let mut chords = Vec::new();
        let mut counters = Counters::default();
        let kind = Overlaps::Objects;
        world.chords(&queries[index], true, kind, &mut chords, &mut counters);
        Answers {
            closest: closest[index],
            occluded: occluded[index],
            next: index.is_multiple_of(8).then(|| next[index / 8]),
            crossings,
            chords,
            region: regions[index],
        }
    };
    lines.into_iter().enumerate().map(of_line).collect()
}
