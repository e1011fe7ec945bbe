//! Closed meshes, random numbers and rays for the tests of this crate.
#![allow(dead_code, reason = "each test program uses some of it")]

use octray_geometry::TriangleMesh;
use octray_math::{DMat3, DVec3, Ray, hash_combine, unit_f64};

/// Numbers that are the same in every run.
pub struct Random(u64, u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed, 0)
    }

    pub fn bits(&mut self) -> u64 {
        self.1 += 1;
        hash_combine(self.0, self.1)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// In `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * unit_f64(self.bits())
    }

    /// In the cube `[-size, size)^3`.
    pub fn point(&mut self, size: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(-size, size)))
    }
}

pub fn cuboid(low: DVec3, high: DVec3) -> TriangleMesh {
    let positions = (0..8)
        .map(|i| {
            DVec3::new(
                if i & 1 == 0 { low.x } else { high.x },
                if i & 2 == 0 { low.y } else { high.y },
                if i & 4 == 0 { low.z } else { high.z },
            )
        })
        .collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    TriangleMesh::new(positions, triangles).unwrap()
}

/// A unit sphere by subdivision of an octahedron: its vertices on the axes are exact.
pub fn sphere(levels: u32) -> TriangleMesh {
    let mut positions = vec![
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::NEG_X,
        DVec3::NEG_Y,
        DVec3::NEG_Z,
    ];
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    for _ in 0..levels {
        let mut next = Vec::new();
        for [a, b, c] in triangles {
            let mut mid = |i: u32, j: u32| {
                let p = (positions[i as usize] + positions[j as usize]).normalize();
                positions.push(p);
                positions.len() as u32 - 1
            };
            let (ab, bc, ca) = (mid(a, b), mid(b, c), mid(c, a));
            next.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = next;
    }
    TriangleMesh::new(positions, triangles).unwrap()
}

pub fn torus(major: f64, minor: f64, around: u32, across: u32) -> TriangleMesh {
    let turn = |i: u32, n: u32| libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
    let mut positions = Vec::new();
    for i in 0..around {
        let (s, c) = turn(i, around);
        for j in 0..across {
            let (sj, cj) = turn(j, across);
            let r = major + minor * cj;
            positions.push(DVec3::new(r * c, r * s, minor * sj));
        }
    }
    let index = |i: u32, j: u32| (i % around) * across + j % across;
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let quad = [
                index(i, j),
                index(i + 1, j),
                index(i + 1, j + 1),
                index(i, j + 1),
            ];
            triangles.push([quad[0], quad[1], quad[2]]);
            triangles.push([quad[0], quad[2], quad[3]]);
        }
    }
    TriangleMesh::new(positions, triangles).unwrap()
}

/// The same triangles with other positions: a function of the old position alone, so that a
/// closed mesh stays closed.
pub fn moved(mesh: &TriangleMesh, to: impl Fn(DVec3) -> DVec3) -> TriangleMesh {
    let positions = mesh.positions().iter().map(|&p| to(p)).collect();
    TriangleMesh::new(positions, mesh.triangles().to_vec()).unwrap()
}

/// All triangles of both.
pub fn together(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let first = a.positions().len() as u32;
    let positions = [a.positions(), b.positions()].concat();
    let moved = b.triangles().iter().map(|t| t.map(|i| i + first));
    TriangleMesh::new(
        positions,
        a.triangles().iter().copied().chain(moved).collect(),
    )
    .unwrap()
}

/// Closed meshes of all kinds: round, flat, thin, tiny, huge, off centre, rough.
pub fn zoo() -> Vec<(&'static str, TriangleMesh)> {
    let turned = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.4);
    let round = sphere(2);
    let ring = torus(2.0, 0.5, 12, 8);
    vec![
        ("cube", cuboid(DVec3::ZERO, DVec3::ONE)),
        (
            "slab",
            cuboid(-DVec3::ONE, DVec3::new(1.0, 1.0, -1.0 + 1e-9)),
        ),
        (
            "turned cube",
            moved(&cuboid(-DVec3::ONE, DVec3::ONE), |p| turned * p),
        ),
        ("sphere", round.clone()),
        (
            "ellipsoid",
            moved(&round, |p| p * DVec3::new(1.0, 1e-3, 30.0)),
        ),
        (
            "rough",
            moved(&round, |p| {
                let key = p
                    .to_array()
                    .iter()
                    .fold(1, |k, x| hash_combine(k, (x + 0.0).to_bits()));
                p * (0.5 + unit_f64(key))
            }),
        ),
        ("torus", ring.clone()),
        ("turned torus", moved(&ring, |p| turned * p)),
        ("on a grid", moved(&ring, |p| (p * 4.0).round() * 0.25)),
        ("tiny", moved(&round, |p| p * 1e-160)),
        ("huge", moved(&round, |p| p * 1e150)),
        ("far", moved(&round, |p| p + DVec3::new(1e9, -3e8, 7.0))),
    ]
}

/// Lines that aim at the weak spots of `mesh`.
pub fn nasty_ray(mesh: &TriangleMesh, random: &mut Random) -> Ray {
    let bounds = mesh.bounds();
    let size = bounds.half_size().max_element();
    let vertex = |random: &mut Random| {
        let triangle = random.below(mesh.triangles().len()) as u32;
        (triangle, mesh.corners(triangle)[random.below(3)])
    };
    let (triangle, p) = vertex(random);
    let [a, b, c] = mesh.corners(triangle);
    let on_edge = a + (b - a) * [0.5, 0.25, random.between(0.0, 1.0)][random.below(3)];
    let target = match random.below(4) {
        0 => p,
        1 => on_edge,
        2 => (a + b + c) / 3.0,
        _ => bounds.center() + random.point(size),
    };
    let axis = DVec3::AXES[random.below(3)] * size * [1.0, -1.0][random.below(2)];
    let direction = match random.below(6) {
        0 => axis,
        1 => b - a,
        2 => (b - a) + (c - a) * 0.5,
        3 => vertex(random).1 - target,
        4 => axis + DVec3::AXES[random.below(3)] * size,
        _ => random.point(size),
    };
    let direction = if direction == DVec3::ZERO {
        axis
    } else {
        direction
    };
    let origin = match random.below(3) {
        0 => target,
        1 => target - direction,
        _ => target - direction * random.between(-4.0, 4.0),
    };
    Ray::new(origin, direction)
}

/// Every triangle cut into four, `levels` times; vertices are not shared.
pub fn divided(mesh: &TriangleMesh, levels: u32) -> TriangleMesh {
    let mut positions = mesh.positions().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    for _ in 0..levels {
        let mut next = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                positions.push((positions[i as usize] + positions[j as usize]) * 0.5);
                positions.len() as u32 - 1
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = next;
    }
    TriangleMesh::new(positions, triangles).unwrap()
}
