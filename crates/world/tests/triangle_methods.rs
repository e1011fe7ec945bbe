//! Every method finds the triangles of meshes that bound nothing as brute force does, to the bit.

mod answers;
#[allow(dead_code, reason = "only models are needed")]
mod random;

use std::sync::Arc;

use answers::{Answers, answers, methods};
use octray_geometry::{Sheet, Solid, TriangleMesh};
use octray_math::{DVec3, Ray};
use octray_scene::{Color, Material, Object, Pigment, SceneBuilder};
use octray_world::{CellsOf, Counters, Criteria, Method, RayQuery, World, WorldConfig};
use proptest::prelude::*;
use random::model;

type Triangle = [DVec3; 3];

/// A mesh object: its triangles, and whether light passes.
#[derive(Clone, Debug)]
struct Soup {
    triangles: Vec<Triangle>,
    clear: bool,
}

/// One object for every soup and solid, with cells as small as those of large scenes.
fn world(soups: &[Soup], solids: &[Solid], method: Method) -> World {
    let mut builder = SceneBuilder::new();
    let opaque = builder.add_material(Material::default());
    let glass = builder.add_material(Material {
        pigment: Pigment::Uniform(Color {
            transmit: 0.5,
            ..Color::rgb(1.0, 1.0, 1.0)
        }),
        ..Material::default()
    });
    for soup in soups {
        let count = soup.triangles.len() as u32;
        let corners = soup.triangles.concat();
        let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh::new(corners, triangles).expect("valid");
        let material = if soup.clear { glass } else { opaque };
        builder.add_object(Object::sheet("soup", Sheet::mesh(Arc::new(mesh)), material));
    }
    for solid in solids {
        builder.add_object(Object::solid("part", solid.clone(), opaque));
    }
    let config = WorldConfig {
        method,
        criteria: Criteria {
            max_depth: 7,
            visit_cost: 0.1,
            ..Criteria::default()
        },
        ..WorldConfig::default()
    };
    World::prepare(Arc::new(builder.build().expect("valid")), &config).expect("small")
}

/// The answers that all methods agree on.
fn conform(soups: &[Soup], solids: &[Solid], rays: &[Ray]) -> Answers {
    let brute = world(soups, solids, Method::Brute);
    let expected = (answers(&brute, rays), onward(&brute, rays));
    for method in methods() {
        let world = world(soups, solids, method);
        let found = (answers(&world, rays), onward(&world, rays));
        assert_eq!(found, expected, "{method}");
    }
    expected.0
}

/// From surface to surface along each ray, and how many there are.
fn onward(world: &World, rays: &[Ray]) -> Vec<(u32, u64, u64)> {
    let mut found = Vec::new();
    let mut counters = Counters::default();
    for ray in rays {
        let mut query = RayQuery::new(*ray);
        let count = world.count_crossings(&query, false, &mut counters);
        let mut hits = Vec::new();
        for _ in 0..20 {
            world.closest(&[query], &mut hits, &mut counters);
            let hit = hits[0];
            found.push((hit.face.0, hit.t.to_bits(), count));
            if hit.is_miss() {
                break;
            }
            query.ray.origin = query.ray.at(hit.t);
            query.departure = hit.departure(!hit.entering);
        }
    }
    found
}

