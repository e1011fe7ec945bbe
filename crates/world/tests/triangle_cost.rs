//! What each method costs over large meshes: figures, not a test.
//!
//! Run it with `cargo test --release -p octray-world --test triangle_cost -- --ignored --nocapture`;
//! `OCTRAY_METHODS` chooses methods (names with commas), `OCTRAY_TRIANGLES` sizes.
#![expect(clippy::print_stdout, reason = "a report")]

use std::sync::Arc;
use std::time::Instant;

use octray_geometry::{Sheet, TriangleMesh};
use octray_math::{DVec3, Ray, hash_combine, unit_f64};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Counters, Method, RayQuery, World, WorldConfig};

/// A rough ring of about `wanted` triangles, without poles.
fn rough_ring(wanted: u32) -> TriangleMesh {
    let across = libm::sqrt(f64::from(wanted) / 4.0) as u32;
    let around = 2 * across;
    let turn = |i: u32, n: u32| libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
    let mut positions = Vec::new();
    for j in 0..across {
        let (sj, cj) = turn(j, across);
        for i in 0..around {
            let (s, c) = turn(i, around);
            let rough = 0.03 * libm::sin(29.0 * c + 5.0 * sj) * libm::sin(17.0 * s * cj);
            let minor = 0.35 + rough;
            let radius = 0.7 + minor * cj;
            positions.push(DVec3::new(c * radius, s * radius, sj * minor));
        }
    }
    let at = |i: u32, j: u32| j % across * around + i % around;
    let cells = (0..across).flat_map(|j| (0..around).map(move |i| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
        [[a, b, c], [b, d, c]]
    });
    TriangleMesh::new(positions, triangles.collect()).expect("valid")
}

fn queries(count: u64) -> Vec<RayQuery> {
    let unit = |i: u64, k: u64| 2.0 * unit_f64(hash_combine(i, k)) - 1.0;
    let ray = |i: u64| {
        let target = DVec3::new(unit(i, 0), unit(i, 1), unit(i, 2)) * 0.8;
        let from = DVec3::new(unit(i, 3), unit(i, 4), unit(i, 5)).normalize_or(DVec3::X) * 4.0;
        RayQuery::new(Ray::new(from, target - from))
    };
    (0..count).map(ray).collect()
}

#[test]
#[ignore = "takes minutes, prints figures"]
fn methods_over_large_meshes() {
    let names = std::env::var("OCTRAY_METHODS").unwrap_or_else(|_| {
        "auto,grid,octree,octree:tree:sung,octree:tree:fujimoto-iwata,octree:lvsi,\
         octree:lvsi-empty,octree:tree:ordered:bounding-box,octree:tree:ordered:bounding-sphere,\
         octree:tree:ordered:bounding-cover"
            .into()
    });
    let sizes = std::env::var("OCTRAY_TRIANGLES").unwrap_or_else(|_| "70000,1000000".into());
    for size in sizes.split(',') {
        let mesh = Arc::new(rough_ring(size.parse().expect("a number")));
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        let sheet = Sheet::mesh(Arc::clone(&mesh));
        builder.add_object(Object::sheet("ring", sheet, material));
        let scene = Arc::new(builder.build().expect("valid"));
        println!("{} triangles", mesh.triangles().len());
        let queries = queries(100_000);
        let mut expected = None;
        for name in names.split(',') {
            let method: Method = name.trim().parse().expect("a method");
            let config = WorldConfig {
                method,
                ..WorldConfig::default()
            };
            let start = Instant::now();
            let world = World::prepare(Arc::clone(&scene), &config).expect("memory enough");
            let build = start.elapsed().as_secs_f64();
            let mut best = f64::INFINITY;
            let mut hits = Vec::new();
            let mut counters = Counters::default();
            for _ in 0..3 {
                let start = Instant::now();
                counters = Counters::default();
                world.closest(&queries, &mut hits, &mut counters);
                best = best.min(start.elapsed().as_secs_f64());
            }
            let per_ray = |n: u64| n as f64 / queries.len() as f64;
            println!(
                "{name:40} build {build:6.2} s  {:7.1} krays/s  per ray: {:6.1} tests {:6.1} cells {:6.1} lookups {:5.1} nodes",
                1e-3 * queries.len() as f64 / best,
                per_ray(counters.triangle_tests),
                per_ray(counters.cells),
                per_ray(counters.lookups),
                per_ray(counters.nodes),
            );
            println!("{:?}", world.stats());
            assert_eq!(
                *expected.get_or_insert_with(|| hits.clone()),
                hits,
                "{name}"
            );
        }
    }
}
