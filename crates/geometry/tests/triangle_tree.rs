//! Every structure over triangles gives the answers of trying every triangle, bit for bit.
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(clippy::print_stderr, reason = "to say what was skipped")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

mod meshes;

use meshes::{Random, nasty_ray, zoo};
use octray_geometry::mesh::{SearchCost, SearchMemory, TriangleSearch, TriangleTree};
use octray_geometry::{Membership, TriangleMesh};
use octray_math::{DVec3, Interval, Ray};
use octray_tree::{Criteria, Division, Encoding, LvsiStore, LvsiTable, Traversal, WideTreeConfig};

/// Every way to search, each encoding, traversal and membership test among them.
fn searches() -> Vec<TriangleSearch> {
    let criteria = Criteria {
        max_depth: 8,
        ..Criteria::default()
    };
    let cells = |division, membership| TriangleSearch::Cells {
        division,
        table: LvsiTable::default(),
        membership,
        criteria,
    };
    let tree = |traversal| Division::Octree(Encoding::Tree, traversal);
    let hash = |store| Division::Octree(Encoding::Lvsi(store), Traversal::Sung);
    vec![
        TriangleSearch::Wide(WideTreeConfig::default()),
        TriangleSearch::Spheres,
        TriangleSearch::Boxes,
        cells(Division::Grid(None), Membership::Analytic),
        cells(Division::Grid(Some(1)), Membership::Analytic),
        cells(Division::Grid(Some(13)), Membership::BoundingBox),
        cells(tree(Traversal::Ordered), Membership::Analytic),
        cells(tree(Traversal::Ordered), Membership::BoundingCover),
        cells(tree(Traversal::FujimotoIwata), Membership::BoundingSphere),
        cells(tree(Traversal::Sung), Membership::BoundingBox),
        cells(tree(Traversal::Beam), Membership::Shells),
        cells(hash(LvsiStore::Occupied), Membership::Analytic),
        cells(hash(LvsiStore::All), Membership::BoundingCover),
        // So fine that most triangles lie in many cells.
        TriangleSearch::Cells {
            division: tree(Traversal::Ordered),
            table: LvsiTable::default(),
            membership: Membership::Analytic,
            criteria: Criteria {
                visit_cost: 0.05,
                ..criteria
            },
        },
    ]
}

/// A structure with the memory that goes from ray to ray.
struct Searched(TriangleTree, SearchMemory);

