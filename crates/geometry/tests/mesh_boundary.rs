//! Which meshes are boundaries of solids, and what is said of those that are not.
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

mod meshes;

use std::sync::Arc;

use meshes::{Random, cuboid, moved, sphere, together, torus, zoo};
use octray_geometry::mesh::{FlawKind, MeshReport, MeshSolid};
use octray_geometry::{MeshError, MeshRule, Solid, TriangleMesh};
use octray_math::{DAffine3, DMat3, DVec3};

fn counts(mesh: &TriangleMesh) -> Vec<(FlawKind, usize)> {
    mesh.check().counts().collect()
}

fn cube(low: [f64; 3], high: [f64; 3]) -> TriangleMesh {
    cuboid(DVec3::from_array(low), DVec3::from_array(high))
}

fn unit() -> TriangleMesh {
    cube([0.0; 3], [1.0; 3])
}

/// The same mesh with some triangles replaced.
fn with_triangles(mesh: &TriangleMesh, change: impl FnOnce(&mut Vec<[u32; 3]>)) -> TriangleMesh {
    let mut triangles = mesh.triangles().to_vec();
    change(&mut triangles);
    TriangleMesh::new(mesh.positions().to_vec(), triangles).unwrap()
}

/// The triangles of a mesh as a soup: no two share an index.
fn soup(mesh: &TriangleMesh) -> TriangleMesh {
    let corners = (0..mesh.triangles().len() as u32).flat_map(|t| mesh.corners(t));
    let n = mesh.triangles().len() as u32;
    let triangles = (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(corners.collect(), triangles).unwrap()
}

/// Everything that must be the same wherever and however a mesh stands.
fn everywhere(mesh: &TriangleMesh, expected: &[(FlawKind, usize)], name: &str) {
    // Each keeps coordinates and coplanarity exact.
    let swapped = |p: DVec3| DVec3::new(p.y, p.z, p.x);
    let ways: [(&str, TriangleMesh); 6] = [
        ("as it is", mesh.clone()),
        ("as a soup", soup(mesh)),
        (
            "moved",
            moved(mesh, |p| p + DVec3::new(1024.0, -512.0, 3.0)),
        ),
        ("tiny", moved(mesh, |p| p * libm::scalbn(1.0, -700))),
        ("huge", moved(mesh, |p| p * libm::scalbn(1.0, 900))),
        ("axes exchanged", moved(mesh, swapped)),
    ];
    for (way, mesh) in &ways {
        let report = mesh.check();
        let found: Vec<_> = report.counts().collect();
        assert_eq!(found, expected, "{name}, {way}: {report}");
        assert_eq!(report.is_sound(), expected.is_empty());
    }
}

#[test]
fn sound_meshes_are_sound() {
    for (name, mesh) in zoo() {
        let report = mesh.check();
        // The one on a grid has vertices that were moved together, and may touch itself.
        if name != "on a grid" {
            assert!(report.is_sound(), "{name}: {report}");
            assert_eq!(report.shells, 1, "{name}");
        }
    }
    let turned = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.4);
    for far in [0.0, 1e6] {
        let mesh = moved(&sphere(5), |p| turned * p + far);
        assert!(mesh.check().is_sound());
    }
    everywhere(&unit(), &[], "cube");
    let cavity = cube([0.25; 3], [0.75; 3]).reversed();
    everywhere(&together(&unit(), &cavity), &[], "cavity");
    everywhere(
        &together(&unit(), &cube([3.0, 0.0, 0.0], [4.0, 1.0, 1.0])),
        &[],
        "two cubes",
    );
    let island = cube([0.375; 3], [0.625; 3]);
    everywhere(
        &together(&together(&unit(), &cavity), &island),
        &[],
        "island in a cavity",
    );
}

#[test]
fn touching_is_no_crossing() {
    // A face upon a larger one; a corner on a face; an edge across a face.
    everywhere(
        &together(
            &cube([0.0; 3], [4.0; 3]),
            &cube([1.0, 1.0, 4.0], [2.0, 2.0, 5.0]),
        ),
        &[],
        "a small cube upon a large one",
    );
    let corner = TriangleMesh::new(
        vec![
            DVec3::new(1.0, 1.5, 4.0),
            DVec3::new(1.0, 1.0, 6.0),
            DVec3::new(2.0, 1.0, 6.0),
            DVec3::new(1.0, 2.0, 6.0),
        ],
        vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]],
    )
    .unwrap();
    everywhere(
        &together(&cube([0.0; 3], [4.0; 3]), &corner),
        &[],
        "a tip on a face",
    );
    let roof = TriangleMesh::new(
        vec![
            DVec3::new(1.0, 1.0, 4.0),
            DVec3::new(2.0, 3.0, 4.0),
            DVec3::new(3.0, 2.0, 6.0),
            DVec3::new(1.0, 3.0, 6.0),
        ],
        vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
    )
    .unwrap();
    assert!(roof.signed_volume() > 0.0);
    everywhere(
        &together(&cube([0.0; 3], [4.0; 3]), &roof),
        &[],
        "an edge on a face",
    );
}

