//! Prisms and lathes against formulas for their volumes, against the primitives they repeat, and
//! with rays aimed at their corners and edges.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use octray_geometry::Solid;
use octray_geometry::profile::{Edge, Outline, Region};
use octray_math::{DVec2, DVec3, Ray, hash_u64, transform, unit_f64};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Counters, Criteria, Method, RayQuery, World, WorldConfig};

fn world(solid: &Solid, method: Method) -> World {
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    builder.add_object(Object::solid("part", solid.clone(), material));
    let scene = Arc::new(builder.build().expect("valid"));
    let criteria = Criteria {
        max_depth: 7,
        visit_cost: 0.1,
        ..Criteria::default()
    };
    let config = WorldConfig {
        method,
        criteria,
        ..WorldConfig::default()
    };
    World::prepare(scene, &config).expect("no meshes")
}

/// Where a whole line enters and leaves.
fn crossings(world: &World, ray: Ray) -> Vec<(f64, bool)> {
    let mut hits = Vec::new();
    let mut counters = Counters::default();
    world.crossings(&RayQuery::new(ray), true, &mut hits, &mut counters);
    hits.iter().map(|hit| (hit.t, hit.entering)).collect()
}

/// How often the default number of rays is cast.
fn work() -> u64 {
    let cases = std::env::var("OCTRAY_CASES").ok();
    cases.and_then(|cases| cases.parse().ok()).unwrap_or(1)
}

/// Uniform numbers in `[-1, 1]`, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 += 1;
        unit_f64(hash_u64(self.0)) * 2.0 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

/// The volume by chords along a slanted direction through a grid of points of a plane, with the
/// error that `rays_across^2` rays leave.
fn volume(solid: &Solid, rays_across: u32) -> f64 {
    let world = world(solid, Method::Auto);
    let bounds = solid.bounds();
    let direction = DVec3::new(0.31, -0.22, 0.93).normalize();
    let (u, v) = direction.any_orthonormal_pair();
    let (center, reach) = (bounds.center(), 0.5 * bounds.diagonal());
    let step = 2.0 * reach / f64::from(rays_across);
    let mut sum = 0.0;
    for i in 0..rays_across {
        for j in 0..rays_across {
            let place = |k: u32| (f64::from(k) + 0.5) * step - reach;
            let origin = center + u * place(i) + v * place(j);
            for pair in crossings(&world, Ray::new(origin, direction)).chunks_exact(2) {
                sum += pair[1].0 - pair[0].0;
            }
        }
    }
    sum * step * step
}

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn polygon(corners: &[(f64, f64)]) -> Region {
    let corners: Vec<DVec2> = corners.iter().map(|&(x, y)| at(x, y)).collect();
    Region::polygon(&corners).expect("valid")
}

fn l_shape() -> Region {
    polygon(&[
        (0.0, 0.0),
        (3.0, 0.0),
        (3.0, 1.0),
        (1.0, 1.0),
        (1.0, 3.0),
        (0.0, 3.0),
    ])
}

/// A five-pointed star, its points on a circle of radius 1, drawn without lifting the pen.
fn star() -> Region {
    let corner = |i: u32| {
        let (sin, cos) = transform::sin_cos_degrees(144.0 * f64::from(i) + 90.0);
        at(cos, sin)
    };
    Region::polygon(&(0..5).map(corner).collect::<Vec<_>>()).expect("valid")
}

/// Twelve teeth with round tips, on a wheel with a round hole; with its area.
fn gear() -> (Region, f64) {
    let teeth = 12_u32;
    let (root, tip, hole) = (2.0, 2.5, 0.7);
    let around = |r: f64, tooth: u32, degrees: f64| {
        let (sin, cos) = transform::sin_cos_degrees(30.0 * f64::from(tooth) + degrees);
        at(r * cos, r * sin)
    };
    let arc = Edge::Arc {
        center: DVec2::ZERO,
        clockwise: false,
    };
    let mut outline = Outline::starting_at(around(root, 0, 0.0));
    for tooth in 0..teeth {
        outline.push(Edge::Line, around(tip, tooth, 3.0));
        outline.push(arc, around(tip, tooth, 12.0));
        outline.push(Edge::Line, around(root, tooth, 15.0));
        outline.push(arc, around(root, tooth + 1, 0.0));
    }
    // Sectors, and the triangles under the flanks.
    let degree = PI / 180.0;
    let sectors = 0.5 * (9.0 * tip * tip + 15.0 * root * root) * degree;
    let flanks = root * tip * libm::sin(3.0 * degree);
    let area = f64::from(teeth) * (sectors + flanks) - PI * hole * hole;
    let hole = Outline::circle(DVec2::ZERO, hole);
    (Region::new(&[outline, hole]).expect("valid"), area)
}