/// Points that many triangles share, and that lie in the planes between cells.
fn lattice() -> impl Strategy<Value = DVec3> {
    let x = || (-4..=4i32).prop_map(|i| f64::from(i) * 0.25);
    (x(), x(), x()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn anywhere() -> impl Strategy<Value = DVec3> {
    let x = || -1.0..1.0f64;
    (x(), x(), x()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn triangle() -> impl Strategy<Value = Triangle> {
    let shared = (lattice(), lattice(), lattice()).prop_map(|(a, b, c)| [a, b, c]);
    // Of one plane, so that they overlap.
    let coplanar = (lattice(), lattice(), lattice())
        .prop_map(|(a, b, c)| [a, b, c].map(|p| DVec3::new(p.x, p.y, 0.25)));
    let sliver = (lattice(), lattice(), anywhere(), -40..-2i32, -0.5..1.5f64).prop_map(
        |(a, b, off, width, along)| [a, b, a + (b - a) * along + off * libm::exp2(width.into())],
    );
    let free = (anywhere(), anywhere(), anywhere()).prop_map(|(a, b, c)| [a, b, c]);
    prop_oneof![shared, coplanar, sliver, free]
}

fn soup() -> impl Strategy<Value = Soup> {
    // As often as not, one object per triangle.
    let triangles = prop_oneof![
        proptest::collection::vec(triangle(), 1),
        proptest::collection::vec(triangle(), 1..8)
    ];
    (triangles, any::<bool>()).prop_map(|(triangles, clear)| Soup { triangles, clear })
}

fn ray() -> impl Strategy<Value = Ray> {
    // Through vertices and along edges; from within and from afar.
    let between = (lattice(), lattice(), -2..=1i32).prop_map(|(a, b, k)| {
        let along = if a == b { DVec3::Z } else { b - a };
        Ray::new(a + along * f64::from(k), along)
    });
    let free = (anywhere(), anywhere(), 0..8i32)
        .prop_map(|(a, b, k)| Ray::new(a + (a - b) * f64::from(k), b - a));
    prop_oneof![between, free]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_method_finds_what_brute_force_finds(
        soups in proptest::collection::vec(soup(), 1..12),
        models in proptest::collection::vec(model(), 0..3),
        rays in proptest::collection::vec(ray(), 40),
    ) {
        let solids: Vec<Solid> = models.iter().map(|m| m.solid.clone()).collect();
        conform(&soups, &solids, &rays);
    }
}

fn opaque(triangles: Vec<Triangle>) -> Soup {
    Soup {
        triangles,
        clear: false,
    }
}

fn hits(answers: &Answers) -> usize {
    answers.crossings.iter().map(Vec::len).sum()
}

/// An `n` by `n` net of a surface over the unit square, of two triangles for each mesh.
fn net(n: u32, at: impl Fn(f64, f64) -> DVec3) -> Vec<Triangle> {
    let p = |i: u32, j: u32| at(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
    let squares = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let pair = |(i, j)| {
        let [a, b, c, d] = [p(i, j), p(i + 1, j), p(i, j + 1), p(i + 1, j + 1)];
        [[a, b, c], [b, d, c]]
    };
    squares.flat_map(pair).collect()
}

#[test]
fn odd_scenes_end_with_the_right_answers() {
    // Not all, because the odd numbers are slow.
    let around = |center, size| -> Vec<Ray> {
        let rays = answers::rays_about(center, size);
        rays.into_iter().step_by(4).collect()
    };
    let unit = around(DVec3::ZERO, 1.0);
    assert_eq!(hits(&conform(&[], &[], &unit)), 0);
    assert_eq!(hits(&conform(&[opaque(vec![])], &[], &unit)), 0);
    let one = [DVec3::NEG_ONE, DVec3::new(1.0, -1.0, 0.0), DVec3::Y];
    assert!(hits(&conform(&[opaque(vec![one])], &[], &unit)) > 3);
    // The same triangle many times: the first counts, whatever the order.
    assert!(hits(&conform(&vec![opaque(vec![one]); 40], &[], &unit)) > 120);
    // At one point, at the origin and elsewhere, alone and beside others.
    for point in [DVec3::ZERO, DVec3::ONE, DVec3::splat(1e30)] {
        let points = opaque(vec![[point; 3]; 60]);
        let rays = around(point, 1.0);
        assert_eq!(hits(&conform(std::slice::from_ref(&points), &[], &rays)), 0);
        conform(&[points, opaque(vec![one])], &[], &rays);
    }
    // Huge, tiny and far away.
    for (size, center) in [
        (1e30, DVec3::new(1e30, -1e30, 3e29)),
        (1e-30, DVec3::ZERO),
        (1.0, DVec3::new(1e9, -3e8, 7.0)),
        (1e150, DVec3::ZERO),
        (1e-150, DVec3::ZERO),
    ] {
        let hill = net(8, |x, y| {
            center + DVec3::new(x - 0.5, y - 0.5, 0.3 * libm::sin(9.0 * x * y)) * size
        });
        let found = conform(&[opaque(hill)], &[], &around(center, size));
        assert!(hits(&found) > 5, "{size} {center}: {}", hits(&found));
    }
    // Flat, in a plane between cells and across; and so flat that rounding is all there is.
    for z in [0.0, 1e-300, 0.1] {
        let flat = opaque(net(9, |x, y| DVec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, z)));
        let wall = opaque(net(4, |x, y| DVec3::new(z, 2.0 * x - 1.0, y)));
        assert!(hits(&conform(std::slice::from_ref(&flat), &[], &unit)) > 5);
        conform(&[flat, wall], &[], &unit);
    }
    // A needle, alone and through a net.
    let needle = [
        DVec3::new(-1e6, 0.3, 0.0),
        DVec3::new(1e6, 0.3, 0.0),
        DVec3::new(0.0, -0.7, 0.1),
    ];
    assert!(hits(&conform(&[opaque(vec![needle])], &[], &unit)) > 3);
    let thin = net(6, |x, y| DVec3::new(2e6 * x - 1e6, y - 0.5, 0.2));
    conform(&[opaque(vec![needle]), opaque(thin)], &[], &unit);
}

#[test]
fn a_small_mesh_far_from_a_large_scenes_middle_is_found() {
    let tiny = |at: DVec3, size: f64| {
        opaque(net(6, move |x, y| {
            at + DVec3::new(x - 0.5, y - 0.5, 0.1 * x * y) * size
        }))
    };
    for (distance, size) in [(1e3, 1e-3), (1e6, 1e-6), (1e3, 1e-9)] {
        let at = DVec3::new(distance, 0.5 * distance, 0.25 * distance);
        let ball = Solid::sphere(1.0).expect("valid");
        let rays = answers::rays_about(at, size);
        // Only the small mesh is in the triangles' cells; the ball makes the scene large.
        let found = conform(&[tiny(at, size)], &[ball], &rays);
        assert!(
            distance / size > 1e9 || hits(&found) > 20,
            "{}",
            hits(&found)
        );
    }
}

#[test]
fn the_figures_say_what_was_done() {
    let hill = net(24, |x, y| {
        DVec3::new(x, y, 0.2 * libm::sin(7.0 * x) * libm::cos(5.0 * y))
    });
    let soups = [opaque(hill)];
    let triangles = 2 * 24 * 24;
    let rays: Vec<RayQuery> = (0..300)
        .map(|i| {
            let x = f64::from(i % 20) / 20.0 + 0.013;
            let y = f64::from(i / 20) / 15.0 + 0.021;
            RayQuery::new(Ray::new(DVec3::new(x, y, 3.0), DVec3::new(0.1, -0.2, -1.0)))
        })
        .collect();
    let run = |name: &str| {
        let world = world(&soups, &[], name.parse().expect("a method"));
        let (mut hits, mut counters) = (Vec::new(), Counters::default());
        world.closest(&rays, &mut hits, &mut counters);
        (world.stats(), counters)
    };
    let (brute, all) = run("brute");
    assert_eq!((brute.triangle_tree, brute.triangle_cells), (None, None));
    assert_eq!(all.triangle_tests, 300 * triangles);
    for name in ["spheres", "boxes"] {
        let (stats, counters) = run(name);
        assert_eq!((stats.triangle_tree, stats.triangle_marks), (None, None));
        assert!(counters.triangle_tests > 0 && counters.triangle_tests <= all.triangle_tests);
        assert_eq!(counters.cells, 300);
    }
    let marked = |name: &str| {
        let (stats, counters) = run(name);
        let cells = stats.triangle_cells.expect("cells").cells;
        let marks = stats.triangle_marks.expect("marks");
        assert!(
            cells.occupied > 100 && cells.bytes > 4 * marks.references,
            "{name}"
        );
        assert!(counters.triangle_tests < all.triangle_tests / 20, "{name}");
        assert!(counters.mailbox > 0 && counters.cells > 300, "{name}");
        assert!(marks.references >= triangles && marks.most > 1, "{name}");
        marks
    };
    // In the same voxels, the exact test marks least, and all its questions end at some step.
    let exact = marked("octree");
    assert_eq!(exact.steps.iter().sum::<u64>(), exact.questions);
    assert!(exact.steps.iter().all(|n| *n > 0), "{:?}", exact.steps);
    assert_eq!(marked("octree:tree:sung:shells"), exact);
    assert_eq!(marked("octree:lvsi"), exact);
    for test in ["box", "sphere", "cover"] {
        let marks = marked(&format!("octree:tree:ordered:bounding-{test}"));
        assert_eq!(marks.steps, [0; 4]);
        assert!(marks.questions > 0);
    }
    marked("grid:20");
}

#[test]
fn cells_say_what_they_hold() {
    // Two objects whose boxes touch in one plane.
    let flat = |z: f64| opaque(net(8, move |x, y| DVec3::new(x, y, z + 0.01 * x)));
    let soups = [flat(0.0), flat(0.7)];
    for name in ["grid:9", "octree", "octree:lvsi-empty"] {
        let world = world(&soups, &[], name.parse().expect("a method"));
        let root = world.root(CellsOf::Triangles).expect("cells");
        assert!(root.contains_box(&world.bounds()));
        let (mut occupied, mut parts, mut of_both) = (0, 0, 0);
        world.visit_cells(CellsOf::Triangles, |cell| {
            let near = |z: f64| cell.bounds.min.z < z + 0.011 && cell.bounds.max.z > z - 0.001;
            let held = u32::from(near(0.0)) + u32::from(near(0.7));
            assert!(cell.objects.unwrap_or(0) <= held, "{cell:?}");
            occupied += u64::from(cell.objects.is_some());
            parts += u64::from(cell.parts);
            of_both += u32::from(cell.objects == Some(2));
        });
        let stats = world.stats();
        let marks = stats.triangle_marks.expect("marks");
        let cells = stats.triangle_cells.expect("cells").cells;
        assert_eq!(
            (occupied, parts),
            (cells.occupied, marks.references),
            "{name}"
        );
        assert_eq!(of_both, 0, "{name}: no cell is so large");
        assert!(stats.memory.triangle_cells >= 4 * marks.references);
    }
    // One voxel holds all.
    let world = world(&soups, &[], Method::Grid(Some(1)));
    world.visit_cells(CellsOf::Triangles, |cell| {
        assert_eq!((cell.objects, cell.parts), (Some(2), 4 * 64));
    });
}

#[test]
fn the_cells_are_the_same_for_any_number_of_threads() {
    let hill = net(40, |x, y| DVec3::new(x, y, 0.3 * libm::sin(20.0 * x * y)));
    let soups = [opaque(hill)];
    for name in ["grid", "octree", "octree:lvsi"] {
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let world = world(&soups, &[], name.parse().expect("a method"));
                (world.words().collect::<Vec<u32>>(), world.stats())
            })
        };
        let one = build(1);
        assert!(one.0.len() > 3000, "{}", one.0.len());
        assert!(one == build(4), "{name}");
    }
}
