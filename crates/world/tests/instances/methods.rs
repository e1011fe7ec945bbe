//! The octree over copies only proposes: brute force gives the same bits.

use octray_math::Ray;
use octray_world::{Counters, Method, Overlaps, RayQuery, World};
use rayon::ThreadPoolBuilder;

use crate::answers::{Answers, answers, methods, rays_about};
use crate::scenes::{Recipe, cases, rays, world};

/// All answers, and those that depend on overlaps.
fn everything(world: &World, rays: &[Ray]) -> (Answers, Vec<Vec<octray_world::Chord>>, Vec<u64>) {
    let mut counters = Counters::default();
    let queries = rays.iter().map(|ray| RayQuery::new(*ray));
    let kinds = [Overlaps::Regions, Overlaps::Priorities];
    let mut lists = Vec::new();
    let mut counts = Vec::new();
    for query in queries {
        for kind in kinds {
            let mut chords = Vec::new();
            world.chords(&query, false, kind, &mut chords, &mut counters);
            lists.push(chords);
        }
        counts.push(world.count_crossings(&query, true, &mut counters));
    }
    (answers(world, rays), lists, counts)
}

#[test]
fn every_method_gives_the_bits_of_brute_force() {
    for seed in 0..cases(4) {
        let recipe = Recipe::random(seed, seed % 2 == 0, seed % 4 > 1);
        let scene = recipe.instanced();
        let mut rays = rays(seed, 40);
        for copy in &recipe.copied[0].copies {
            rays.extend(rays_about(copy.translation, 0.4).into_iter().step_by(9));
        }
        let expected = everything(&world(&scene, Method::Brute), &rays);
        let hits = &expected.0.closest;
        assert!(hits.iter().filter(|hit| hit.instance > 0).count() > 20);
        // Over the seeds, every method has its turn.
        let turn = methods().into_iter().skip(seed as usize % 4);
        for method in turn.step_by(4) {
            let found = everything(&world(&scene, method), &rays);
            assert_eq!(found, expected, "seed {seed}, {method}");
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let scene = Recipe::random(11, true, false).instanced();
    let rays = rays(11, 50);
    let on = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let world = world(&scene, Method::Auto);
            let words: Vec<u32> = world.words().collect();
            (words, everything(&world, &rays))
        })
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn a_slice_of_rays_costs_what_its_rays_cost() {
    let scene = Recipe::random(5, true, false).instanced();
    let world = world(&scene, Method::Auto);
    let queries: Vec<RayQuery> = rays(5, 80).into_iter().map(RayQuery::new).collect();
    let (mut hits, mut same, mut costs) = (Vec::new(), Vec::new(), Vec::new());
    let mut counters = Counters::default();
    world.closest(&queries, &mut hits, &mut counters);
    world.closest_with_costs(&queries, &mut same, &mut costs);
    let mut sum = Counters::default();
    costs.iter().for_each(|cost| sum += *cost);
    assert_eq!((hits, counters), (same, sum));
    assert!(counters.instances > 80 && counters.instances < 80 * 39 / 2);
}
