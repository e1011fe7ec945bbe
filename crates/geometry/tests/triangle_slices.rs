//! Lines that are searched together find what each finds by itself by trying every triangle, bit for
//! bit, whichever instructions are used.
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

mod meshes;

use meshes::{Random, moved, nasty_ray, sphere, together, zoo};
use octray_geometry::TriangleMesh;
use octray_geometry::mesh::{
    NearestTriangle, SearchMemory, TriangleQuery, TriangleSearch, TriangleTree,
};
use octray_kernels::{Lanes, Level};
use octray_math::{DVec3, Interval, Ray};
use octray_tree::WideTreeConfig;

fn tree(mesh: &TriangleMesh, search: TriangleSearch) -> TriangleTree {
    let (positions, triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    TriangleTree::new(positions, triangles, &[0], &search).unwrap()
}

/// A way to run, by its name.
type Way = (&'static str, Lanes);

fn ways() -> Vec<Way> {
    let mut ways = vec![("scalar", Lanes::Scalar), ("best", Lanes::detect())];
    #[cfg(target_arch = "x86_64")]
    {
        let level = Level::new();
        ways.extend(
            level
                .as_avx2()
                .map(|l| ("avx2", Lanes::Vector(Level::Avx2(l)))),
        );
    }
    ways
}

type Answer = Option<(u64, u32, bool)>;

fn bits(found: Option<NearestTriangle>) -> Answer {
    found.map(|f| (f.t.to_bits(), f.triangle, f.entering))
}

fn nearest(tree: &TriangleTree, queries: &[TriangleQuery]) -> Vec<Answer> {
    let mut answers = vec![None; queries.len()];
    let memory = &mut SearchMemory::default();
    tree.nearest(queries, memory, |index, found, _| {
        answers[index] = bits(found);
    });
    answers
}

fn any(tree: &TriangleTree, queries: &[TriangleQuery], counts: impl Fn(u32) -> bool) -> Vec<bool> {
    let mut answers = vec![false; queries.len()];
    let memory = &mut SearchMemory::default();
    tree.any_of(
        queries,
        memory,
        |_, found| counts(found.triangle),
        |index, met, _| answers[index] = met,
    );
    answers
}

/// Rays from one point (or, turned around, to one) at vertices, edges, the insides of triangles and
/// past the mesh: neighbours, as a tile of a picture has them, or not.
fn pencil(mesh: &TriangleMesh, random: &mut Random, count: usize) -> Vec<TriangleQuery> {
    let bounds = mesh.bounds();
    let size = bounds.size().max_element();
    let triangles = mesh.triangles();
    let vertex = |random: &mut Random| {
        let corners = triangles[random.below(triangles.len())];
        mesh.positions()[corners[random.below(3)] as usize]
    };
    let eye = match random.below(5) {
        0 => bounds.center() + random.point(0.1 * size),
        1 => vertex(random),
        2 => bounds.center() + DVec3::AXES[random.below(3)] * (3.0 * size),
        3 => bounds.center() + random.point(30.0 * size),
        _ => bounds.center() + random.point(2.0 * size),
    };
    let aim = vertex(random);
    let spread = size * [1e-9, 1e-3, 0.05, 0.3][random.below(4)];
    let departed = (random.below(4) == 0).then(|| random.below(triangles.len()) as u32);
    let meet_at_the_end = random.below(3) == 0;
    let bounded = random.below(2) == 0;
    (0..count)
        .map(|_| {
            let target = match random.below(4) {
                0 => aim,
                1 => {
                    let v = vertex(random);
                    if v.distance(aim) < spread { v } else { aim }
                }
                _ => aim + random.point(spread),
            };
            let (from, to) = if meet_at_the_end {
                (target, eye)
            } else {
                (eye, target)
            };
            // As a world does: scaled, and moved to about the closest approach.
            let ray = Ray::new(from, to - from);
            let shift = libm::rint(ray.closest_approach(bounds.center()) * 64.0) / 64.0;
            let shift = if shift.is_finite() { shift } else { 0.0 };
            let end = if bounded || meet_at_the_end {
                1.0 - shift
            } else {
                f64::INFINITY
            };
            TriangleQuery {
                ray: ray.shifted(shift),
                span: Interval::new(-shift, end),
                departed,
            }
        })
        .collect()
}

fn compare(name: &str, mesh: &TriangleMesh, queries: &[TriangleQuery]) -> usize {
    let all = tree(mesh, TriangleSearch::All);
    let wide = |leaf_size| {
        tree(
            mesh,
            TriangleSearch::Wide(WideTreeConfig {
                leaf_size,
                ..WideTreeConfig::default()
            }),
        )
    };
    let wanted = nearest(&all, queries);
    let odd = |triangle: u32| triangle % 2 == 1;
    let (met, met_odd) = (any(&all, queries, |_| true), any(&all, queries, odd));
    for leaf_size in [4, 8] {
        for (way, lanes) in ways() {
            let wide = wide(leaf_size).with_lanes(lanes);
            assert_eq!(nearest(&wide, queries), wanted, "{name} {way}");
            assert_eq!(any(&wide, queries, |_| true), met, "{name} {way}");
            assert_eq!(any(&wide, queries, odd), met_odd, "{name} {way}");
            // One by one.
            for (query, wanted) in queries.iter().zip(&wanted).step_by(7) {
                let one = nearest(&wide, std::slice::from_ref(query));
                assert_eq!(one, [*wanted], "{name} {way} {query:?}");
            }
        }
    }
    wanted.iter().flatten().count()
}

fn cases() -> usize {
    let cases = std::env::var("OCTRAY_CASES").ok();
    cases.and_then(|n| n.parse().ok()).unwrap_or(1)
}

#[test]
fn pencils_of_lines_through_meshes_of_all_kinds() {
    let mut hits = 0;
    for (seed, (name, mesh)) in zoo().into_iter().enumerate() {
        let mut random = Random::new(900 + seed as u64);
        for _ in 0..6 * cases() {
            let count = [64, 200, 9][random.below(3)];
            let queries = pencil(&mesh, &mut random, count);
            hits += compare(name, &mesh, &queries);
        }
    }
    assert!(hits > 3000, "{hits}");
}

#[test]
fn lines_of_all_kinds_in_one_slice() {
    let mut hits = 0;
    for (seed, (name, mesh)) in zoo().into_iter().enumerate() {
        let mut random = Random::new(300 + seed as u64);
        let queries: Vec<TriangleQuery> = (0..150 * cases())
            .map(|_| TriangleQuery {
                ray: nasty_ray(&mesh, &mut random),
                span: Interval::new(0.0, f64::INFINITY),
                departed: None,
            })
            .collect();
        hits += compare(name, &mesh, &queries);
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn a_small_mesh_in_a_large_one() {
    let head = sphere(3);
    let bowl = moved(&sphere(2), |p| p * 2000.0 + DVec3::new(0.0, 0.0, 700.0));
    let stadium = together(&head, &bowl);
    let mut random = Random::new(77);
    let mut hits = 0;
    for _ in 0..8 * cases() {
        let eye = random.point(3.0);
        let queries: Vec<TriangleQuery> = (0..128)
            .map(|_| {
                let target = head.positions()[random.below(head.positions().len())];
                let off = [0.0, 0.01][random.below(2)];
                let target = target + random.point(off);
                TriangleQuery {
                    ray: Ray::new(eye, (target - eye) * 0.25),
                    span: Interval::new(0.0, f64::INFINITY),
                    departed: None,
                }
            })
            .collect();
        hits += compare("stadium", &stadium, &queries);
    }
    assert!(hits > 700, "{hits}");
}
