//! Closed meshes are entered as often as they are left: lines aimed at vertices and at points of
//! edges, in the planes of faces, along edges and axes.
//!
//! `OCTRAY_CASES` multiplies the work of the default run, 20,000 lines. A million takes some
//! seconds:
//! ```text
//! OCTRAY_CASES=50 cargo test --release -p octray-world --test mesh_watertight -- --nocapture
//! ```
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(clippy::print_stdout, reason = "says how much was tried")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

#[path = "../../geometry/tests/meshes/mod.rs"]
mod meshes;

use std::sync::Arc;

use meshes::{Random, cuboid, sphere, torus};
use octray_geometry::mesh::{MeshCrossing, MeshSolid};
use octray_geometry::{MeshRule, Solid, TriangleMesh};
use octray_math::{DAffine3, DMat3, DVec3, Ray};
use octray_scene::{Material, Object, SceneBuilder};
use octray_tree::{WalkCost, WideTreeConfig};
use octray_world::{Counters, Hit, Method, RayQuery, World, WorldConfig};

/// Distance from a shape's surface, negative inside.
type Distance = fn(DVec3) -> f64;

/// A closed mesh in a frame, with the shape that it stands for.
struct Specimen {
    name: &'static str,
    mesh: TriangleMesh,
    world_from_local: DAffine3,
    shape: Distance,
    /// How far the mesh may be from the shape, rounding included.
    error: f64,
}

fn box_distance(p: DVec3) -> f64 {
    (p.abs() - 1.0).max_element()
}

fn sphere_distance(p: DVec3) -> f64 {
    p.length() - 1.0
}

fn torus_distance(p: DVec3) -> f64 {
    let rho = libm::hypot(p.x, p.y) - 3.0;
    libm::hypot(rho, p.z) - 1.0
}

/// An L of unit cubes over (0, 0), (1, 0), (0, 1), each 4 by 4 by 4 cells of a grid of integers.
fn l_distance(p: DVec3) -> f64 {
    let low = (DVec3::ZERO - p).max_element();
    let high = (p - DVec3::new(8.0, 8.0, 4.0)).max_element();
    let notch = (4.0 - p.x).max(4.0 - p.y);
    low.max(high).max(-notch)
}

/// A double cone of height 2 and radius 1.
fn spindle_distance(p: DVec3) -> f64 {
    (libm::hypot(p.x, p.y) + p.z.abs() - 1.0) / std::f64::consts::SQRT_2
}

/// The boundary of the unit cells for which `filled`, two triangles per square.
fn cells(n: i32, filled: impl Fn([i32; 3]) -> bool) -> TriangleMesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let each = |i: i32| [i % n, i / n % n, i / n / n];
    for cell in (0..n * n * n).map(each).filter(|&c| filled(c)) {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = cell;
                beside[axis] += 2 * side - 1;
                if beside[axis] >= 0 && beside[axis] < n && filled(beside) {
                    continue;
                }
                let corner = |i: i32, j: i32| {
                    let mut c = cell;
                    c[axis] += side;
                    c[(axis + 1) % 3] += i;
                    c[(axis + 2) % 3] += j;
                    DVec3::from_array(c.map(f64::from))
                };
                let first = positions.len() as u32;
                positions.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
                let pair = if side == 1 {
                    [[0, 1, 2], [0, 2, 3]]
                } else {
                    [[0, 2, 1], [0, 3, 2]]
                };
                triangles.extend(pair.map(|t| t.map(|i| first + i)));
            }
        }
    }
    TriangleMesh::new(positions, triangles).unwrap()
}

/// A double cone of needles: `n` at either tip.
fn needles(n: u32) -> TriangleMesh {
    let mut positions = vec![DVec3::NEG_Z, DVec3::Z];
    positions.extend((0..n).map(|i| {
        let (s, c) = libm::sincos(f64::from(i) / f64::from(n) * std::f64::consts::TAU);
        DVec3::new(c, s, 0.0)
    }));
    let triangles = (0..n).flat_map(|i| {
        let (a, b) = (2 + i, 2 + (i + 1) % n);
        [[0, b, a], [1, a, b]]
    });
    TriangleMesh::new(positions, triangles.collect()).unwrap()
}