#[test]
fn edges_are_told_apart() {
    let base = unit();
    let hole = with_triangles(&base, |t| t.truncate(11));
    everywhere(&hole, &[(FlawKind::OpenEdge, 3)], "a triangle is missing");
    let turned = with_triangles(&base, |t| t[0].swap(0, 1));
    everywhere(
        &turned,
        &[(FlawKind::MisorientedEdge, 3)],
        "a triangle is turned",
    );
    // A fin: a triangle that stands on an edge.
    let mut positions = base.positions().to_vec();
    positions.push(DVec3::new(-1.0, 0.5, -1.0));
    let mut triangles = base.triangles().to_vec();
    triangles.push([0, 2, 8]);
    let fin = TriangleMesh::new(positions, triangles).unwrap();
    let expected = [(FlawKind::OpenEdge, 2), (FlawKind::UnbalancedEdge, 1)];
    everywhere(&fin, &expected, "a fin");
    let beside = together(&base, &cube([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]));
    everywhere(
        &beside,
        &[(FlawKind::CrowdedEdge, 1)],
        "two cubes share an edge",
    );
}

#[test]
fn crossings_overlaps_and_folds_are_found() {
    use FlawKind::{Crossing, Fold, InsideOut, Nested, Overlap};
    let kinds = |mesh: &TriangleMesh| -> Vec<FlawKind> {
        counts(mesh).into_iter().map(|(kind, _)| kind).collect()
    };
    let shifted = |by: [f64; 3]| moved(&unit(), |p| p + DVec3::from_array(by));
    // In general position, and with an edge of one exactly in a face of the other.
    assert_eq!(
        kinds(&together(&unit(), &shifted([0.5, 0.3, 0.1]))),
        [Crossing]
    );
    let tilted = moved(&unit(), |p| {
        DVec3::new(p.x + p.y - 1.0, p.x - p.y, p.z * 4.0 - 1.0)
    });
    assert!(
        kinds(&together(&cube([0.0, -2.0, 0.0], [4.0, 2.0, 2.0]), &tilted)).contains(&Crossing)
    );
    // All faces in the same planes: the sides overlap.
    assert_eq!(
        kinds(&together(&unit(), &shifted([0.5, 0.0, 0.0]))),
        [Overlap]
    );
    // Common bottom: nothing crosses, but the smaller is counted twice.
    let inner = cube([0.25, 0.25, 0.0], [0.75, 0.75, 0.5]);
    assert_eq!(kinds(&together(&unit(), &inner)), [Overlap]);
    assert_eq!(
        counts(&together(&unit(), &cube([0.25; 3], [0.75; 3]))),
        [(Nested, 1)]
    );
    everywhere(&unit().reversed(), &[(InsideOut, 1)], "inside out");
    everywhere(
        &together(&unit(), &cube([3.0; 3], [4.0; 3]).reversed()),
        &[(InsideOut, 1)],
        "one of two is inside out",
    );
    // All reversed: the outer shell and the cavity in it.
    let hollow = together(&unit(), &cube([0.25; 3], [0.75; 3]).reversed());
    assert_eq!(counts(&hollow.reversed()), [(InsideOut, 2)]);
    let pillow = TriangleMesh::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::Y],
        vec![[0, 1, 2], [0, 2, 1]],
    );
    assert_eq!(counts(&pillow.unwrap()), [(Fold, 1)]);
}