/// Two cubic curves, mirror images; with its area by Green's formula.
fn heart() -> (Region, f64) {
    let points = [at(0.0, -1.0), at(2.4, 0.4), at(1.0, 2.0), at(0.0, 0.6)];
    let mirrored = points.map(|p| at(-p.x, p.y));
    let mut outline = Outline::starting_at(points[0]);
    outline.push(Edge::Cubic(points[1], points[2]), points[3]);
    outline.push(Edge::Cubic(mirrored[2], mirrored[1]), mirrored[0]);
    // The integral of x y' for a cubic: binomial(3,i) binomial(3,j) times the integral of
    // B_i B_j', over all control points.
    let mut area = 0.0;
    for (i, p) in points.iter().enumerate() {
        for (j, q) in points.iter().enumerate() {
            area += 2.0 * p.x * q.y * INTEGRALS[i][j] / 20.0;
        }
    }
    (Region::new(&[outline]).expect("valid"), area)
}

/// 20 times the integrals of `B_i B_j'` over `[0, 1]`, for cubic Bernstein polynomials.
const INTEGRALS: [[f64; 4]; 4] = [
    [-10.0, 6.0, 3.0, 1.0],
    [-6.0, 0.0, 3.0, 3.0],
    [-3.0, -3.0, 0.0, 6.0],
    [-1.0, -3.0, -6.0, 10.0],
];

#[test]
fn volumes_of_prisms_are_area_times_height() {
    let star_area = 10.0 * (libm::sin(0.2 * PI) * star_waist()) * 0.5 - pentagon();
    for (name, region, area) in [
        ("L", l_shape(), 5.0),
        // Even-odd: the pentagon in the middle is not inside.
        ("star", star(), star_area),
        ("gear", gear().0, gear().1),
        ("heart", heart().0, heart().1),
    ] {
        let solid = Solid::prism(&region, -0.5, 1.5).expect("valid");
        let measured = volume(&solid, 400);
        let error = (measured / (2.0 * area) - 1.0).abs();
        assert!(error < 1e-3, "{name}: {measured} {}", 2.0 * area);
    }
}

/// Distance of a star's inner corners from its centre.
fn star_waist() -> f64 {
    libm::cos(0.4 * PI) / libm::cos(0.2 * PI)
}

/// Area of the pentagon in the middle of the star.
fn pentagon() -> f64 {
    2.5 * star_waist() * star_waist() * libm::sin(0.4 * PI)
}

#[test]
fn volumes_of_lathes_are_area_times_the_way_of_the_centroid() {
    // Pappus: the centroid's distance from the axis times a turn.
    let shift = |corners: &[(f64, f64)], x: f64| {
        polygon(&corners.iter().map(|&(a, b)| (a + x, b)).collect::<Vec<_>>())
    };
    let triangle = [(0.0, 0.0), (1.5, 0.5), (0.3, 2.0)];
    let area = 0.5 * (1.5 * 2.0 - 0.3 * 0.5);
    let concave = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5), (0.0, 2.0)];
    let mut bean = Outline::starting_at(at(1.0, -1.0));
    bean.push(Edge::Quadratic(at(4.0, 0.0)), at(1.0, 1.0));
    bean.push(Edge::Line, at(1.0, -1.0));
    // A parabola's segment is two thirds of its box, its centroid at two fifths of its height.
    let bean_volume = TAU * 2.0 * (1.0 + 0.4 * 1.5);
    for (name, region, expected) in [
        ("triangle", shift(&triangle, 1.0), TAU * area * (1.0 + 0.6)),
        (
            "triangle at the axis",
            shift(&triangle, 0.0),
            TAU * area * 0.6,
        ),
        ("notched", shift(&concave, 0.5), TAU * 1.5 * 2.5),
        (
            "parabola",
            Region::new(&[bean]).expect("valid"),
            bean_volume,
        ),
    ] {
        let measured = volume(&Solid::lathe(&region).expect("valid"), 300);
        assert!(
            (measured / expected - 1.0).abs() < 2e-3,
            "{name}: {measured} {expected}"
        );
    }
}

