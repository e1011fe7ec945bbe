//! Meshes in the world: with octrees and without, alone and as operands, the same bits.

use std::sync::Arc;

use octray_geometry::{MeshRule, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3, Ray, hash_combine, unit_f64};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Counters, Hit, Method, RayQuery, World, WorldConfig};

/// A torus about z of `around` times `across` quads, each of two triangles.
fn ring(around: u32, across: u32) -> TriangleMesh {
    let turn = |i: u32, n: u32| libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let ((s, c), (sj, cj)) = (turn(i, around), turn(j, across));
            let r = 2.0 + 0.5 * cj;
            positions.push(DVec3::new(r * c, r * s, 0.5 * sj));
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriangleMesh::new(positions, triangles).expect("valid")
}

fn world(method: Method) -> World {
    let mesh = Arc::new(ring(24, 12));
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    let solid = Solid::mesh(Arc::clone(&mesh), MeshRule::Strict).expect("sound");
    let cut = Solid::sphere(1.0).and_then(|s| s.translate(DVec3::new(2.0, 0.0, 0.0)));
    let part = Solid::difference([solid.clone(), cut.expect("valid")]);
    builder.add_object(Object::solid("bitten ring", part, material));
    let mirrored = DAffine3::from_scale(DVec3::new(-0.5, 1.0, 2.0));
    let mirrored = DAffine3::from_translation(DVec3::new(0.0, 0.0, 2.0)) * mirrored;
    let other = solid.transform(mirrored).expect("invertible");
    builder.add_object(Object::solid("mirrored ring", other, material));
    for i in 0..3 {
        let place = DAffine3::from_translation(DVec3::new(0.0, 0.1 * f64::from(i), -1.0));
        let sheet = Sheet::mesh(Arc::clone(&mesh)).transform(place);
        builder.add_object(Object::sheet("skin", sheet.expect("invertible"), material));
    }
    let config = WorldConfig {
        method,
        ..WorldConfig::default()
    };
    World::prepare(Arc::new(builder.build().expect("valid")), &config).expect("small")
}

fn rays() -> impl Iterator<Item = Ray> {
    let unit = |i: u64, k: u64| unit_f64(hash_combine(i, k));
    let point =
        move |i: u64, k: u64| DVec3::new(unit(i, k), unit(i, k + 1), unit(i, k + 2)) * 2.0 - 1.0;
    (0..4000).map(move |i| {
        let target = point(i, 0) * DVec3::new(2.5, 2.5, 1.5);
        // Some from the grid of coordinates that vertices have, some along an axis.
        let target = if i % 3 == 0 {
            (target * 4.0).round() * 0.25
        } else {
            target
        };
        let direction = match i % 4 {
            0 => DVec3::AXES[(i / 4 % 3) as usize],
            _ => point(i, 10),
        };
        Ray::new(target - direction * 4.0, direction)
    })
}

#[test]
fn octrees_over_triangles_change_no_bit() {
    let [tree, brute] = [Method::Auto, Method::Brute].map(world);
    let stats = tree.stats().triangle_tree.expect("an octree");
    assert_eq!(stats.items as usize, tree.stats().triangles);
    assert_eq!(brute.stats().triangle_tree, None);
    let mut cost = [Counters::default(), Counters::default()];
    let mut hit = 0;
    for ray in rays() {
        let mut query = RayQuery::new(ray);
        let mut found = [Vec::new(), Vec::new()];
        tree.crossings(&query, true, &mut found[0], &mut cost[0]);
        brute.crossings(&query, true, &mut found[1], &mut cost[1]);
        assert_eq!(found[0], found[1], "{ray:?}");
        // On from hit to hit, as light goes.
        for _ in 0..20 {
            let mut first: [Vec<Hit>; 2] = [Vec::new(), Vec::new()];
            let mut blocked = [Vec::new(), Vec::new()];
            for (i, world) in [&tree, &brute].into_iter().enumerate() {
                world.closest(&[query], &mut first[i], &mut cost[i]);
                world.occluded(&[query], &mut blocked[i], &mut cost[i]);
            }
            assert_eq!(first[0], first[1], "{query:?}");
            assert_eq!(blocked[0], blocked[1], "{query:?}");
            let next = first[0][0];
            if next.is_miss() {
                break;
            }
            hit += 1;
            query.ray.origin = query.ray.at(next.t);
            query.departure = next.departure(!next.entering);
        }
    }
    assert!(hit > 10_000, "{hit}");
    assert!(cost[0].nodes > 0 && cost[1].nodes == 0);
    assert!(cost[0].triangle_tests * 10 < cost[1].triangle_tests);
}

#[test]
fn a_world_of_triangles_has_the_same_words_for_any_number_of_threads() {
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let words = || world(Method::Auto).words().collect::<Vec<u32>>();
        pool.expect("threads").install(words)
    };
    let one = build(1);
    assert!(one.len() > 9_000, "{}", one.len());
    assert!(one == build(4));
}
