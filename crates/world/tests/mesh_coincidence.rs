//! Meshes as operands whose faces lie in faces of other operands: the solids are the same as those
//! made from exact boxes, crossing by crossing.
//!
//! `OCTRAY_CASES` multiplies the work of the default run, 20,000 lines. A million:
//! ```text
//! OCTRAY_CASES=50 cargo test --release -p octray-world --test mesh_coincidence -- --nocapture
//! ```
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(clippy::print_stdout, reason = "says how much was tried")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

#[path = "../../geometry/tests/meshes/mod.rs"]
mod meshes;

use std::sync::Arc;

use meshes::{Random, cuboid, divided, moved};
use octray_geometry::{MeshRule, Solid};
use octray_math::{DAffine3, DVec3, Ray};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Counters, Hit, Method, RayQuery, World, WorldConfig};

fn cases() -> usize {
    std::env::var("OCTRAY_CASES").map_or(1, |times| times.parse().unwrap())
}

/// A box with corners on a lattice of step 0.1, which no float is.
type Cells = [[f64; 2]; 3];

fn lattice_box(random: &mut Random) -> Cells {
    [0; 3].map(|_| {
        let a = random.below(4);
        let b = a + 1 + random.below(4 - a);
        [a as f64 * 0.1, b as f64 * 0.1]
    })
}

/// How a box is made.
#[derive(Clone, Copy, Debug)]
enum Made {
    Exact,
    /// A mesh that is moved like the exact box.
    Mesh,
    /// A mesh of many triangles whose vertices were moved before.
    MovedMesh,
}

fn solid(cells: &Cells, made: Made, frame: &DAffine3) -> Solid {
    let [x, y, z] = *cells;
    let (low, high) = (DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]));
    let mesh = cuboid(low, high);
    match made {
        Made::Exact => Solid::cuboid(low, high).unwrap().transform(*frame).unwrap(),
        Made::Mesh => Solid::mesh(Arc::new(mesh), MeshRule::Strict)
            .unwrap()
            .transform(*frame)
            .unwrap(),
        Made::MovedMesh => {
            let mesh = moved(&divided(&mesh, 2), |p| frame.transform_point3(p));
            Solid::mesh(Arc::new(mesh), MeshRule::Winding).unwrap()
        }
    }
}

fn world(objects: &[Solid], method: Method) -> World {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    for (index, solid) in objects.iter().enumerate() {
        builder.add_object(Object {
            // Boxes of one size would be ranked by how they were rounded.
            priority: index as i32,
            ..Object::solid("part", solid.clone(), material)
        });
    }
    let config = WorldConfig {
        method,
        ..WorldConfig::default()
    };
    World::prepare(Arc::new(builder.build().unwrap()), &config).unwrap()
}

fn crossings(world: &World, ray: Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    let query = RayQuery::new(ray);
    world.crossings(&query, true, &mut hits, &mut Counters::default());
    hits
}

fn frames(random: &mut Random) -> DAffine3 {
    let turn = random.point(3.0);
    let shift = random.point(2.0);
    let rotated = DAffine3::from_translation(shift)
        * DAffine3::from_rotation_x(turn.x)
        * DAffine3::from_rotation_y(turn.y)
        * DAffine3::from_rotation_z(turn.z);
    match random.below(5) {
        0 => DAffine3::IDENTITY,
        1 => DAffine3::from_translation(shift),
        2 => rotated * DAffine3::from_scale(DVec3::new(-3.0, 0.7, 11.0)),
        3 => DAffine3::from_translation(shift * 1e4) * rotated,
        _ => rotated,
    }
}

/// The next surface from a hit on, as light goes: on through it or back, in a new direction.
fn onwards(world: &World, ray: Ray, hit: &Hit, through: bool, direction: DVec3) -> Hit {
    let query = RayQuery::new(ray);
    let surface = world.interact(&query, hit);
    let outward = hit.entering != through;
    let side = if outward == (direction.dot(surface.normal) > 0.0) {
        1.0
    } else {
        -1.0
    };
    let next = RayQuery {
        ray: Ray::new(surface.position, direction * side),
        departure: hit.departure(outward),
        ..query
    };
    let mut hits = Vec::new();
    world.closest(&[next], &mut hits, &mut Counters::default());
    hits[0]
}

