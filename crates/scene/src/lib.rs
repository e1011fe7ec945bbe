//! The scene: plain, validated data with ids, in the words of the user.
//!
//! A [`Scene`] is valid by construction: [`SceneBuilder::build`] is the only way to make one.
//! Colours are linear Rec. 709 unless [`Encoding`] says otherwise; lengths have the scene's unit.

mod builder;
mod bytes;
mod camera;
mod instances;
mod light;
mod material;
mod object;
mod srgb;

pub use builder::{Scene, SceneBuilder, SceneError, Settings};
pub use bytes::SceneBytesError;
pub use camera::{Camera, Projection};
pub use instances::{Instances, InstancesError, Prototype};
pub use light::{Falloff, Light, LightKind};
pub use material::{
    Background, Color, ColorStop, Fade, Finish, Interior, Material, Pattern, Pigment, Reflection,
};
pub use object::{Object, ObjectId, Shape};
pub use srgb::{linear_to_srgb, srgb_to_linear};

pub use octray_geometry::MaterialId;

/// How the scene's colours relate to light: what [`Scene::encoding`] tells the image writer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoding {
    /// Colours are proportional to light.
    #[default]
    Linear,
    /// Colours are light to the power `1 / gamma` (POV-Ray's `assumed_gamma`); shading happens on
    /// the encoded values, as the scene's author saw it.
    Gamma(f64),
    /// Colours are sRGB-encoded and shading happens on the encoded values (POV-Ray scenes of
    /// before version 3.7 that name no gamma).
    Srgb,
}

/// How light becomes a displayed colour; the default of a scene, `--view` overrides it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// Khronos PBR Neutral: keeps base colours, compresses highlights. For parts and meshes.
    #[default]
    Neutral,
    /// The sRGB curve and clipping, nothing else. For scene languages that define their colours.
    Standard,
    /// No curve at all: the linear values, clipped.
    Raw,
}
