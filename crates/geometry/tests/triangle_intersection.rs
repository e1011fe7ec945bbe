//! Lines through vertices, through edges and along faces must not slip through a closed mesh.
#![allow(clippy::unwrap_used, reason = "tests may fail loudly")]
#![allow(unreachable_pub, reason = "modules shared by test programs")]

mod meshes;

use meshes::{Random, nasty_ray, zoo};
use octray_geometry::TriangleMesh;
use octray_geometry::mesh::{MeshCrossing, TriangleRay};
use octray_math::{DVec3, Ray};

fn crossings(mesh: &TriangleMesh, ray: &Ray) -> Vec<MeshCrossing> {
    let mut out = Vec::new();
    mesh.crossings_brute_force(ray, &mut out);
    out.sort_by(|x, y| x.t.total_cmp(&y.t).then(y.entering.cmp(&x.entering)));
    out
}

#[test]
fn every_line_leaves_a_closed_mesh_as_often_as_it_enters_it() {
    let mut crossed = 0;
    for (seed, (name, mesh)) in zoo().into_iter().enumerate() {
        mesh.check_closed().unwrap();
        let mut random = Random::new(seed as u64);
        for _ in 0..12_000 {
            let ray = nasty_ray(&mesh, &mut random);
            let found = crossings(&mesh, &ray);
            crossed += usize::from(!found.is_empty());
            let entries = found.iter().filter(|x| x.entering).count();
            assert_eq!(2 * entries, found.len(), "{name}: {ray:?}: {found:?}");
            // One inside the other never happens here, so the depth is 0 or 1, but for crossings
            // that rounding may exchange: those that lie together up to rounding.
            let scale = |p: DVec3| (p - ray.origin).abs().max_element();
            let reach = scale(mesh.bounds().min).max(scale(mesh.bounds().max));
            let slack = 1e-12 * reach / ray.direction.abs().max_element();
            let mut depth = 0;
            for (i, x) in found.iter().enumerate() {
                depth += if x.entering { 1 } else { -1 };
                let near = found.get(i + 1).is_some_and(|y| y.t - x.t <= slack);
                assert!(
                    near || depth == 0 || depth == 1,
                    "{name}: {ray:?}: {found:?}"
                );
            }
        }
    }
    assert!(crossed > 80_000, "{crossed}");
}

#[test]
fn a_line_through_a_vertex_of_a_fan_meets_one_front_and_one_back() {
    let mesh = meshes::sphere(2);
    for axis in DVec3::AXES {
        for sign in [1.0, -1.0] {
            let found = crossings(&mesh, &Ray::new(-3.0 * sign * axis, sign * axis));
            let summary: Vec<_> = found.iter().map(|x| (x.t, x.entering)).collect();
            assert_eq!(summary, [(2.0, true), (4.0, false)]);
        }
    }
}

#[test]
fn the_order_of_corners_changes_only_the_side() {
    let mut random = Random::new(77);
    let mut hits = 0;
    for _ in 0..20_000 {
        let [a, b, c] = [0; 3].map(|_| random.point(1.0));
        let target = (a + b + c) / 3.0 + random.point(0.2);
        let origin = random.point(3.0);
        let line = TriangleRay::new(&Ray::new(origin, target - origin));
        let Some(hit) = line.intersect([a, b, c]) else {
            assert_eq!(line.intersect([c, b, a]), None);
            continue;
        };
        hits += 1;
        let turned = line.intersect([b, c, a]).unwrap();
        let flipped = line.intersect([a, c, b]).unwrap();
        assert_eq!((hit.t, hit.entering), (turned.t, turned.entering));
        assert_eq!((hit.t, hit.entering), (flipped.t, !flipped.entering));
        let [u, v, w] = hit.barycentric;
        assert_eq!([v, w, u], turned.barycentric);
        let front = (b - a).cross(c - a).dot(target - origin) < 0.0;
        assert_eq!(hit.entering, front);
        let point = a * u + b * v + c * w;
        let error = (point - (origin + (target - origin) * hit.t)).length();
        assert!(error < 1e-12, "{error}");
    }
    assert!(hits > 10_000);
}

#[test]
fn parameters_agree_with_exact_rationals() {
    type V = [i128; 3];
    let sub = |p: V, q: V| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: V, q: V| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let cross = |p: V, q: V| {
        [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ]
    };
    let real = |p: V| DVec3::from_array(p.map(|x| x as f64));
    let mut random = Random::new(5);
    let (mut hits, mut worst) = (0, 0.0f64);
    for _ in 0..200_000 {
        let mut point = || [0; 3].map(|_: i32| random.below(2049) as i128 - 1024);
        let (a, b, c, o, q) = (point(), point(), point(), point(), point());
        let d = sub(q, o);
        if d == [0; 3] {
            continue;
        }
        let normal = cross(sub(b, a), sub(c, a));
        let facing = dot(normal, d);
        // Six times the volumes of the origin, the line and an edge: exact, and of one sign for a
        // hit (Plücker).
        let side = |p: V, q: V| dot(d, cross(sub(p, o), sub(q, o)));
        let sides = [side(b, c), side(c, a), side(a, b)];
        let hit = TriangleRay::new(&Ray::new(real(o), real(d))).intersect([a, b, c].map(real));
        let (low, high) = (*sides.iter().min().unwrap(), *sides.iter().max().unwrap());
        if low > 0 || high < 0 {
            // Coordinates of 11 bits leave shears exact enough for any strict inside.
            let hit = hit.unwrap();
            hits += 1;
            assert_eq!(hit.entering, facing < 0);
            let exact = dot(normal, sub(a, o)) as f64 / facing as f64;
            let extent = 4096.0 / real(d).abs().max_element();
            // Shearing moves a vertex by an ulp: t moves by that times the slope of the plane.
            let slope = real(normal).length() * real(d).length() / facing.abs() as f64;
            worst = worst.max((hit.t - exact).abs() / (extent * slope));
        } else if low < 0 && high > 0 {
            assert_eq!(hit, None);
        }
    }
    assert!(hits > 10_000, "{hits}");
    assert!(worst < 1e-15, "{worst}");
}

#[test]
fn flat_triangles_and_broken_rays_hit_nothing() {
    let line = TriangleRay::new(&Ray::new(DVec3::new(0.0, 0.0, -1.0), DVec3::Z));
    let [o, x] = [DVec3::ZERO, DVec3::X];
    assert_eq!(line.intersect([-x, o, x]), None);
    assert_eq!(line.intersect([o, o, x]), None);
    assert_eq!(line.intersect([o, o, o]), None);
    // In a plane through the line.
    assert_eq!(line.intersect([-x, x, DVec3::Z]), None);
    for direction in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        let line = TriangleRay::new(&Ray::new(DVec3::ZERO, direction));
        assert_eq!(line.intersect([-x, x, DVec3::new(0.1, 2.0, 3.0)]), None);
    }
}