/// Boxes put together, each as given by `made`: one object, or every box its own.
fn build(
    boxes: &[Cells],
    operations: &[usize],
    made: impl Fn(usize) -> Made,
    frame: &DAffine3,
) -> Vec<Solid> {
    let mut parts = boxes
        .iter()
        .enumerate()
        .map(|(i, cells)| solid(cells, made(i), frame));
    if operations[0] == 3 {
        return parts.collect();
    }
    let first = parts.next().unwrap();
    let whole = parts
        .zip(operations)
        .fold(first, |whole, (part, op)| match op {
            0 => Solid::union([whole, part]),
            1 => Solid::difference([whole, part]),
            _ => Solid::intersection([whole, part]),
        });
    vec![whole]
}

#[test]
fn mesh_boxes_are_the_boxes_wherever_faces_coincide() {
    let mut random = Random::new(9);
    let (mut lines, mut compared, mut went_on) = (0, 0, 0);
    for case in 0..250 * cases() {
        let boxes: Vec<Cells> = (0..2 + random.below(3))
            .map(|_| lattice_box(&mut random))
            .collect();
        // Unions, differences and intersections mixed; or boxes side by side as objects.
        let separate = random.below(4) == 0;
        let operations: Vec<usize> = boxes
            .iter()
            .map(|_| {
                if separate {
                    3
                } else {
                    [0, 1, 0, 2][random.below(4)]
                }
            })
            .collect();
        let frame = frames(&mut random);
        let kinds: Vec<Made> = boxes
            .iter()
            .map(|_| [Made::Exact, Made::Mesh, Made::MovedMesh][random.below(3)])
            .collect();
        let exact = world(
            &build(&boxes, &operations, |_| Made::Exact, &frame),
            Method::Auto,
        );
        let meshed = build(&boxes, &operations, |i| kinds[i], &frame);
        let (tree, brute) = (world(&meshed, Method::Auto), world(&meshed, Method::Brute));
        for line in 0..80 {
            let mut point = || frame.transform_point3(DVec3::splat(0.2) + random.point(0.25));
            let (from, to) = (point(), point());
            let along = frame.transform_vector3(DVec3::AXES[line % 3]);
            let direction = if line % 4 == 0 { along } else { to - from };
            let ray = Ray::new(from - direction * 3.0, direction);
            let (truth, found) = (crossings(&exact, ray), crossings(&tree, ray));
            let context = format!("{case}: {boxes:?} {operations:?} {kinds:?} {frame:?} {ray:?}");
            assert_eq!(
                truth.len(),
                found.len(),
                "{context}\n{truth:#?}\n{found:#?}"
            );
            for (a, b) in truth.iter().zip(&found) {
                let apart = ray.at(a.t).distance(ray.at(b.t));
                assert!(
                    apart < 1e-9 * (1.0 + frame.translation.length() * 1e-3),
                    "{context}"
                );
                assert_eq!(
                    (a.entering, a.from, a.to),
                    (b.entering, b.from, b.to),
                    "{context}"
                );
            }
            let bent = frame.transform_vector3(random.point(1.0));
            for (a, b) in truth.iter().zip(&found) {
                for through in [false, true] {
                    let a = onwards(&exact, ray, a, through, bent);
                    let b = onwards(&tree, ray, b, through, bent);
                    assert_eq!(a.is_miss(), b.is_miss(), "{context} {bent} {a:?} {b:?}");
                    let apart = if a.is_miss() { 0.0 } else { (a.t - b.t).abs() };
                    assert!(apart * bent.length() < 1e-7, "{context} {bent} {a:?} {b:?}");
                    went_on += 1;
                }
            }
            if line % 8 == 0 {
                assert_eq!(found, crossings(&brute, ray), "{context}");
            }
            lines += 1;
            compared += truth.len();
        }
    }
    println!("{lines} lines, {compared} crossings, {went_on} rays from there on");
    assert!(2 * compared > lines);
}