/// Compares two solids' crossings with random lines.
fn assert_same(name: &str, one: &Solid, other: &Solid, tolerance: f64) {
    let (one, other) = (world(one, Method::Auto), world(other, Method::Auto));
    let mut numbers = Numbers(1);
    let mut met = 0;
    for _ in 0..2000 * work() {
        let ray = Ray::new(numbers.vector() * 3.0, numbers.vector());
        let (a, b) = (crossings(&one, ray), crossings(&other, ray));
        // A line that grazes may be lost between two roundings.
        let grazes = |list: &[(f64, bool)]| list.windows(2).any(|w| w[1].0 - w[0].0 < 1e-6);
        if a.len() != b.len() && (grazes(&a) || grazes(&b)) {
            continue;
        }
        assert_eq!(a.len(), b.len(), "{name}: {ray:?} {a:?} {b:?}");
        met += usize::from(!a.is_empty());
        for (a, b) in a.iter().zip(&b) {
            let error = (a.0 - b.0).abs() * ray.direction.length();
            assert!(a.1 == b.1 && error < tolerance, "{name}: {error} {ray:?}");
        }
    }
    assert!(met > 100, "{name}: only {met} lines met it");
}

#[test]
fn turned_lines_and_arcs_are_cones_spheres_and_tori() {
    let lathe = |outline: Outline| {
        Solid::lathe(&Region::new(&[outline]).expect("valid")).expect("one side of the axis")
    };
    let cone = lathe(Outline::polygon(&[
        at(0.0, -1.0),
        at(1.5, -1.0),
        at(0.0, 2.0),
    ]));
    assert_same(
        "cone",
        &cone,
        &Solid::cone(1.5, 0.0, -1.0, 2.0).expect("valid"),
        1e-12,
    );
    let frustum = [at(0.0, -1.0), at(0.5, -1.0), at(1.5, 2.0), at(0.0, 2.0)];
    let frustum = lathe(Outline::polygon(&frustum));
    assert_same(
        "frustum",
        &frustum,
        &Solid::cone(0.5, 1.5, -1.0, 2.0).expect("valid"),
        1e-12,
    );
    let semicircle = |clockwise| {
        let (from, to) = if clockwise { (1.2, -1.2) } else { (-1.2, 1.2) };
        let mut outline = Outline::starting_at(at(0.0, from));
        let center = DVec2::ZERO;
        outline.push(Edge::Arc { center, clockwise }, at(0.0, to));
        lathe(outline)
    };
    let ball = Solid::sphere(1.2).expect("valid");
    assert_same("sphere", &semicircle(true), &ball, 1e-9);
    assert_same("sphere", &semicircle(false), &ball, 1e-9);
    let ring = lathe(Outline::circle(at(1.5, 0.0), 0.6));
    assert_same(
        "torus",
        &ring,
        &Solid::torus(1.5, 0.6).expect("valid"),
        1e-14,
    );
    // The same circle as four cubic curves differs by 3e-4 of its radius.
    let k = 0.6 * 0.552_284_749_8;
    let mut near = Outline::starting_at(at(2.1, 0.0));
    near.push(Edge::Cubic(at(2.1, k), at(1.5 + k, 0.6)), at(1.5, 0.6));
    near.push(Edge::Cubic(at(1.5 - k, 0.6), at(0.9, k)), at(0.9, 0.0));
    near.push(Edge::Cubic(at(0.9, -k), at(1.5 - k, -0.6)), at(1.5, -0.6));
    near.push(Edge::Cubic(at(1.5 + k, -0.6), at(2.1, -k)), at(2.1, 0.0));
    let measured = volume(&lathe(near), 300);
    let expected = 2.0 * PI * PI * 1.5 * 0.36;
    assert!(
        (measured / expected - 1.0).abs() < 2e-3,
        "{measured} {expected}"
    );
    // A lemon: an arc whose centre lies on the other side of the axis.
    let mut lemon = Outline::starting_at(at(0.0, -0.8));
    let center = at(-0.6, 0.0);
    lemon.push(
        Edge::Arc {
            center,
            clockwise: false,
        },
        at(0.0, 0.8),
    );
    let measured = volume(&lathe(lemon), 300);
    let (major, minor, s) = (0.6, 1.0, 0.8);
    let spindle = TAU / 3.0 * (2.0 * minor * minor + major * major) * s;
    let lemon = spindle - PI * minor * minor * major * (PI - 2.0 * libm::atan2(major, s));
    assert!((measured / lemon - 1.0).abs() < 3e-3, "{measured} {lemon}");
}

