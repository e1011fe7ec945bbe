//! Triangle meshes of different character, each with a place to look from and a light.
//!
//! Coordinates are numbers of 32 bits, so that all contenders see the same triangles.

mod building;
mod flake;
mod scan;
mod soup;
mod stadium;
mod terrain;

use octray::math::{DMat3, DVec3};
pub use soup::Soup;

/// A mesh and how it is looked at.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name on the command line and in tables.
    pub name: &'static str,
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// Triples of indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// Where the camera stands.
    pub eye: DVec3,
    /// What it looks at.
    pub target: DVec3,
    /// What is up.
    pub up: DVec3,
    /// Field of view in degrees.
    pub angle: f64,
    /// Where the point light is.
    pub light: DVec3,
}

/// All names with what they are.
pub const NAMES: [(&str, &str); 6] = [
    (
        "scan",
        "a scan of 86,482 triangles, of the corpus that OCTRAY_CORPUS names",
    ),
    (
        "building",
        "a court with colonnades, stairs and mouldings: long thin triangles",
    ),
    ("turned", "the same rotated off every axis"),
    ("flake", "spheres on spheres, 2.4 million triangles"),
    ("terrain", "a fractal landscape, 1 million triangles"),
    (
        "stadium",
        "a vessel of 250,000 triangles in a bowl a thousand times its size",
    ),
];

/// Makes the mesh of this name; in words why not.
pub fn make(name: &str) -> Result<Subject, String> {
    match name {
        "scan" => scan::make(),
        "building" => Ok(building::make("building", &DMat3::IDENTITY)),
        "turned" => {
            let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
            Ok(building::make("turned", &turn))
        }
        "flake" => Ok(flake::make()),
        "terrain" => Ok(terrain::make()),
        "stadium" => Ok(stadium::make()),
        _ => Err(format!("there is no mesh `{name}`")),
    }
}
