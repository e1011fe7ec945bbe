//! How a surface answers light: the terms of Whitted's model (1980) as POV-Ray and NFF use them.
//!
//! Every formula of shading stands in this folder; integrators only combine them.

mod direction;
mod fresnel;
mod highlight;
mod whitted_surface;

pub use direction::{reflect, reflect_above, refract};
pub use fresnel::{dielectric_reflectance, metal_reflectivity};
pub use highlight::{highlight, metallic_tint};
pub use whitted_surface::{Scattering, WhittedSurface};
