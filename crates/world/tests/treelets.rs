//! A search that goes from treelet to treelet answers as the whole world does, to the bit, however
//! many treelets there are.

#[allow(dead_code, reason = "only models are needed")]
mod random;

use std::sync::Arc;

use octray_geometry::{Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec3, Ray};
use octray_scene::{Color, Instances, Material, Object, Pigment, Prototype, SceneBuilder, Shape};
use octray_world::{
    Counters, Criteria, Encoding, Hit, Membership, Method, OcclusionSearch, RayQuery, Search, Step,
    Traversal, TreeletError, Treelets, World, WorldConfig,
};
use proptest::prelude::*;
use random::{model, point};

const COUNTS: [usize; 5] = [1, 2, 3, 6, 40];
const LAMP: DVec3 = DVec3::new(3.0, -2.0, 4.0);

/// Objects of a scene: solids with priorities, triangles, and what is transparent.
#[derive(Clone, Debug)]
struct Parts {
    solids: Vec<(Solid, i32)>,
    triangles: Vec<[DVec3; 3]>,
    clear: [bool; 2],
}

fn octree(parts: &Parts) -> World {
    let mut builder = SceneBuilder::new();
    let mut material = |clear: bool| {
        let transmit = if clear { 0.5 } else { 0.0 };
        builder.add_material(Material {
            pigment: Pigment::Uniform(Color {
                transmit,
                ..Color::rgb(1.0, 1.0, 1.0)
            }),
            ..Material::default()
        })
    };
    let [of_solids, of_sheets] = parts.clear.map(&mut material);
    for (solid, priority) in &parts.solids {
        builder.add_object(Object {
            priority: *priority,
            ..Object::solid("part", solid.clone(), of_solids)
        });
    }
    let count = parts.triangles.len() as u32;
    let corners = parts.triangles.concat();
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriangleMesh::new(corners, triangles).expect("valid");
    builder.add_object(Object::sheet(
        "soup",
        Sheet::mesh(Arc::new(mesh)),
        of_sheets,
    ));
    prepare(builder)
}

fn prepare(builder: SceneBuilder) -> World {
    let config = WorldConfig {
        method: Method::Octree {
            encoding: Encoding::Tree,
            traversal: Traversal::Ordered,
            membership: Membership::Analytic,
        },
        criteria: Criteria {
            max_depth: 7,
            visit_cost: 0.1,
            ..Criteria::default()
        },
        ..WorldConfig::default()
    };
    World::prepare(Arc::new(builder.build().expect("valid")), &config).expect("small")
}

/// Takes a search through the treelets; also how often it went from one to another.
fn follow<A>(start: u16, mut step: impl FnMut(u16) -> Step<A>) -> (A, usize) {
    let (mut here, mut forwards) = (start, 0);
    loop {
        match step(here) {
            Step::Done(answer) => return (answer, forwards),
            Step::Forward(next) => {
                assert_ne!(next, here, "it would have gone on by itself");
                here = next;
                forwards += 1;
                assert!(forwards < 100_000, "it goes round in circles");
            }
        }
    }
}

fn closest(world: &World, treelets: &Treelets, query: RayQuery, start: u16) -> (Hit, usize) {
    let mut search = Search::new(query);
    follow(start, |here| {
        world.search_step(treelets, here, &mut search, &mut Counters::default())
    })
}

fn occluded(world: &World, treelets: &Treelets, query: RayQuery, start: u16) -> (bool, usize) {
    let mut search = OcclusionSearch::new(query);
    follow(start, |here| {
        world.occlusion_step(treelets, here, &mut search, &mut Counters::default())
    })
}

/// The rays themselves, and rays from what they meet: along the normal, against it, to a lamp, and as
/// a user would ask them, who knows of no departure.
fn queries(world: &World, rays: &[Ray]) -> Vec<RayQuery> {
    let mut all: Vec<RayQuery> = rays.iter().map(|ray| RayQuery::new(*ray)).collect();
    let mut hits = Vec::new();
    world.closest(&all, &mut hits, &mut Counters::default());
    let met = all
        .clone()
        .into_iter()
        .zip(hits)
        .filter(|(_, hit)| !hit.is_miss());
    for (query, hit) in met {
        let surface = world.interact(&query, &hit);
        let lamp = LAMP - surface.position;
        for direction in [surface.normal, -surface.normal, lamp, query.ray.direction] {
            let outward = direction.dot(surface.normal) > 0.0;
            let ray = Ray::new(surface.position, direction);
            let open = RayQuery::new(ray);
            let departing = RayQuery {
                departure: hit.departure(outward),
                ..open
            };
            let short = RayQuery {
                t_max: 1.0,
                ..departing
            };
            all.extend([open, departing, short]);
        }
    }
    all
}

/// Asserts that all answers are the whole world's; returns forwards and questions.
fn conform(world: &World, rays: &[Ray]) -> (usize, usize) {
    let queries = queries(world, rays);
    let (mut hits, mut blocked) = (Vec::new(), Vec::new());
    world.closest(&queries, &mut hits, &mut Counters::default());
    world.occluded(&queries, &mut blocked, &mut Counters::default());
    let (mut forwards, mut asked) = (0, 0);
    for count in COUNTS {
        let treelets = world.treelets(count).expect("can be cut");
        for (index, query) in queries.iter().enumerate() {
            let start = (index % count) as u16;
            let (hit, steps) = closest(world, &treelets, *query, start);
            assert_eq!(hit, hits[index], "{count} treelets, {query:?}");
            assert_eq!(hit.t.to_bits(), hits[index].t.to_bits());
            let (dark, more) = occluded(world, &treelets, *query, start);
            assert_eq!(dark, blocked[index], "{count} treelets, {query:?}");
            forwards += steps + more;
            asked += 2;
        }
    }
    (forwards, asked)
}