fn specimens() -> Vec<Specimen> {
    let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.4);
    let turned = DAffine3::from_mat3(turn);
    let far = DAffine3::from_mat3_translation(turn, DVec3::new(1e6, -7e5, 3e5));
    let still = DAffine3::IDENTITY;
    let l = cells(8, |[x, y, z]| z < 4 && (x < 4 || y < 4));
    let cube = cuboid(-DVec3::ONE, DVec3::ONE);
    let ring = || torus(3.0, 1.0, 96, 48);
    let of = |name, mesh, world_from_local, shape, error| Specimen {
        name,
        mesh,
        world_from_local,
        shape,
        error,
    };
    vec![
        of("cube", cube.clone(), still, box_distance, 1e-12),
        of("turned cube", cube.clone(), turned, box_distance, 1e-12),
        of("far cube", cube, far, box_distance, 1e-8),
        of("sphere", sphere(4), still, sphere_distance, 4e-3),
        of("far sphere", sphere(4), far, sphere_distance, 4e-3),
        of("torus", ring(), still, torus_distance, 8e-3),
        of("turned torus", ring(), turned, torus_distance, 8e-3),
        of("integers", l.clone(), still, l_distance, 1e-12),
        of("turned integers", l, turned, l_distance, 1e-11),
        of("needles", needles(1000), still, spindle_distance, 1e-5),
        of("far needles", needles(1000), far, spindle_distance, 1e-5),
        // Long and thin without symmetry.
        of(
            "sheared torus",
            ring(),
            turned * DAffine3::from_scale(DVec3::new(1e-4, 1.0, 30.0)),
            torus_distance,
            8e-3,
        ),
    ]
}

impl Specimen {
    /// The line goes through a vertex or through a point of an edge, as rounded.
    fn aimed_ray(&self, random: &mut Random) -> Ray {
        let n = self.mesh.triangles().len();
        let corners = |triangle: usize| {
            let corners = self.mesh.corners(triangle as u32);
            corners.map(|p| self.world_from_local.transform_point3(p))
        };
        let own = corners(random.below(n));
        let first = random.below(3);
        let [a, b, c] = [own[first], own[(first + 1) % 3], own[(first + 2) % 3]];
        let share = [0.5, 0.25, random.between(0.0, 1.0)][random.below(3)];
        let target = if random.below(2) == 0 {
            a
        } else {
            a + (b - a) * share
        };
        let size = (b - a).abs().max_element().max((c - a).abs().max_element());
        let side = [1.0, -1.0][random.below(2)];
        let other = corners(random.below(n))[random.below(3)];
        let direction = match random.below(8) {
            0 | 1 => random.point(size),
            2 => DVec3::AXES[random.below(3)] * side,
            3 => (b - a) * side,
            // In the plane of the face.
            4 => (b - a) * random.between(-1.0, 1.0) + (c - a) * random.between(-1.0, 1.0),
            5 => (b - a) + (c - a),
            6 => other - target,
            _ => DVec3::AXES[random.below(3)] + DVec3::AXES[random.below(3)] * side,
        };
        let direction = if direction == DVec3::ZERO {
            DVec3::ONE
        } else {
            direction
        };
        let back = [0.0, 1.0, random.between(-10.0, 10.0)][random.below(3)];
        Ray::new(target - direction * back, direction)
    }

    fn world(&self, method: Method) -> World {
        let solid = Solid::mesh(Arc::new(self.mesh.clone()), MeshRule::Strict).unwrap();
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        let solid = solid.transform(self.world_from_local).unwrap();
        builder.add_object(Object::solid(self.name, solid, material));
        let config = WorldConfig {
            method,
            ..WorldConfig::default()
        };
        World::prepare(Arc::new(builder.build().unwrap()), &config).unwrap()
    }

