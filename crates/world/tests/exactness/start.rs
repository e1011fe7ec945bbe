//! Rays that start inside of solids and exactly on their surfaces.

use std::sync::Arc;

use octray_geometry::{MeshRule, Solid, TriangleMesh};
use octray_math::{DVec3, Ray};
use octray_scene::ObjectId;
use octray_world::{Counters, Hit, Overlaps, RayQuery, Region};

use crate::draw::Draw;
use crate::subject::{Subject, cases};

fn closest(subject: &Subject, ray: Ray) -> Hit {
    let mut hits = Vec::new();
    let mut counters = Counters::default();
    subject
        .world
        .closest(&[RayQuery::new(ray)], &mut hits, &mut counters);
    hits[0]
}

/// What is in front of a ray: the nearest hit, all crossings and the chord it starts in agree.
fn ahead(subject: &Subject, ray: Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    let mut counters = Counters::default();
    let query = RayQuery::new(ray);
    subject
        .world
        .crossings(&query, false, &mut hits, &mut counters);
    assert_eq!(
        closest(subject, ray),
        hits.first().copied().unwrap_or(Hit::MISS)
    );
    let mut chords = Vec::new();
    let overlaps = Overlaps::Regions;
    subject
        .world
        .chords(&query, false, overlaps, &mut chords, &mut counters);
    let starts_inside = chords.first().is_some_and(|chord| chord.enter.t == 0.0);
    let leaves_first = hits.first().is_some_and(|hit| hit.from != Region::OUTSIDE);
    assert_eq!(starts_inside, leaves_first, "{ray:?} {hits:?} {chords:?}");
    assert!(hits.iter().all(|hit| hit.t > 0.0), "{ray:?} {hits:?}");
    hits
}

fn inside(object: u32) -> Region {
    Region::of(ObjectId(object))
}