/// A prism over an 8-gon wall whose edge runs exactly through the face of a cube: no edge pierces
/// the inside of any triangle.
#[test]
fn surfaces_that_cross_along_an_edge_are_found() {
    // A bar of square section turned by 45 degrees, divided where it enters the cube's face x = 0,
    // so that its four edges there lie in that face; the cube is divided nowhere.
    let ring = |x: f64| {
        [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]].map(|[y, z]| DVec3::new(x, y, z))
    };
    let mut positions = Vec::new();
    for x in [-2.0, 0.0, 2.0] {
        positions.extend(ring(x));
    }
    let mut triangles = Vec::new();
    for section in 0..2 {
        for i in 0..4 {
            let at = |s: u32, i: u32| 4 * s + i % 4;
            let [a, b] = [at(section, i), at(section, i + 1)];
            let [c, d] = [at(section + 1, i), at(section + 1, i + 1)];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    triangles.extend([[0, 1, 2], [0, 2, 3], [8, 10, 9], [8, 11, 10]]);
    let bar = TriangleMesh::new(positions, triangles).unwrap();
    let bar = if bar.signed_volume() < 0.0 {
        bar.reversed()
    } else {
        bar
    };
    assert!(bar.check().is_sound(), "{}", bar.check());
    let block = cube([0.0, -8.0, -8.0], [4.0, 8.0, 9.0]);
    let report = together(&block, &bar).check();
    assert!(report.count(FlawKind::Crossing) > 0, "{report}");
    // Outside of the block it only touches.
    let beside = cube([2.0, -8.0, -8.0], [4.0, 8.0, 9.0]);
    assert!(together(&beside, &bar).check().is_sound());
}

#[test]
fn random_pairs_of_shells_cross_if_their_volumes_do() {
    // Lattice boxes: the truth is in whole numbers.
    let mut random = Random::new(5);
    let mut seen = [0; 3];
    for _ in 0..1500 {
        let mut span = || {
            let [a, b] = [random.below(5) as f64, random.below(5) as f64];
            (a.min(b), a.max(b) + if a == b { 1.0 } else { 0.0 })
        };
        let mut lattice_box = || {
            let (x, y, z) = (span(), span(), span());
            ([x.0, y.0, z.0], [x.1, y.1, z.1])
        };
        let (a, b) = (lattice_box(), lattice_box());
        let both = together(&cube(a.0, a.1), &cube(b.0, b.1));
        let report = both.check();
        let volumes_overlap = (0..3).all(|i| a.0[i] < b.1[i] && b.0[i] < a.1[i]);
        let doubts = [FlawKind::Crossing, FlawKind::Overlap, FlawKind::Nested];
        let doubts = doubts.into_iter().map(|k| report.count(k)).sum::<usize>();
        assert_eq!(doubts > 0, volumes_overlap, "{a:?} {b:?} {report}");
        assert_eq!(report.is_unambiguous(), !volumes_overlap);
        assert!(report.is_closed());
        let shared = report.count(FlawKind::CrowdedEdge) > 0;
        seen[usize::from(volumes_overlap)] += 1;
        seen[2] += usize::from(shared);
    }
    assert!(seen.iter().all(|&n| n > 50), "{seen:?}");
}

#[test]
fn random_tilted_tetrahedra_cross_as_their_winding_numbers_say() {
    // Points on a small lattice, so that corners and edges often lie on faces.
    let mut random = Random::new(6);
    let mut seen = [0; 2];
    for _ in 0..4000 {
        let mut tetrahedron = || loop {
            let mut point = || DVec3::from_array([0; 3].map(|_| random.below(5) as f64));
            let corners = vec![point(), point(), point(), point()];
            let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
            let mesh = TriangleMesh::new(corners, faces).unwrap();
            let volume = mesh.signed_volume();
            if volume.abs() > 0.1 {
                return if volume < 0.0 { mesh.reversed() } else { mesh };
            }
        };
        let (a, b) = (tetrahedron(), tetrahedron());
        // The insides meet unless a plane separates them: one of a face, or one that is parallel
        // to an edge of each (separating axes of convex bodies).
        let normals = |m: &TriangleMesh| -> Vec<DVec3> {
            (0..4)
                .map(|t| m.corners(t))
                .map(|[p, q, r]| (q - p).cross(r - p))
                .collect()
        };
        let edges = |m: &TriangleMesh| -> Vec<DVec3> {
            let p = m.positions();
            (0..4)
                .flat_map(|i| (i + 1..4).map(move |j| p[j] - p[i]))
                .collect()
        };
        let mut axes = [normals(&a), normals(&b)].concat();
        for e in edges(&a) {
            axes.extend(edges(&b).into_iter().map(|f| e.cross(f)));
        }
        let apart = axes
            .iter()
            .filter(|axis| **axis != DVec3::ZERO)
            .any(|axis| {
                let range = |m: &TriangleMesh| {
                    let along = m.positions().iter().map(|p| p.dot(*axis));
                    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                        (l.min(x), h.max(x))
                    })
                };
                let ((l, h), (m, n)) = (range(&a), range(&b));
                h <= m || n <= l
            });
        let report = together(&a, &b).check();
        assert_eq!(report.is_unambiguous(), apart, "{a:?} {b:?} {report}");
        seen[usize::from(apart)] += 1;
    }
    assert!(seen.iter().all(|&n| n > 300), "{seen:?}");
}

