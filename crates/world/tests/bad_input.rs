//! Scenes at the end of what is reasonable: every method ends, with the answers of brute force, within
//! the memory that it is given.

use std::sync::Arc;

use octray_geometry::{Sheet, Solid, TriangleMesh};
use octray_math::{DVec3, Ray, transform};
use octray_scene::{Material, Object, Scene, SceneBuilder};
use octray_world::{
    Chord, Counters, Criteria, Hit, Method, Overlaps, RayQuery, Region, World, WorldConfig,
};
use rayon::prelude::*;

fn methods() -> Vec<Method> {
    let grids = [1, 40].map(|n| Method::Grid(Some(n)));
    Method::all().into_iter().chain(grids).collect()
}

/// A scene of one material.
#[derive(Default)]
struct Odd {
    solids: Vec<Solid>,
    sheets: Vec<Sheet>,
}

impl Odd {
    fn of(solids: impl IntoIterator<Item = Solid>) -> Self {
        Self {
            solids: solids.into_iter().collect(),
            sheets: Vec::new(),
        }
    }

    fn triangles(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let mesh = TriangleMesh::new(positions, triangles).expect("a mesh");
        Self {
            solids: Vec::new(),
            sheets: vec![Sheet::mesh(Arc::new(mesh))],
        }
    }

    fn scene(self) -> Arc<Scene> {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        for solid in self.solids {
            builder.add_object(Object::solid("solid", solid, material));
        }
        for sheet in self.sheets {
            builder.add_object(Object::sheet("sheet", sheet, material));
        }
        Arc::new(builder.build().expect("a scene"))
    }
}

#[derive(Debug, PartialEq)]
struct Answers {
    closest: Vec<Hit>,
    occluded: Vec<bool>,
    lines: Vec<(Vec<Hit>, Vec<Chord>)>,
    regions: Vec<Region>,
}

fn answers(world: &World, rays: &[Ray]) -> Answers {
    let mut counters = Counters::default();
    let queries: Vec<RayQuery> = rays.iter().map(|ray| RayQuery::new(*ray)).collect();
    let (mut closest, mut occluded, mut regions) = (Vec::new(), Vec::new(), Vec::new());
    world.closest(&queries, &mut closest, &mut counters);
    world.occluded(&queries, &mut occluded, &mut counters);
    let points: Vec<DVec3> = rays.iter().map(|ray| ray.origin).collect();
    world.regions(&points, &mut regions, &mut counters);
    let line = |query: &RayQuery| {
        let (mut hits, mut chords) = (Vec::new(), Vec::new());
        let mut counters = Counters::default();
        world.crossings(query, true, &mut hits, &mut counters);
        let kind = Overlaps::Objects;
        world.chords(query, true, kind, &mut chords, &mut counters);
        (hits, chords)
    };
    Answers {
        lines: queries.iter().map(line).collect(),
        closest,
        occluded,
        regions,
    }
}

/// Rays along the axes and askew, from outside and from within, about a place of some size.
fn rays_about(center: DVec3, size: DVec3) -> Vec<Ray> {
    let mut rays = Vec::new();
    for i in -2..=2_i32 {
        for j in -2..=2_i32 {
            let (a, b) = (f64::from(i) * 0.4, f64::from(j) * 0.4);
            rays.push(Ray::new(center + DVec3::new(a, b, -5.0) * size, DVec3::Z));
            rays.push(Ray::new(center + DVec3::new(-5.0, a, b) * size, DVec3::X));
            rays.push(Ray::new(
                center - DVec3::splat(3.0) * size,
                (DVec3::splat(3.0) + DVec3::new(a, b, a - b)) * size,
            ));
            rays.push(Ray::new(
                center + DVec3::new(a, b, 0.0) * size,
                DVec3::new(b, 1.0, -a) * size,
            ));
        }
    }
    rays
}

/// What the cells may take here.
const MEMORY_LIMIT: u64 = 1 << 20;

fn criteria() -> [Criteria; 3] {
    let usual = Criteria {
        memory_limit: MEMORY_LIMIT,
        ..Criteria::default()
    };
    [
        usual,
        // Divides as often as it may.
        Criteria {
            visit_cost: 0.0,
            max_depth: 21,
            ..usual
        },
        // By the number of objects alone, which cannot fall where all are at one place.
        Criteria {
            by_cost: false,
            max_parts: 1,
            max_depth: 21,
            ..usual
        },
    ]
}

