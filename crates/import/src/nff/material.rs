//! NFF's shading model in the terms of [`Material`].
//!
//! The format gives numbers, not formulas. These are the formulas that the databases' own
//! generators use when they write the same scenes for POV-Ray 3 (`*.pov` of the SPD package):
//! `Kd` is the diffuse term, `Ks` the mirror's share, `Shine` Phong's exponent; `T` is the share
//! of light that passes, tinted by the colour; lights without a colour have the strength
//! `1 / sqrt(number of lights)`. Colours are display values: nothing is gamma corrected.
//!
//! Two numbers that the generators have are lost in NFF. The amount of highlights is taken to be
//! the lesser of `Ks` and `Kd`, which is right for balls, gears and teapot (rings have 0.3 instead
//! of 0.2 and mount 0.4 instead of 0.1, which shows little). Ambient light goes to matte surfaces
//! only: what `Kd` leaves of 1.

use octray_math::DVec3;
use octray_scene::{Color, Finish, Interior, Material, Pigment, Reflection};

/// Generations of rays that the pictures have.
pub const MAX_GENERATIONS: u32 = 5;

/// Share of a pixel below which a ray is not followed.
pub const CONTRIBUTION_THRESHOLD: f64 = 1.0 / 255.0;

/// The numbers after `f`.
#[derive(Clone, Copy, Debug)]
pub struct Fill {
    /// Red, green, blue.
    pub color: DVec3,
    /// Diffuse.
    pub kd: f64,
    /// Specular.
    pub ks: f64,
    /// Phong's exponent.
    pub shine: f64,
    /// Transmittance.
    pub t: f64,
    /// Index of refraction; 0 and 1 both mean that nothing is bent.
    pub ior: f64,
}

impl Fill {
    /// The material.
    #[must_use]
    pub fn material(&self, name: &str) -> Material {
        let matte = self.ks == 0.0 && self.t == 0.0;
        let ambient = if matte { (1.0 - self.kd).max(0.0) } else { 0.0 };
        Material {
            name: name.to_owned(),
            pigment: Pigment::Uniform(Color {
                rgb: self.color,
                filter: self.t,
                transmit: 0.0,
            }),
            finish: Finish {
                ambient: DVec3::splat(ambient),
                diffuse: self.kd,
                phong: self.ks.min(self.kd),
                phong_size: self.shine,
                reflection: Reflection::constant(DVec3::splat(self.ks)),
                ..Finish::default()
            },
            interior: Interior {
                ior: if self.t > 0.0 && self.ior > 0.0 {
                    self.ior
                } else {
                    1.0
                },
                ..Interior::default()
            },
        }
    }
}

/// The colour of each of `count` lights that have none of their own.
#[must_use]
pub fn light_color(count: usize) -> DVec3 {
    DVec3::splat(1.0 / (count as f64).sqrt())
}