    /// Half way between two crossings it is inside or outside as they say, where that is clear.
    fn check_insides(&self, ray: &Ray, crossings: &[(f64, bool)]) -> usize {
        let local = self.world_from_local.inverse();
        let mut clear = 0;
        for pair in crossings.windows(2) {
            let middle = local.transform_point3(ray.at(0.5 * (pair[0].0 + pair[1].0)));
            let distance = (self.shape)(middle);
            if distance.abs() > self.error {
                assert_eq!(
                    distance < 0.0,
                    pair[0].1,
                    "{}: {ray:?} {crossings:?}",
                    self.name
                );
                clear += 1;
            }
        }
        clear
    }
}

/// In the world parameters are rounded once more, to those of the ray as given: a graze of an edge
/// may begin and end at the same one.
fn alternate(name: &str, ray: &Ray, crossings: &[(f64, bool)]) {
    assert!(
        crossings.len().is_multiple_of(2),
        "{name}: {ray:?} {crossings:?}"
    );
    for (i, pair) in crossings.windows(2).enumerate() {
        assert!(pair[0].0 <= pair[1].0, "{name}: {ray:?} {crossings:?}");
        assert_eq!(pair[0].1, i % 2 == 0, "{name}: {ray:?} {crossings:?}");
    }
    let last = crossings.last().is_none_or(|last| !last.1);
    assert!(last, "{name}: {ray:?} {crossings:?}");
}

fn lines_in_all() -> usize {
    let times = std::env::var("OCTRAY_CASES").map_or(1, |times| times.parse().unwrap());
    20_000 * times
}

#[test]
fn aimed_lines_enter_and_leave_in_turn() {
    let specimens = specimens();
    let each = lines_in_all() / specimens.len() + 1;
    // Trying every triangle takes long: of many lines only some are tried that way.
    let every = each.div_ceil(400).max(1);
    let (mut lines, mut crossed, mut compared, mut clear) = (0, 0, 0, 0);
    for (seed, specimen) in specimens.iter().enumerate() {
        let name = specimen.name;
        let mesh = Arc::new(specimen.mesh.clone());
        let config = WideTreeConfig::default();
        let place = &specimen.world_from_local;
        let tree = MeshSolid::new(&mesh, place, Some(&config)).unwrap();
        let brute = MeshSolid::new(&mesh, place, None).unwrap();
        let [world, brute_world] =
            [Method::Auto, Method::Brute].map(|method| specimen.world(method));
        let of_solid = |solid: &MeshSolid, ray: &Ray| {
            let mut out: Vec<MeshCrossing> = Vec::new();
            solid.crossings(ray, &mut out, &mut WalkCost::default());
            out
        };
        let of_world = |world: &World, ray: &Ray| {
            let mut out: Vec<Hit> = Vec::new();
            let query = RayQuery::new(*ray);
            world.crossings(&query, true, &mut out, &mut Counters::default());
            out
        };
        let mut random = Random::new(100 + seed as u64);
        for line in 0..each {
            let ray = specimen.aimed_ray(&mut random);
            let mut entries = [0_u32; 2];
            let all = octray_math::Interval::ALL;
            let (mut memory, mut cost) = Default::default();
            tree.triangles()
                .all(&ray, all, &mut memory, &mut cost, |_, hit| {
                    entries[usize::from(hit.entering)] += 1;
                });
            assert_eq!(entries[0], entries[1], "{name}: {ray:?}");
            let found = of_solid(&tree, &ray);
            let plain: Vec<_> = found.iter().map(|c| (c.t, c.entering)).collect();
            alternate(name, &ray, &plain);
            let rises = found.windows(2).all(|w| w[0].t < w[1].t);
            assert!(rises, "{name}: {ray:?} {found:?}");
            let hits = of_world(&world, &ray);
            let plain: Vec<_> = hits.iter().map(|h| (h.t, h.entering)).collect();
            alternate(name, &ray, &plain);
            clear += specimen.check_insides(&ray, &plain);
            if line % every == 0 {
                assert_eq!(found, of_solid(&brute, &ray), "{name}: {ray:?}");
                assert_eq!(hits, of_world(&brute_world, &ray), "{name}: {ray:?}");
                compared += 1;
            }
            lines += 1;
            crossed += usize::from(!hits.is_empty());
        }
    }
    println!("{lines} lines, {crossed} crossed, {compared} compared, {clear} intervals clear");
    assert!(crossed > lines / 2 && clear > lines / 2 && compared > 2000);
}