/// The answers that all methods agree on.
fn conform(name: &str, odd: Odd, rays: &[Ray]) -> Answers {
    let scene = odd.scene();
    let world = |method, criteria| {
        let config = WorldConfig {
            method,
            criteria,
            ..WorldConfig::default()
        };
        World::prepare(Arc::clone(&scene), &config).expect("a world")
    };
    let expected = answers(&world(Method::Brute, Criteria::default()), rays);
    methods().into_par_iter().for_each(|method| {
        for criteria in criteria() {
            let world = world(method, criteria);
            assert_eq!(
                answers(&world, rays),
                expected,
                "{name} by {method} with {criteria:?}"
            );
            let stats = world.stats();
            for cells in [&stats.cells, &stats.triangle_cells].into_iter().flatten() {
                let number = cells.cells.empty + cells.cells.occupied + cells.cells.divided;
                // An undivided cube holds everything, whatever that takes; division is what is
                // limited.
                let divided = number > 1;
                assert!(
                    !divided || cells.cells.bytes <= MEMORY_LIMIT,
                    "{name} by {method} with {criteria:?}: {} bytes in {number} cells",
                    cells.cells.bytes
                );
                assert!(number <= MEMORY_LIMIT / 4, "{name} by {method}: {number}");
            }
        }
    });
    expected
}

fn ball(radius: f64, at: DVec3) -> Solid {
    let ball = Solid::sphere(radius).expect("valid");
    ball.translate(at).expect("finite")
}

fn slab(half: DVec3) -> Solid {
    Solid::cuboid(-half, half).expect("valid")
}

#[test]
fn nothing_and_one_object() {
    let rays = rays_about(DVec3::ZERO, DVec3::ONE);
    let nothing = conform("nothing", Odd::default(), &rays);
    assert!(nothing.closest.iter().all(Hit::is_miss));
    let empty = Odd::of([Solid::difference([
        ball(1.0, DVec3::ZERO),
        ball(2.0, DVec3::ZERO),
    ])]);
    let empty = conform("what is left of nothing", empty, &rays);
    assert!(empty.closest.iter().all(Hit::is_miss));
    let no_triangles = conform("no triangles", Odd::triangles(vec![], vec![]), &rays);
    assert!(no_triangles.closest.iter().all(Hit::is_miss));
    let one = conform("one ball", Odd::of([ball(1.0, DVec3::ZERO)]), &rays);
    for (ray, hit) in rays.iter().zip(&one.closest) {
        // From outside: the quadratic's discriminant says whether it is met.
        let (along, away) = (ray.origin.dot(ray.direction), ray.origin.length_squared());
        let square = along * along - ray.direction.length_squared() * (away - 1.0);
        if away > 1.0 && square.abs() > 1e-9 {
            assert_eq!(!hit.is_miss(), square > 0.0 && along < 0.0, "{ray:?}");
        }
    }
}

#[test]
fn all_objects_at_one_point() {
    let rays = &rays_about(DVec3::ONE, DVec3::ONE)[..6];
    let through = Ray::new(DVec3::new(1.0, 1.0, -4.0), DVec3::Z);
    let rays: Vec<Ray> = rays.iter().copied().chain([through]).collect();
    let same = (0..1_000).map(|_| ball(1.0, DVec3::ONE));
    let same = conform("identical balls", Odd::of(same), &rays);
    // Each is where all are, and the one that the place belongs to shows.
    let (hits, chords) = same.lines.last().expect("a line");
    assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), [4.0, 6.0]);
    assert_eq!(chords.len(), 1_000);
    assert!(chords.iter().all(|c| c.length() == 2.0));

    let shells = (1..=1_000).map(|i| ball(f64::from(i) / 1_024.0, DVec3::ONE));
    let shells = conform("concentric balls", Odd::of(shells), &rays);
    let (hits, _) = shells.lines.last().expect("a line");
    let radii = (1..=1_000).map(|i| f64::from(i) / 1_024.0);
    let expected = radii.clone().rev().map(|r| 5.0 - r);
    let expected: Vec<f64> = expected.chain(radii.map(|r| 5.0 + r)).collect();
    assert_eq!(hits.iter().map(|hit| hit.t).collect::<Vec<_>>(), expected);

    let corners = vec![
        DVec3::ZERO,
        DVec3::new(3.0, 0.0, 1.0),
        DVec3::new(0.0, 3.0, 1.0),
    ];
    let same = Odd::triangles(corners, vec![[0, 1, 2]; 1_000]);
    let same = conform("identical triangles", same, &rays);
    let (hits, _) = same.lines.last().expect("a line");
    assert_eq!(hits.len(), 1_000);

    let points = vec![DVec3::ONE; 3];
    let points = conform(
        "points",
        Odd::triangles(points, vec![[0, 1, 2]; 1_000]),
        &rays,
    );
    assert!(points.closest.iter().all(Hit::is_miss));
}

#[test]
fn huge_and_tiny_coordinates() {
    for scale in [1e30, 1e-30] {
        let far = DVec3::new(1.0, -1.0, 0.3) * scale;
        let size = DVec3::splat(0.1 * scale);
        let rays = rays_about(far, size);
        let balls = Odd::of([ball(0.1 * scale, far), ball(0.2 * scale, far * 0.9)]);
        let name = format!("balls of size {scale:e}");
        let answers = conform(&name, balls, &rays);
        let met = answers.closest.iter().filter(|hit| !hit.is_miss());
        assert!(met.count() > rays.len() / 2, "{name}");
        let corners: Vec<DVec3> = (0..60)
            .map(|i| {
                let turn = f64::from(i) * 2.4;
                far + size * DVec3::new(libm::cos(turn), libm::sin(turn), libm::cos(turn * 7.0))
            })
            .collect();
        let triangles = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let name = format!("triangles of size {scale:e}");
        let answers = conform(&name, Odd::triangles(corners, triangles), &rays);
        let met = answers.closest.iter().filter(|hit| !hit.is_miss());
        assert!(met.count() > rays.len() / 4, "{name}");
    }
}