#[test]
fn a_cutter_whose_faces_coincide_leaves_no_skin() {
    let cube = Solid::cuboid(DVec3::ZERO, DVec3::new(3.0, 3.0, 2.0)).expect("valid");
    let cutter = Solid::prism(&l_shape(), 0.0, 2.0).expect("valid");
    let rest = Solid::cuboid(DVec3::new(1.0, 1.0, 0.0), DVec3::new(3.0, 3.0, 2.0)).expect("valid");
    let turn = transform::rotation_xyz_degrees(DVec3::new(20.0, -35.0, 50.0));
    let difference = Solid::difference([cube.clone(), cutter.clone()]);
    let together = Solid::union([rest.clone(), cutter.clone()]);
    for (name, one, other) in [
        ("cube - L", &difference, &rest),
        ("L + cube", &together, &cube),
    ] {
        assert_same(name, one, other, 1e-14);
        let turned = |solid: &Solid| solid.transform(turn).expect("rigid");
        assert_same(name, &turned(one), &turned(other), 1e-13);
    }
    let nothing = world(&Solid::difference([cutter.clone(), cutter]), Method::Auto);
    let mut numbers = Numbers(7);
    for _ in 0..1000 {
        let ray = Ray::new(numbers.vector() * 3.0, numbers.vector());
        assert!(crossings(&nothing, ray).is_empty());
    }
    // Round: a slot's end is the cylinder of the peg in it.
    let mut slot = Outline::starting_at(at(0.0, -0.5));
    let clockwise = false;
    slot.push(Edge::Line, at(2.0, -0.5));
    slot.push(
        Edge::Arc {
            center: at(2.0, 0.0),
            clockwise,
        },
        at(2.0, 0.5),
    );
    slot.push(Edge::Line, at(0.0, 0.5));
    slot.push(
        Edge::Arc {
            center: at(0.0, 0.0),
            clockwise,
        },
        at(0.0, -0.5),
    );
    let slot = Solid::prism(&Region::new(&[slot]).expect("valid"), 0.0, 1.0).expect("valid");
    let block = Solid::cuboid(DVec3::new(0.0, -0.5, 0.0), DVec3::new(2.0, 0.5, 1.0));
    let peg = |x: f64| {
        let peg = Solid::cylinder(0.5, 0.0, 1.0).expect("valid");
        peg.translate(DVec3::X * x).expect("finite")
    };
    let built = Solid::union([block.expect("valid"), peg(0.0), peg(2.0)]);
    assert_same("slot", &slot, &built, 1e-14);
    let rest = world(&Solid::difference([slot, built]), Method::Auto);
    for _ in 0..1000 {
        let ray = Ray::new(numbers.vector() * 2.0, numbers.vector());
        assert!(crossings(&rest, ray).is_empty(), "{ray:?}");
    }
}