/// The mesh as so many objects.
fn searched(mesh: &TriangleMesh, objects: u32, search: &TriangleSearch) -> Searched {
    let count = mesh.triangles().len() as u32;
    let firsts: Vec<u32> = (0..objects).map(|i| i * count / objects).collect();
    let (positions, triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    let tree = TriangleTree::new(positions, triangles, &firsts, search).unwrap();
    Searched(tree, SearchMemory::default())
}

type Crossing = (u32, u64, bool);

impl Searched {
    /// The nearest crossing, ties to the lowest triangle, as bits.
    fn nearest(&mut self, ray: &Ray, span: Interval) -> Option<Crossing> {
        let mut best: Option<(u32, f64, bool)> = None;
        let mut cost = SearchCost::default();
        let Self(triangles, memory) = self;
        triangles.closest(ray, span, memory, &mut cost, |triangle, hit, _| {
            if best.is_none_or(|(other, t, _)| hit.t < t || (hit.t == t && triangle < other)) {
                best = Some((triangle, hit.t, hit.entering));
            }
            best.unwrap().1
        });
        best.map(|(triangle, t, entering)| (triangle, t.to_bits(), entering))
    }

    fn any(&mut self, ray: &Ray, span: Interval) -> bool {
        let mut cost = SearchCost::default();
        self.0.any(ray, span, &mut self.1, &mut cost, |_, _| true)
    }

    fn everything(&mut self, ray: &Ray, span: Interval) -> Vec<Crossing> {
        let mut all = Vec::new();
        let mut cost = SearchCost::default();
        let Self(triangles, memory) = self;
        triangles.all(ray, span, memory, &mut cost, |triangle, hit| {
            all.push((triangle, hit.t.to_bits(), hit.entering));
        });
        all.sort_unstable();
        all
    }
}

/// Multiplies the number of rays.
fn cases() -> usize {
    let cases = std::env::var("OCTRAY_CASES").ok();
    cases.and_then(|n| n.parse().ok()).unwrap_or(1)
}

/// Each ray by brute force and by two of the structures, which take turns.
fn compare(name: &str, mesh: &TriangleMesh, rays: impl Iterator<Item = Ray>) -> usize {
    let mut brute = searched(mesh, 1, &TriangleSearch::All);
    let searches = searches();
    let mut others: Vec<Searched> = searches.iter().map(|s| searched(mesh, 7, s)).collect();
    let mut hits = 0;
    for (i, ray) in rays.enumerate() {
        let all = brute.everything(&ray, Interval::ALL);
        // Ends that are crossings themselves must count.
        let middle = all
            .get(i % all.len().max(1))
            .map_or(0.5, |x| f64::from_bits(x.1));
        let spans = [
            Interval::new(0.0, f64::INFINITY),
            Interval::new(middle, middle),
            Interval::new(-1.0, middle),
            Interval::new(middle, 2.0),
        ];
        let best = spans.map(|span| brute.nearest(&ray, span));
        hits += best.iter().flatten().count();
        for which in [2 * i, 2 * i + 1].map(|k| k % searches.len()) {
            let (other, search) = (&mut others[which], &searches[which]);
            let context = || format!("{name} {search:?} {ray:?}");
            assert_eq!(other.everything(&ray, Interval::ALL), all, "{}", context());
            for (span, best) in spans.into_iter().zip(best) {
                assert_eq!(other.nearest(&ray, span), best, "{} {span:?}", context());
                assert_eq!(
                    other.any(&ray, span),
                    best.is_some(),
                    "{} {span:?}",
                    context()
                );
            }
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
            (0..700 * cases()).map(|_| nasty_ray(&mesh, &mut random)),
        );
    }
    assert!(hits > 12_000, "{hits}");
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
        let rays = (0..1000 * cases()).map(|_| {
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
    assert!(hits > 1_200, "{hits}");
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

/// Long thin triangles askew and large ones, which the wide octree cuts in two again and again.
fn needles() -> TriangleMesh {
    let mut random = Random::new(77);
    let mut positions = Vec::new();
    for i in 0..900 {
        let start = random.point(1.0);
        let along = [
            DVec3::new(1.1, 0.9, 0.6),
            DVec3::new(0.0, 0.0, 1.5),
            DVec3::new(-0.8, 0.8, 0.0),
        ][i % 3];
        let width = [1e-3, 1e-12, 0.3, 0.0][i % 4];
        positions.extend([start, start + along, start + random.point(width)]);
    }
    // Their corners lie on the planes that halve the tree.
    for i in 0..60 {
        let mut at = |k: usize| f64::from((random.below(9) + k) as u32 % 9) / 4.0 - 1.0;
        let corners = [
            at(0),
            at(1),
            at(2),
            at(3),
            at(4),
            at(5),
            at(6),
            at(7),
            at(8),
        ];
        let corner = |k: usize| DVec3::new(corners[k], corners[k + 1], corners[k + 2]);
        positions.extend([
            corner(0),
            corner(3),
            corner(6) + DVec3::splat(f64::from(i % 2)),
        ]);
    }
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    TriangleMesh::new(positions, triangles.collect()).unwrap()
}

#[test]
fn triangles_that_are_cut_in_two_are_found_where_they_are_crossed() {
    let mesh = needles();
    let mut brute = searched(&mesh, 1, &TriangleSearch::All);
    let mut wide = searched(&mesh, 1, &TriangleSearch::Wide(WideTreeConfig::default()));
    let stats = wide.0.tree_stats().unwrap();
    assert!(stats.references > stats.items, "{stats:?}");
    let mut random = Random::new(78);
    let mut hits = 0;
    for i in 0..6000 * cases() {
        let corners = mesh.corners(random.below(mesh.triangles().len()) as u32);
        let [u, v] = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
        let on = match i % 4 {
            0 => corners[i / 4 % 3],
            1 => corners[0] + (corners[1] - corners[0]) * u,
            2 => {
                corners[0]
                    + (corners[1] - corners[0]) * u
                    + (corners[2] - corners[0]) * v * (1.0 - u)
            }
            // Where planes may have cut.
            _ => ((corners[0] + (corners[1] - corners[0]) * u) * 16.0).round() / 16.0,
        };
        let direction = match i % 5 {
            0 => DVec3::AXES[random.below(3)],
            // Along the triangle, so that where it is crossed is badly known.
            1 => corners[1] - corners[0] + random.point(1e-9),
            2 => corners[1] - corners[0],
            _ => random.point(1.0),
        };
        let direction = if direction == DVec3::ZERO {
            DVec3::X
        } else {
            direction
        };
        let ray = Ray::new(on - direction * [0.0, 1.0, 1e3][i % 3], direction);
        let all = brute.everything(&ray, Interval::ALL);
        let middle = all
            .get(i % all.len().max(1))
            .map_or(0.5, |x| f64::from_bits(x.1));
        for span in [
            Interval::ALL,
            Interval::new(f64::NEG_INFINITY, middle),
            Interval::new(middle, f64::INFINITY),
        ] {
            assert_eq!(
                wide.everything(&ray, span),
                brute.everything(&ray, span),
                "{ray:?}"
            );
            assert_eq!(
                wide.nearest(&ray, span),
                brute.nearest(&ray, span),
                "{ray:?}"
            );
            assert_eq!(wide.any(&ray, span), brute.any(&ray, span), "{ray:?}");
        }
        hits += all.len();
    }
    assert!(hits > 3000 * cases(), "{hits}");
}