#[test]
fn rules_decide_what_is_taken() {
    let crossing = Arc::new(together(
        &unit(),
        &moved(&unit(), |p| p + DVec3::new(0.5, 0.3, 0.1)),
    ));
    let refused = Solid::mesh(Arc::clone(&crossing), MeshRule::Strict).unwrap_err();
    assert!(matches!(
        &refused,
        octray_geometry::ShapeError::Mesh(MeshError::NotASolid(_))
    ));
    let solid = |mesh: &TriangleMesh| {
        Solid::mesh(Arc::new(mesh.clone()), MeshRule::Winding).unwrap();
        MeshSolid::new(&Arc::new(mesh.clone()), &DAffine3::IDENTITY, None).unwrap()
    };
    let both = solid(&crossing);
    for p in [[0.2, 0.2, 0.05], [0.7, 0.5, 0.5], [1.4, 1.2, 1.05]] {
        assert!(both.contains(DVec3::from_array(p)), "{p:?}");
    }
    assert!(!both.contains(DVec3::new(1.4, 0.1, 0.5)));
    assert!(solid(&unit().reversed()).contains(DVec3::splat(0.5)));
    let open = with_triangles(&unit(), |t| t.truncate(11));
    for rule in [MeshRule::Strict, MeshRule::Winding] {
        let error = Solid::mesh(Arc::new(open.clone()), rule)
            .unwrap_err()
            .to_string();
        assert!(error.contains("3 open edges"), "{error}");
        assert!(error.contains("(1, 0, 1)"), "{error}");
    }
    let error = Solid::mesh(Arc::new(open), MeshRule::Winding)
        .unwrap_err()
        .to_string();
    assert!(error.contains("not closed, so it has no inside"), "{error}");
}

#[test]
fn reports_name_places_triangles_and_numbers_of_all_kinds_at_once() {
    // A hole, a crossing and a turned triangle in one mesh.
    let broken = with_triangles(&unit(), |t| t.truncate(11));
    let turned = with_triangles(&cube([0.5; 3], [3.0; 3]), |t| t[0].swap(0, 1));
    let report: MeshReport = together(&broken, &turned).check();
    assert_eq!(report.count(FlawKind::OpenEdge), 3);
    assert_eq!(report.count(FlawKind::MisorientedEdge), 3);
    assert!(report.count(FlawKind::Crossing) > 0);
    let text = report.to_string();
    for part in [
        "3 open edges",
        "wound in opposite ways",
        "crossings of triangles",
        "only triangle 4 has",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // The places of crossings lie on both triangles' planes.
    let mesh = together(&broken, &turned);
    for flaw in report
        .flaws()
        .iter()
        .filter(|f| f.kind == FlawKind::Crossing)
    {
        for &t in &flaw.triangles {
            let [a, b, c] = mesh.corners(t);
            let height = (b - a).cross(c - a).dot(flaw.places[0] - a);
            assert!(height.abs() < 1e-12, "{flaw:?}");
        }
    }
    // At most five of a kind are kept, all are counted.
    let many = (0..20).fold(unit(), |sum, i| {
        let x = f64::from(i) * 3.0;
        together(
            &sum,
            &cube([x + 3.0, 0.0, 0.0], [x + 4.0, 1.0, 1.0]).reversed(),
        )
    });
    let report = many.check();
    assert_eq!(report.count(FlawKind::InsideOut), 20);
    assert_eq!(report.flaws().len(), 5);
}

#[test]
fn a_large_mesh_is_checked_fast_enough_and_a_hopeless_one_is_given_up() {
    let mesh = torus(3.0, 1.0, 128, 64);
    let report = mesh.check();
    assert!(report.is_sound() && report.shells == 1);
    // A fan of needles whose boxes all overlap: refused rather than looked at for ever.
    let n = 9000_u32;
    let mut positions = vec![DVec3::ZERO, DVec3::new(0.0, 0.0, 2.0)];
    positions.extend((0..n).map(|i| {
        let (s, c) = libm::sincos(f64::from(i) / f64::from(n) * std::f64::consts::TAU);
        DVec3::new(c, s, 1.0)
    }));
    let triangles = (0..n).flat_map(|i| {
        let (a, b) = (2 + i, 2 + (i + 1) % n);
        [[0, b, a], [1, a, b]]
    });
    let fan = TriangleMesh::new(positions, triangles.collect()).unwrap();
    assert_eq!(counts(&fan), [(FlawKind::Unchecked, 1)]);
    // Triangles and their reverses through each other everywhere.
    let mut random = Random::new(8);
    let n = 3000_u32;
    let positions = (0..3 * n).map(|_| random.point(1.0)).collect();
    let pair = |i: u32| [[3 * i, 3 * i + 1, 3 * i + 2], [3 * i, 3 * i + 2, 3 * i + 1]];
    let tangle = TriangleMesh::new(positions, (0..n).flat_map(pair).collect()).unwrap();
    let report = tangle.check();
    assert!(report.is_closed() && !report.is_unambiguous());
    assert!(report.count(FlawKind::Crossing) > 10_000);
    assert_eq!(report.count(FlawKind::Unchecked), 1);
}
