//! The octree over triangles gives the answers of trying every triangle, bit for bit.
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(clippy::print_stderr, reason = "to say what was skipped")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

mod meshes;

use meshes::{Random, nasty_ray, zoo};
use octray_geometry::TriangleMesh;
use octray_geometry::mesh::{SearchCost, SearchMemory, TriangleSearch, TriangleTree};
use octray_math::{DVec3, Interval, Ray};
use octray_tree::WideTreeConfig;

fn both(mesh: &TriangleMesh) -> [TriangleTree; 2] {
    let config = WideTreeConfig::default();
    [Some(&config), None].map(|config| {
        TriangleTree::new(mesh.positions().to_vec(), mesh.triangles().to_vec(), config).unwrap()
    })
}

/// The nearest crossing, ties to the lowest triangle, as bits.
fn nearest(triangles: &TriangleTree, ray: &Ray, span: Interval) -> Option<(u64, u32, bool)> {
    let mut best: Option<(f64, u32, bool)> = None;
    let mut cost = WalkCost::default();
    triangles.closest(ray, span, &mut cost, |triangle, hit, _| {
        if best.is_none_or(|(t, other, _)| hit.t < t || (hit.t == t && triangle < other)) {
            best = Some((hit.t, triangle, hit.entering));
        }
        best.unwrap().0
    });
    best.map(|(t, triangle, entering)| (t.to_bits(), triangle, entering))
}

fn everything(triangles: &TriangleTree, ray: &Ray, span: Interval) -> Vec<(u32, u64, bool)> {
    let mut all = Vec::new();
    let mut cost = WalkCost::default();
    triangles.all(ray, span, &mut cost, |triangle, hit| {
        all.push((triangle, hit.t.to_bits(), hit.entering));
    });
    all.sort_unstable();
    all
}

fn compare(name: &str, mesh: &TriangleMesh, rays: impl Iterator<Item = Ray>) -> usize {
    let [tree, brute] = both(mesh);
    let mut hits = 0;
    for (i, ray) in rays.enumerate() {
        let all = everything(&brute, &ray, Interval::ALL);
        assert_eq!(
            everything(&tree, &ray, Interval::ALL),
            all,
            "{name} {ray:?}"
        );
        // Ends that are crossings themselves must count.
        let middle = all
            .get(i % all.len().max(1))
            .map_or(0.5, |x| f64::from_bits(x.1));
        let ahead = Interval::new(0.0, f64::INFINITY);
        let closed = Interval::new(middle, middle);
        for span in [
            ahead,
            closed,
            Interval::new(-1.0, middle),
            Interval::new(middle, 2.0),
        ] {
            let best = nearest(&brute, &ray, span);
            assert_eq!(nearest(&tree, &ray, span), best, "{name} {ray:?} {span:?}");
            let mut cost = WalkCost::default();
            let any = tree.any(&ray, span, &mut cost, |_, _| true);
            assert_eq!(any, best.is_some(), "{name} {ray:?} {span:?}");
            hits += usize::from(any);
        }
    }
    hits
}

#[test]
fn closed_meshes_under_nasty_rays() {
    let mut hits = 0;
    for (seed, (name, mesh)) in zoo().into_iter().enumerate() {
        let mut random = Random::new(50 + seed as u64);
        hits += compare(
            name,
            &mesh,
            (0..3000).map(|_| nasty_ray(&mesh, &mut random)),
        );
    }
    assert!(hits > 50_000, "{hits}");
}

/// Slivers seen edge-on: here the weights of the corners are all but undetermined, and still the
/// crossing must lie where the boxes are.
#[test]
fn slivers_of_all_sizes() {
    let mut random = Random::new(9);
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for _ in 0..600 {
        let size = libm::exp2(random.between(-20.0, 1.0));
        let [a, b] = [random.point(1.0), random.point(size)];
        let along = random.between(-0.5, 1.5);
        let width = libm::exp2(random.between(-60.0, -1.0));
        let first = positions.len() as u32;
        positions.extend([a, a + b, a + b * along + random.point(size * width)]);
        triangles.push([first, first + 1, first + 2]);
    }
    let mesh = TriangleMesh::new(positions, triangles).unwrap();
    let mut hits = 0;
    for width in [0.0, 1e-16, 1e-12, 1e-6] {
        let rays = (0..4000).map(|_| {
            let [a, b, c] = mesh.corners(random.below(600) as u32);
            let weights = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
            let target = a + (b - a) * weights[0] + (c - a) * (1.0 - weights[0]) * weights[1];
            let direction = match random.below(3) {
                0 => b - a,
                1 => (b - a) + random.point(1e-9),
                _ => random.point(1.0),
            };
            let direction = if direction == DVec3::ZERO {
                DVec3::X
            } else {
                direction
            };
            Ray::new(
                target - direction * random.between(-2.0, 2.0) + random.point(width),
                direction,
            )
        });
        hits += compare("slivers", &mesh, rays);
    }
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn scanned_meshes_where_they_are_at_hand() {
    let corpus = std::env::var("OCTRAY_CORPUS")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").into());
    let Ok(text) = std::fs::read_to_string(format!("{corpus}/mesh/suzanne.obj")) else {
        eprintln!("skipped: no mesh/suzanne.obj in {corpus}");
        return;
    };
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let x: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
                positions.push(DVec3::new(x[0], x[1], x[2]));
            }
            Some("f") => {
                let corners: Vec<u32> = words
                    .map(|w| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1)
                    .collect();
                triangles
                    .extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
            }
            _ => {}
        }
    }
    let mesh = TriangleMesh::new(positions, triangles).unwrap();
    let mut random = Random::new(8);
    let hits = compare(
        "suzanne",
        &mesh,
        (0..2000).map(|_| nasty_ray(&mesh, &mut random)),
    );
    assert!(hits > 2000, "{hits}");
}
