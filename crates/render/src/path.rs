//! Rays on their way: what an integrator takes and what it leaves behind.
//!
//! The states are small, flat and complete: a slice of them can wait in a queue or travel to
//! another process.

use octray_geometry::{FaceId, MaterialId};
use octray_math::{DVec3, Ray};
use octray_world::{Departure, RayQuery};

/// Why a ray is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RayKind {
    /// From the camera.
    Primary,
    /// From a mirror.
    Reflected,
    /// Through a surface.
    Refracted,
}

/// A ray whose light belongs to a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathState {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; any length.
    pub direction: DVec3,
    /// Names the path; all its random numbers descend from it.
    pub key: u64,
    /// What its light is multiplied by on its way to the pixel.
    pub throughput: [f32; 3],
    /// Index of the pixel in the film.
    pub pixel: u32,
    /// The surface it leaves.
    pub departure: Departure,
    /// 1 for a primary ray.
    pub generation: u32,
    /// Why it is traced.
    pub kind: RayKind,
    /// Whether its sample has an odd index.
    pub odd: bool,
}

/// A ray to a lamp and the light that it brings if nothing is in the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowState {
    /// The lit point.
    pub origin: DVec3,
    /// To the lamp, which is at `t = 1` if `is_finite`.
    pub direction: DVec3,
    /// Light that arrives in the pixel if nothing is in the way.
    pub light: [f32; 3],
    /// Index of the pixel in the film.
    pub pixel: u32,
    /// The face it leaves.
    pub face: FaceId,
    /// Instance of that face.
    pub instance: u32,
    /// The material that fills the space where it starts; `u32::MAX` for empty space.
    medium: u32,
    /// Whether it goes to the outward side of the face.
    pub outward: bool,
    /// Whether the lamp is at `t = 1`, else infinitely far.
    pub is_finite: bool,
    /// Whether its sample has an odd index.
    pub odd: bool,
}

// The sizes are part of the design: states are messages between processes.
const _: () = assert!(size_of::<PathState>() <= 96);
const _: () = assert!(size_of::<ShadowState>() <= 80);

impl PathState {
    /// What to ask of the world.
    #[must_use]
    pub const fn query(&self) -> RayQuery {
        RayQuery {
            ray: Ray::new(self.origin, self.direction),
            t_max: f64::INFINITY,
            departure: self.departure,
        }
    }

    /// The throughput as a vector.
    #[must_use]
    pub fn weight(&self) -> DVec3 {
        to_vector(self.throughput)
    }
}

impl ShadowState {
    /// Packs a shadow ray of `path`, which met a surface at `ray.origin`.
    #[must_use]
    pub fn new(
        path: &PathState,
        ray: Ray,
        is_finite: bool,
        departure: Departure,
        medium: Option<MaterialId>,
        light: DVec3,
    ) -> Self {
        Self {
            origin: ray.origin,
            direction: ray.direction,
            light: to_single(light),
            pixel: path.pixel,
            face: departure.face,
            instance: departure.instance,
            medium: medium.map_or(u32::MAX, |id| id.0),
            outward: departure.outward,
            is_finite,
            odd: path.odd,
        }
    }

    /// What to ask of the world.
    #[must_use]
    pub const fn query(&self) -> RayQuery {
        RayQuery {
            ray: Ray::new(self.origin, self.direction),
            t_max: if self.is_finite { 1.0 } else { f64::INFINITY },
            departure: Departure {
                face: self.face,
                instance: self.instance,
                outward: self.outward,
            },
        }
    }

    /// The material that fills the space where the ray starts, `None` for empty space.
    #[must_use]
    pub fn medium(&self) -> Option<MaterialId> {
        (self.medium != u32::MAX).then_some(MaterialId(self.medium))
    }
}

/// Rays that wait to be traced. An integrator appends, the driver takes the newest first.
#[derive(Clone, Debug, Default)]
pub struct Queues {
    /// Rays whose surface is to be shaded.
    pub paths: Vec<PathState>,
    /// Rays to lamps.
    pub shadows: Vec<ShadowState>,
}

/// Rounds to the precision in which light travels.
#[must_use]
pub fn to_single(light: DVec3) -> [f32; 3] {
    light.to_array().map(|channel| channel as f32)
}

/// Exact.
#[must_use]
pub fn to_vector(light: [f32; 3]) -> DVec3 {
    DVec3::from_array(light.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shadow_ray_unpacks_as_it_was_packed() {
        let path = PathState {
            origin: DVec3::ZERO,
            direction: DVec3::X,
            key: 1,
            throughput: [0.5; 3],
            pixel: 77,
            departure: Departure::NONE,
            generation: 1,
            kind: RayKind::Primary,
            odd: true,
        };
        let departure = Departure {
            face: FaceId(3),
            instance: 4,
            outward: false,
        };
        let ray = Ray::new(DVec3::Y, DVec3::Z);
        let light = DVec3::new(0.25, 0.5, 1.0);
        for medium in [None, Some(MaterialId(9))] {
            let shadow = ShadowState::new(&path, ray, true, departure, medium, light);
            let query = shadow.query();
            assert_eq!(
                (query.ray, query.t_max, query.departure),
                (ray, 1.0, departure)
            );
            assert_eq!(
                (shadow.medium(), shadow.pixel, shadow.odd),
                (medium, 77, true)
            );
            assert_eq!(to_vector(shadow.light), light);
        }
    }
}