#[test]
fn lines_at_corners_and_edges_enter_as_often_as_they_leave() {
    let corners = [
        at(0.0, 0.0),
        at(3.0, 0.0),
        at(3.0, 1.0),
        at(1.0, 1.0),
        at(1.0, 3.0),
    ];
    let star_corners: Vec<DVec2> = (0..5)
        .map(|i| {
            let (sin, cos) = transform::sin_cos_degrees(144.0 * f64::from(i) + 90.0);
            at(cos, sin)
        })
        .collect();
    let heart_corners = [at(0.0, -1.0), at(0.0, 0.6)];
    for (name, region, targets) in [
        ("L", l_shape(), &corners[..]),
        ("star", star(), &star_corners[..]),
        (
            "gear",
            gear().0,
            &[at(2.0, 0.0), at(0.7, 0.0), at(0.0, 2.0)][..],
        ),
        ("heart", heart().0, &heart_corners[..]),
    ] {
        let prism = Solid::prism(&region, 0.0, 1.0).expect("valid");
        let shifted: Vec<DVec3> = targets.iter().map(|p| p.extend(0.5)).collect();
        aim(name, &prism, &shifted);
        if name == "L" {
            let lathe = Solid::lathe(&region).expect("valid");
            let turned: Vec<DVec3> = targets.iter().map(|p| DVec3::new(p.x, 0.0, p.y)).collect();
            aim("turned L", &lathe, &turned);
        }
    }
    let mut vase = Outline::starting_at(at(0.0, 0.0));
    vase.push(Edge::Line, at(1.0, 0.0));
    vase.push(Edge::Cubic(at(2.0, 1.0), at(0.2, 1.0)), at(0.8, 2.0));
    vase.push(Edge::Quadratic(at(0.4, 1.0)), at(0.0, 0.5));
    let vase = Solid::lathe(&Region::new(&[vase]).expect("valid")).expect("valid");
    let targets = [at(1.0, 0.0), at(0.8, 2.0), at(0.0, 0.5), at(0.0, 0.0)];
    aim("vase", &vase, &targets.map(|p| DVec3::new(p.x, 0.0, p.y)));
}

/// Lines through the targets from near and far, along and across; also by brute force.
fn aim(name: &str, solid: &Solid, targets: &[DVec3]) {
    let (tree, brute) = (world(solid, Method::Auto), world(solid, Method::Brute));
    let mut numbers = Numbers(42);
    for round in 0..1500 * work() {
        let target = targets[round as usize % targets.len()];
        let next = targets[(round as usize + 1) % targets.len()];
        let direction = match round % 5 {
            0 => next - target,
            1 => DVec3::Z,
            2 => DVec3::new(numbers.next(), numbers.next(), 0.0),
            _ => numbers.vector(),
        };
        let target = match round % 3 {
            0 => target,
            1 => target + DVec3::Z * (0.5 * numbers.next()),
            _ => target + (next - target) * (0.5 + 0.5 * numbers.next()),
        };
        let far = [0.0, 1.0, 30.0, 1e4][round as usize % 4];
        let ray = Ray::new(target - direction * far, direction);
        let found = crossings(&tree, ray);
        assert_eq!(found, crossings(&brute, ray), "{name}: {ray:?}");
        assert!(found.len().is_multiple_of(2), "{name}: {ray:?} {found:?}");
        for (i, crossing) in found.iter().enumerate() {
            assert_eq!(crossing.1, i % 2 == 0, "{name}: {ray:?} {found:?}");
        }
    }
}

#[test]
fn pyramids_taper_to_a_point() {
    let square = polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]);
    let pyramid = Solid::tapered_prism(&square, [0.0, 3.0], [1.0, 0.0]).expect("valid");
    assert!((volume(&pyramid, 300) / 4.0 - 1.0).abs() < 2e-3);
    let notched = Solid::tapered_prism(&l_shape(), [0.0, 2.0], [0.5, 1.0]).expect("valid");
    let expected = 5.0 * 2.0 * (0.25 + 0.5 + 1.0) / 3.0;
    assert!((volume(&notched, 300) / expected - 1.0).abs() < 2e-3);
    let disc = Region::new(&[Outline::circle(DVec2::ZERO, 1.5)]).expect("valid");
    let cone = Solid::tapered_prism(&disc, [-1.0, 2.0], [1.0, 0.0]).expect("valid");
    assert_same(
        "cone",
        &cone,
        &Solid::cone(1.5, 0.0, -1.0, 2.0).expect("valid"),
        1e-300,
    );
    let (gear, area) = gear();
    let tapered = Solid::tapered_prism(&gear, [0.0, 3.0], [1.0, 0.5]).expect("valid");
    let expected = area * 3.0 * (1.0 + 0.5 + 0.25) / 3.0;
    assert!((volume(&tapered, 300) / expected - 1.0).abs() < 2e-3);
}