#[test]
fn a_start_inside_sees_the_inside() {
    // A ball in a box in a ball, from within each of them.
    let subject = Subject::new([
        Solid::sphere(4.0).expect("valid"),
        Solid::cuboid(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("valid"),
        Solid::sphere(1.0).expect("valid"),
    ]);
    let to_ball = |p: DVec3, d: DVec3, r: f64| {
        let b = p.dot(d);
        -b + (b * b + r * r - p.length_squared()).sqrt()
    };
    let to_box = |p: DVec3, d: DVec3| {
        let walls = DVec3::new(
            2.0f64.copysign(d.x),
            2.0f64.copysign(d.y),
            2.0f64.copysign(d.z),
        );
        ((walls - p) / d).min_element()
    };
    for case in 0..cases(1000) {
        let draw = &mut Draw::new(90, case);
        let toward = draw.direction();
        let start = draw.direction() * draw.between(0.0, 0.99);
        let hits = ahead(&subject, Ray::new(start, toward));
        let expected = [
            (to_ball(start, toward, 1.0), inside(2), inside(1)),
            (to_box(start, toward), inside(1), inside(0)),
            (to_ball(start, toward, 4.0), inside(0), Region::OUTSIDE),
        ];
        assert_eq!(hits.len(), 3);
        for (hit, (t, from, to)) in hits.iter().zip(expected) {
            assert!((hit.t - t).abs() < 1e-13, "{hit:?} {t}");
            assert!(!hit.entering && hit.from == from && hit.to == to, "{hit:?}");
        }
    }
}

/// The box from the origin to `size` as twelve triangles.
fn mesh_box(size: DVec3) -> Solid {
    let corner = |i: u32| {
        let side = |bit: u32| f64::from(i >> bit & 1);
        size * DVec3::new(side(0), side(1), side(2))
    };
    // Counter-clockwise, seen from outside.
    let quads: [[u32; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let halves = quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let mesh = TriangleMesh::new((0..8).map(corner).collect(), halves.collect());
    Solid::mesh(Arc::new(mesh.expect("valid")), MeshRule::Strict).expect("closed")
}

#[test]
fn a_start_on_a_face_of_a_box_sees_what_lies_ahead_only() {
    let size = DVec3::new(1.0, 2.0, 3.0);
    check_starts_on_faces(size, &Solid::cuboid(DVec3::ZERO, size).expect("valid"));
    check_starts_on_faces(size, &mesh_box(size));
}

fn check_starts_on_faces(size: DVec3, solid: &Solid) {
    let subject = Subject::one(solid);
    for case in 0..cases(2000) {
        let draw = &mut Draw::new(91, case);
        let mut start = size * DVec3::new(draw.unit(), draw.unit(), draw.unit());
        let axis = draw.below(3);
        let upper = draw.chance(0.5);
        start[axis] = if upper { size[axis] } else { 0.0 };
        let mut toward = draw.direction();
        if case % 4 == 0 {
            // Towards the horizon.
            toward[axis] *= 10.0_f64.powf(draw.between(-5.0, 0.0));
        }
        if toward[axis].abs() < 1e-5 {
            // A millionth from the horizon it cannot be told.
            continue;
        }
        let hits = ahead(&subject, Ray::new(start, toward));
        if (toward[axis] > 0.0) == upper {
            assert_eq!(hits, [], "{start} {toward}");
            continue;
        }
        let walls = DVec3::from_array(std::array::from_fn(|i| {
            if toward[i] > 0.0 { size[i] } else { 0.0 }
        }));
        let t = ((walls - start) / toward).min_element();
        assert_eq!(hits.len(), 1, "{start} {toward} {hits:?}");
        assert!((hits[0].t - t).abs() < 1e-13 && hits[0].from == inside(0));
    }
}

/// Points with short coordinates that lie on curved surfaces exactly, with the outward normal.
fn exact_points() -> Vec<(Subject, Vec<(DVec3, DVec3)>)> {
    let at = DVec3::new;
    let signs = |v: DVec3| {
        (0..8).map(move |i| {
            let sign = |bit: i32| if i >> bit & 1 == 0 { 1.0 } else { -1.0 };
            v * at(sign(0), sign(1), sign(2))
        })
    };
    // 2^2 + 3^2 + 6^2 = 7^2, 1 + 2^2 + 2^2 = 3^2, 3^2 + 4^2 = 5^2.
    let triples = [at(2.0, 3.0, 6.0), at(6.0, 2.0, 3.0), at(7.0, 0.0, 0.0)];
    let ball = triples.into_iter().flat_map(signs).map(|p| (p, p));
    let round = |z: f64| {
        let ring = [at(3.0, 4.0, z), at(4.0, 3.0, z), at(5.0, 0.0, z)];
        ring.into_iter().flat_map(signs)
    };
    let tube = [0.0, 0.5, 1.25].into_iter().flat_map(round);
    let tube = tube.map(|p| (p, at(p.x, p.y, 0.0)));
    // Major radius 5, minor 1: the rings of the tops, the outermost and the innermost points.
    let tops = round(1.0).map(|p| (p, at(0.0, 0.0, p.z)));
    let sides = [4.0, 6.0].into_iter().flat_map(|r| {
        let outward = r - 5.0;
        [at(r, 0.0, 0.0), at(0.0, -r, 0.0)].map(|p| (p, p * outward))
    });
    vec![
        (
            Subject::one(&Solid::sphere(7.0).expect("valid")),
            ball.collect(),
        ),
        (
            Subject::one(&Solid::cylinder(5.0, -2.0, 2.0).expect("valid")),
            tube.collect(),
        ),
        (
            Subject::one(&Solid::torus(5.0, 1.0).expect("valid")),
            tops.chain(sides).collect(),
        ),
    ]
}

#[test]
fn a_start_on_a_curved_surface_sees_what_lies_ahead_only() {
    for (subject, points) in exact_points() {
        for (index, (start, normal)) in points.into_iter().enumerate() {
            for case in 0..cases(20) {
                let draw = &mut Draw::new(92 + index as u64, case);
                let toward = draw.direction();
                let steepness = toward.dot(normal.normalize());
                if steepness.abs() < 0.01 {
                    continue;
                }
                let hits = ahead(&subject, Ray::new(start, toward));
                let starts_inside = hits.len() % 2 == 1;
                assert_eq!(starts_inside, steepness < 0.0, "{start} {toward} {hits:?}");
                assert!(
                    hits.iter().all(|hit| hit.t > 1e-3),
                    "the surface itself is met: {start} {toward} {hits:?}"
                );
            }
        }
    }
}