#[test]
fn flat_scenes_and_needles() {
    let rays = rays_about(DVec3::ZERO, DVec3::ONE);
    let flat = Odd::of([slab(DVec3::new(1.0, 1.0, 1e-9))]);
    let met = conform("a flat box", flat, &rays).closest;
    assert_eq!(met[48].t, 5.0 - 1e-9, "straight down on its middle");
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.25);
    let sheet: Vec<DVec3> = (0..=20)
        .flat_map(|i| (0..=20).map(move |j| corner(f64::from(i) - 10.0, f64::from(j) - 10.0)))
        .collect();
    let squares = (0..20).flat_map(|i| (0..20).map(move |j| 21 * i + j));
    let halves = squares.flat_map(|k| [[k, k + 1, k + 22], [k, k + 22, k + 21]]);
    let flat = Odd::triangles(sheet, halves.collect());
    let answers = conform("a flat sheet", flat, &rays);
    for (ray, hit) in rays.iter().zip(&answers.closest) {
        if ray.direction == DVec3::Z && ray.origin.z < 0.0 {
            assert_eq!(hit.t, 0.25 - ray.origin.z);
        }
    }
    for length in [1e6, 1e9] {
        let along = DVec3::new(length, 0.5, 0.5);
        let needle = Odd::of([slab(along), ball(1.0, DVec3::X)]);
        let answers = conform("a needle", needle, &rays);
        let lengthwise = answers.lines[49].0.last().expect("a boundary");
        assert_eq!(lengthwise.t, length + 5.0);
        let turn = transform::rotation_degrees(DVec3::new(1.0, 2.0, 0.5), 77.0);
        let rod = Solid::cylinder(0.5, -length, length).expect("valid");
        let askew = rod.transform(turn).expect("finite");
        conform("a needle askew", Odd::of([askew]), &rays);
        let corners = vec![
            DVec3::ZERO,
            DVec3::new(length, 1.0, 0.0),
            DVec3::new(0.0, 0.5, 1.0),
        ];
        conform("a sliver", Odd::triangles(corners, vec![[0, 1, 2]]), &rays);
    }
}

#[test]
fn only_unbounded_solids() {
    let floor = Solid::half_space(DVec3::Z, -0.5).expect("valid");
    let wall = Solid::half_space(DVec3::X, -2.5).expect("valid");
    let all_but = ball(1.0, DVec3::ZERO).complement();
    let rays = rays_about(DVec3::ZERO, DVec3::ONE);
    let answers = conform("a floor", Odd::of([floor.clone()]), &rays);
    for (ray, hit) in rays.iter().zip(&answers.closest) {
        let t = (-0.5 - ray.origin.z) / ray.direction.z;
        assert_eq!(
            hit.is_miss(),
            t.is_nan() || t <= 0.0 || t.is_infinite(),
            "{ray:?}"
        );
        assert!(hit.is_miss() || (hit.t - t).abs() <= 1e-12 * t);
    }
    conform(
        "floor and wall",
        Odd::of([floor.clone(), wall.clone()]),
        &rays,
    );
    conform("all but a ball", Odd::of([all_but]), &rays);
    conform(
        "a corner",
        Odd::of([Solid::intersection([floor, wall])]),
        &rays,
    );
}

#[test]
fn far_clusters() {
    let (near, far) = (DVec3::ZERO, DVec3::new(1e9, -3e8, 2e8));
    let cluster = |at: DVec3| {
        (0..30).map(move |i| {
            let turn = f64::from(i) * 2.4;
            ball(
                0.2,
                at + DVec3::new(libm::cos(turn), libm::sin(turn), turn * 0.02),
            )
        })
    };
    let mut rays = rays_about(near, DVec3::ONE);
    rays.extend(rays_about(far, DVec3::ONE));
    rays.push(Ray::new(near, far - near));
    let answers = conform(
        "clusters",
        Odd::of(cluster(near).chain(cluster(far))),
        &rays,
    );
    let met = |part: &[Hit]| part.iter().filter(|hit| !hit.is_miss()).count();
    assert!(met(&answers.closest[..100]) > 20 && met(&answers.closest[100..]) > 20);
    let corner = |i: u32| {
        let at = if i % 6 < 3 { near } else { far };
        let turn = f64::from(i) * 1.7;
        at + DVec3::new(libm::cos(turn), libm::sin(turn), libm::cos(3.0 * turn))
    };
    let triangles = (0..40).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let sheets = Odd::triangles((0..120).map(corner).collect(), triangles);
    let answers = conform("clusters of triangles", sheets, &rays);
    assert!(met(&answers.closest[..100]) > 20 && met(&answers.closest[100..]) > 20);
}
