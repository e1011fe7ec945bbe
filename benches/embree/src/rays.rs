//! The rays that every contender gets, and what they really meet.

use octray::math::{DVec3, Ray, hash_combine, unit_f64};
use octray::world::{Counters, Hit, RayQuery, World};

use crate::meshes::Subject;

/// Which rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the camera, in Morton order of the pixels: 64 in a row are a square of eight by eight.
    Primary,
    /// From where those met something, into the half-space over it with the density of the cosine.
    Diffuse,
    /// From there to the light: is anything between?
    Shadow,
}

impl Kind {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Primary, Self::Diffuse, Self::Shadow];

    /// On the command line and in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Diffuse => "diffuse",
            Self::Shadow => "shadow",
        }
    }
}

/// Rays of one kind, in both forms, and the answers of octray's world.
#[derive(Clone, Debug)]
pub struct Rays {
    /// Which.
    pub kind: Kind,
    /// Origins by axis.
    pub origin: [Vec<f32>; 3],
    /// Directions by axis.
    pub direction: [Vec<f32>; 3],
    /// All of them end here.
    pub end: f32,
    /// The same rays, exactly.
    pub queries: Vec<RayQuery>,
    /// What they meet (of shadow rays, what is nearest).
    pub hits: Vec<Hit>,
}

impl Rays {
    fn new(kind: Kind, rays: impl Iterator<Item = Ray>, world: &World) -> Self {
        let end = if kind == Kind::Shadow {
            1.0
        } else {
            f32::INFINITY
        };
        let mut all = Self {
            kind,
            origin: Default::default(),
            direction: Default::default(),
            end,
            queries: Vec::new(),
            hits: Vec::new(),
        };
        for ray in rays {
            let [origin, direction] = [ray.origin, ray.direction].map(|v| v.as_vec3());
            for axis in 0..3 {
                all.origin[axis].push(origin[axis]);
                all.direction[axis].push(direction[axis]);
            }
            all.queries.push(RayQuery {
                t_max: f64::from(end),
                ..RayQuery::new(Ray::new(origin.as_dvec3(), direction.as_dvec3()))
            });
        }
        world.closest(&all.queries, &mut all.hits, &mut Counters::default());
        all
    }

    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.queries.len()
    }

    /// Through the middles of `size` by `size` pixels; `size` is a power of two.
    pub fn primary(subject: &Subject, world: &World, size: u32) -> Self {
        let forward = (subject.target - subject.eye).normalize();
        let right = forward.cross(subject.up).normalize();
        let down = forward.cross(right);
        let half = (subject.angle.to_radians() / 2.0).tan();
        let pixel = |index: u32| {
            let [x, y] = [index, index >> 1].map(|code| {
                let across = f64::from(every_other_bit(code)) + 0.5;
                half * (2.0 * across / f64::from(size) - 1.0)
            });
            Ray::new(subject.eye, (forward + right * x + down * y).normalize())
        };
        Self::new(Kind::Primary, (0..size * size).map(pixel), world)
    }

    /// One from each place where these met something; `kind` is not primary.
    pub fn spawn(&self, kind: Kind, subject: &Subject, world: &World) -> Self {
        let spawned = self.queries.iter().zip(&self.hits).enumerate();
        let spawned = spawned.filter(|(_, (_, hit))| !hit.is_miss());
        let rays = spawned.map(|(index, (query, hit))| {
            let corners = subject.triangles[hit.face.0 as usize];
            let [a, b, c] =
                corners.map(|i| DVec3::from(subject.positions[i as usize].map(f64::from)));
            let normal = (b - a).cross(c - a).normalize();
            let normal = normal * -normal.dot(query.ray.direction).signum();
            let place = query.ray.at(hit.t);
            // Off the surface by more than the rounding to 32 bits, for the sake of the others.
            let off = 1e-5 * (place.abs().max_element() + hit.t * query.ray.direction.length());
            let origin = place + normal * off;
            let direction = match kind {
                Kind::Shadow => subject.light - origin,
                _ => cosine(normal, index as u64),
            };
            Ray::new(origin, direction)
        });
        Self::new(kind, rays, world)
    }
}

/// A unit vector with the density of the cosine to `normal`, the same for the same index.
fn cosine(normal: DVec3, index: u64) -> DVec3 {
    let random = |which| unit_f64(hash_combine(index, which));
    let (square, angle) = (random(0), std::f64::consts::TAU * random(1));
    let (x, y) = normal.any_orthonormal_pair();
    let side = x * angle.cos() + y * angle.sin();
    side * square.sqrt() + normal * (1.0 - square).sqrt()
}

/// Bits 0, 2, 4, ... of a number, side by side.
const fn every_other_bit(mut code: u32) -> u32 {
    code &= 0x5555_5555;
    code = (code | code >> 1) & 0x3333_3333;
    code = (code | code >> 2) & 0x0f0f_0f0f;
    code = (code | code >> 4) & 0x00ff_00ff;
    (code | code >> 8) & 0xffff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_morton_code_is_two_numbers() {
        for (x, y) in [(0, 0), (5, 3), (1023, 512), (65_535, 1)] {
            let code = (0..16).fold(0, |code, bit| {
                code | (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1)
            });
            assert_eq!((every_other_bit(code), every_other_bit(code >> 1)), (x, y));
        }
    }
}