/// Corners and faces of a polygon drawn out: concave faces at its ends.
fn drawn_out(corners: &[(f64, f64)], height: f64) -> (Vec<DVec3>, Vec<Vec<u32>>) {
    let n = corners.len() as u32;
    let place = |z: f64| corners.iter().map(move |&(x, y)| DVec3::new(x, y, z));
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    for i in 0..n {
        let next = (i + 1) % n;
        faces.push(vec![i, next, next + n, i + n]);
    }
    (place(0.0).chain(place(height)).collect(), faces)
}

/// A cube with a pit in its top: 8 + 8 corners, a face with a hole as two concave ones.
fn pit() -> (Vec<DVec3>, Vec<Vec<u32>>) {
    let ring = |size: f64, z: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| DVec3::new(x * size, y * size, z))
    };
    let vertices = [
        ring(2.0, 0.0),
        ring(2.0, 3.0),
        ring(1.0, 3.0),
        ring(0.5, 1.0),
    ]
    .concat();
    let mut faces = vec![vec![3, 2, 1, 0], vec![12, 13, 14, 15]];
    for i in 0..4_u32 {
        let next = (i + 1) % 4;
        faces.push(vec![i, next, next + 4, i + 4]);
        faces.push(vec![i + 8, next + 8, next + 12, i + 12]);
    }
    // The rim, cut along two diagonals into two concave hexagons.
    faces.push(vec![4, 5, 6, 10, 9, 8]);
    faces.push(vec![6, 7, 4, 8, 11, 10]);
    (vertices, faces)
}

#[test]
fn concave_polyhedra_have_exact_planes() {
    let corners = [
        (0.0, 0.0),
        (3.0, 0.0),
        (3.0, 1.0),
        (1.0, 1.0),
        (1.0, 3.0),
        (0.0, 3.0),
    ];
    let (vertices, faces) = drawn_out(&corners, 2.0);
    let solid = Solid::exact_polyhedron(&vertices, &faces).expect("eight planes");
    let prism = Solid::prism(&l_shape(), 0.0, 2.0).expect("valid");
    assert_same("L", &solid, &prism, 1e-14);
    // Inside out it is the same solid.
    let turned: Vec<Vec<u32>> = faces
        .iter()
        .map(|f| f.iter().rev().copied().collect())
        .collect();
    let turned = Solid::polyhedron(&vertices, &turned).expect("closed");
    assert_same("turned L", &turned, &prism, 1e-14);
    let open = Solid::polyhedron(&vertices, &faces[1..]);
    assert!(open.is_err(), "a face is missing");

    let (vertices, faces) = pit();
    let solid = Solid::exact_polyhedron(&vertices, &faces).expect("a dozen planes");
    // A frustum of a pyramid is missing.
    let expected = 48.0 - 2.0 * (4.0 + 2.0 + 1.0) / 3.0;
    assert!((volume(&solid, 300) / expected - 1.0).abs() < 2e-3);
    let cube = Solid::cuboid(DVec3::new(-2.0, -2.0, 0.0), DVec3::new(2.0, 2.0, 3.0));
    let taper = polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]);
    let plug = Solid::tapered_prism(&taper, [1.0, 3.0], [0.5, 1.0]).expect("valid");
    assert_same(
        "filled",
        &Solid::union([solid.clone(), plug]),
        &cube.expect("valid"),
        1e-14,
    );
    aim("pit", &solid, &vertices);
}