fn triangle() -> impl Strategy<Value = [DVec3; 3]> {
    prop_oneof![
        (point(3.0), point(1.0), point(1.0)).prop_map(|(a, u, v)| [a, a + u, a + v]),
        // In planes of a coarse grid, where faces of solids lie too.
        (-2..3i32, point(2.0), point(2.0), point(2.0)).prop_map(|(z, a, b, c)| {
            [a, b, c].map(|p| DVec3::new(p.x, p.y, f64::from(z) * 0.5))
        }),
    ]
}

fn cases(base: u32) -> u32 {
    let times = std::env::var("OCTRAY_CASES")
        .ok()
        .and_then(|n| n.parse::<u32>().ok());
    base * times.unwrap_or(1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(12)))]

    #[test]
    fn any_number_of_treelets_answers_as_the_whole_world(
        models in proptest::collection::vec((model(), 0..2i32), 0..6),
        triangles in proptest::collection::vec(triangle(), 0..30),
        clear in any::<[bool; 2]>(),
        rays in proptest::collection::vec((point(4.0), point(1.0)), 30),
    ) {
        let world = octree(&Parts {
            solids: models.into_iter().map(|(m, priority)| (m.solid, priority)).collect(),
            triangles,
            clear,
        });
        let rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect();
        conform(&world, &rays);
    }
}

/// A lattice of drilled blocks, which is cut everywhere, behind a wavy sheet.
fn drilled() -> World {
    let mut parts = vec![Solid::cuboid(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("valid")];
    for i in 0..64 {
        let [x, y, z] = [i % 4, i / 4 % 4, i / 16].map(|n| f64::from(n) - 1.5);
        let hole = Solid::sphere(0.45 + 0.01 * f64::from(i % 7)).expect("valid");
        let at = DAffine3::from_translation(DVec3::new(x, y, z));
        parts.push(hole.transform(at).expect("valid"));
    }
    let corner = |i: u32, j: u32| {
        let [x, y] = [i, j].map(|n| f64::from(n) * 0.25 - 2.0);
        DVec3::new(x, y, 2.5 + 0.2 * libm::sin(3.0 * x) * libm::cos(2.0 * y))
    };
    let squares = (0..256).map(|n| (n % 16, n / 16));
    let triangles = squares.flat_map(|(i, j)| {
        let [a, b] = [corner(i, j), corner(i + 1, j)];
        let [c, d] = [corner(i, j + 1), corner(i + 1, j + 1)];
        [[a, b, c], [c, b, d]]
    });
    octree(&Parts {
        solids: vec![(Solid::difference(parts), 0)],
        triangles: triangles.collect(),
        clear: [false, true],
    })
}

fn grid_of_rays(from: DVec3, count: u32) -> Vec<Ray> {
    let steps = (0..count * count).map(|n| (n % count, n / count));
    let at = |n: u32| f64::from(n) / f64::from(count - 1) * 4.4 - 2.2;
    steps
        .map(|(i, j)| Ray::new(from, DVec3::new(at(i), at(j), 0.0) - from))
        .collect()
}

#[test]
fn a_solid_that_spans_treelets_looks_the_same() {
    let world = drilled();
    let treelets = world.treelets(4).expect("can be cut");
    for treelet in 0..4 {
        let (leaves, triangles) = treelets.held(treelet);
        assert!(
            leaves + triangles > 20,
            "{treelet} holds {leaves}, {triangles}"
        );
        assert!(leaves > 0, "the block spans them all, {treelet} too");
    }
    let rays = grid_of_rays(DVec3::new(1.0, 2.0, 7.0), 12);
    let (forwards, asked) = conform(&world, &rays);
    // Of up to 40 treelets.
    assert!(forwards < 3 * asked, "{forwards} forwards of {asked}");
    assert!(forwards > 0, "they were asked");
}

fn with_copies(clear: bool) -> World {
    let mut builder = SceneBuilder::new();
    let mut material = |transmit: f64| {
        builder.add_material(Material {
            pigment: Pigment::Uniform(Color {
                transmit,
                ..Color::rgb(1.0, 1.0, 1.0)
            }),
            ..Material::default()
        })
    };
    let of_copies = material(if clear { 0.5 } else { 0.0 });
    let of_block = material(0.0);
    let ball = Shape::Solid(Solid::sphere(0.4).expect("valid"));
    let prototype = Arc::new(Prototype::new([ball]).expect("bounded"));
    let places: Vec<DAffine3> = (0..27)
        .map(|i| [i % 3, i / 3 % 3, i / 9].map(|n| f64::from(n) - 1.0))
        .map(|at| DAffine3::from_translation(DVec3::from_array(at) * 1.1))
        .collect();
    let copies = Instances::new(prototype, places).expect("few");
    let block = Solid::cuboid(DVec3::splat(-1.0), DVec3::ONE).expect("valid");
    builder.add_object(Object::solid("block", block, of_block));
    let shape = Shape::Instances(copies);
    let balls = Object::solid("balls", Solid::union([]), of_copies);
    builder.add_object(Object { shape, ..balls });
    prepare(builder)
}

#[test]
fn copies_are_shared_by_all_treelets() {
    let world = with_copies(false);
    conform(&world, &grid_of_rays(DVec3::new(1.0, 2.0, 7.0), 16));
}

#[test]
fn what_cannot_be_cut_is_said() {
    let cut = |clear, count| with_copies(clear).treelets(count).map(|cut| cut.count());
    for count in [0, 70_000] {
        assert_eq!(cut(false, count), Err(TreeletError::Count));
    }
    assert_eq!(cut(false, 7), Ok(7));
    assert_eq!(cut(true, 7), Err(TreeletError::Copies));
}
