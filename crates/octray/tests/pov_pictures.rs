//! Scenes of the POV-Ray distribution against the pictures that POV-Ray makes of them.

mod corpus;

use std::path::Path;
use std::sync::Arc;

use corpus::corpus;
use octray::import::{Disk, Options, pov};
use octray::render::{Image, RenderConfig, develop, render};
use octray::scene::View;
use octray::world::{World, WorldConfig};

/// A scene, and how near its picture comes: the mean absolute difference in per cent, and the
/// share of the reference's edge pixels near one of ours in per cent, as measured.
const SCENES: [(&str, f64, f64); 15] = [
    ("advanced/lamppost", 0.156, 99.68),
    ("advanced/swirlbox", 0.455, 99.65),
    ("camera/focalblur", 1.289, 98.57),
    ("camera/orthographic", 0.000, 100.0),
    ("camera/perspective", 0.000, 100.0),
    ("incdemo/math", 0.000, 100.0),
    ("interior/crystal", 1.266, 100.0),
    ("interior/iortest", 0.163, 99.79),
    ("language/macros/macro1", 0.000, 100.0),
    ("lights/parallel_lights", 0.012, 100.0),
    ("objects/lathe1a", 0.000, 100.0),
    ("objects/polygon", 0.000, 100.0),
    ("objects/prism3a", 0.000, 100.0),
    ("objects/quartic/teardrop", 0.000, 100.0),
    ("objects/superel1", 0.000, 100.0),
];

/// 8-bit pixels, row by row from the top.
struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    fn read(path: &Path) -> Self {
        let image = image::open(path).expect("a reference picture").to_rgb8();
        Self {
            width: image.width() as usize,
            height: image.height() as usize,
            pixels: image.pixels().map(|p| p.0).collect(),
        }
    }

    /// As the scene says, one ray through the middle of each pixel.
    fn rendered(path: &Path, width: usize, height: usize) -> Self {
        let bytes = std::fs::read(path).expect("a scene");
        let imported = pov::import(path, bytes, &Disk, &Options::default());
        let messages = format!("{:?}", imported.diagnostics);
        let scene = imported.scene.expect(&messages);
        let world = World::prepare(Arc::new(scene), &WorldConfig::default()).expect("a world");
        let config = RenderConfig {
            size: Some((width as u32, height as u32)),
            ..RenderConfig::default()
        };
        let made = render(&world, None, &config, &()).expect("a picture");
        let image = Image::from_film(&made.film, made.encoding);
        let bytes = develop(&image, View::Standard);
        Self {
            width,
            height,
            pixels: bytes.as_chunks().0.to_vec(),
        }
    }

    /// In per cent of the full range.
    fn mean_difference(&self, other: &Self) -> f64 {
        let pairs = self.pixels.as_flattened().iter();
        let sum: u64 = pairs
            .zip(other.pixels.as_flattened())
            .map(|(a, b)| u64::from(a.abs_diff(*b)))
            .sum();
        100.0 * sum as f64 / (255 * 3 * self.pixels.len()) as f64
    }

    /// Pixels that differ from their right or lower neighbour by more than 32 in a channel.
    fn edges(&self) -> Vec<bool> {
        let differ = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).any(|(a, b)| a.abs_diff(b) > 32);
        let edge = |i: usize| {
            let here = self.pixels[i];
            let right = i % self.width + 1 < self.width && differ(here, self.pixels[i + 1]);
            let below = i / self.width + 1 < self.height;
            right || (below && differ(here, self.pixels[i + self.width]))
        };
        (0..self.pixels.len()).map(edge).collect()
    }

    /// The share, in per cent, of the edge pixels of `reference` with one of ours within a pixel.
    fn edges_found(&self, reference: &Self) -> f64 {
        let ours = self.edges();
        let near = |i: usize| {
            let (x, y) = (i % self.width, i / self.width);
            let rows = y.saturating_sub(1)..(y + 2).min(self.height);
            rows.into_iter().any(|y| {
                let row = &ours[y * self.width..(y + 1) * self.width];
                row[x.saturating_sub(1)..(x + 2).min(self.width)].contains(&true)
            })
        };
        let edges = reference.edges();
        let all = edges.iter().filter(|edge| **edge).count();
        let found = (0..edges.len()).filter(|&i| edges[i] && near(i)).count();
        100.0 * found as f64 / all as f64
    }
}

#[test]
fn plain_scenes_look_as_in_pov_ray() {
    let Some(folder) = corpus("pov") else { return };
    for (name, mean, edges) in SCENES {
        let scene = folder.join(name).with_extension("pov");
        let reference = Picture::read(&scene.with_extension("ref.png"));
        let ours = Picture::rendered(&scene, reference.width, reference.height);
        let difference = ours.mean_difference(&reference);
        let found = ours.edges_found(&reference);
        assert!(
            difference < 2.0 && found >= 97.0,
            "{name}: {difference} {found}"
        );
        // No worse than it was, up to a few pixels.
        assert!(
            difference < mean + 0.02 && found > edges - 0.1,
            "{name}: {difference:.4} % instead of {mean}, edges {found:.2} % instead of {edges}"
        );
    }
}

#[test]
fn the_procedural_databases_look_as_in_pov_ray() {
    let Some(folder) = corpus("spd") else { return };
    for name in ["balls_s2", "mount_s2", "tetra_s2", "tree_s2"] {
        let scene = folder.join(name).with_extension("pov");
        let reference = Picture::read(&scene.with_extension("png"));
        let ours = Picture::rendered(&scene, reference.width, reference.height);
        let difference = ours.mean_difference(&reference);
        let found = ours.edges_found(&reference);
        assert!(
            difference < 0.1 && found > 99.9,
            "{name}: {difference} {found}"
        );
    }
}
