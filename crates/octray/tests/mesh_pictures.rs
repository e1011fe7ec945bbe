//! Scenes of triangles have one picture, whatever method makes it.

mod corpus;

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use corpus::corpus;
use octray::import::{Disk, Options, load};
use octray::render::{RenderConfig, render};
use octray::scene::Scene;
use octray::world::{Method, World, WorldConfig};

/// A hill of polygons, each an object, with smooth triangles, a ball, and a pane of glass.
fn hill() -> PathBuf {
    let mut text = String::from(
        "v\nfrom 1.2 -1.5 1.4\nat 0.5 0.5 0.1\nup 0 0 1\nangle 40\nhither 0.1\nresolution 64 48\n\
         b 0.2 0.3 0.5\nl 3 -2 4\nl -2 -1 3\nf 0.8 0.6 0.3 0.7 0.3 20 0 0\n",
    );
    let height = |x: f64, y: f64| 0.4 * x * (1.0 - x) * (y - 0.3) * (1.0 + 2.0 * x * y);
    let n = 14;
    for j in 0..n {
        for i in 0..n {
            let at = |i: i32, j: i32| {
                let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                (x, y, height(x, y))
            };
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for three in [[0, 1, 2], [0, 2, 3]] {
                text.push_str(if (i + j) % 2 == 0 { "p 3\n" } else { "pp 3\n" });
                for corner in three {
                    let (x, y, z) = corners[corner];
                    write!(text, "{x} {y} {z}").expect("writes");
                    text.push_str(if (i + j) % 2 == 0 {
                        "\n"
                    } else {
                        " 0.1 0.1 1\n"
                    });
                }
            }
        }
    }
    text.push_str("f 0.9 0.9 0.9 0.2 0.4 40 0.5 0\ns 0.5 0.5 0.2 0.15\n");
    text.push_str("f 0.2 0.9 0.9 0.1 0.4 40 0.7 1.2\np 4\n0.1 0.1 0.3\n0.9 0.1 0.3\n0.9 0.3 0.5\n0.1 0.3 0.5\n");
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hill.nff");
    std::fs::write(&path, text).expect("writes");
    path
}

/// The light of every pixel, to the bit.
fn picture(scene: &Arc<Scene>, method: Method) -> Vec<u64> {
    let config = WorldConfig {
        method,
        ..WorldConfig::default()
    };
    let world = World::prepare(Arc::clone(scene), &config).expect("a world");
    let config = RenderConfig {
        size: Some((64, 48)),
        ..RenderConfig::default()
    };
    let rendering = render(&world, None, &config, &()).expect("a picture");
    assert!(rendering.is_complete());
    let pixels = (0..48).flat_map(|y| (0..64).map(move |x| (x, y)));
    let light = pixels.flat_map(|(x, y)| rendering.film.mean(x, y).to_array());
    light.map(f64::to_bits).collect()
}

fn check(path: &Path) {
    let imported = load(path, &Disk, &Options::default());
    let scene = Arc::new(imported.scene.expect("a scene"));
    let expected = picture(&scene, Method::Brute);
    let colors: BTreeSet<&[u64]> = expected.chunks(3).collect();
    assert!(colors.len() > 300, "{} colours", colors.len());
    for method in Method::all() {
        assert!(
            picture(&scene, method) == expected,
            "{method} differs on {}",
            path.display()
        );
    }
}

#[test]
fn a_hill_of_polygons_has_one_picture() {
    check(&hill());
}

#[test]
fn the_databases_teapot_has_one_picture() {
    if let Some(folder) = corpus("spd") {
        check(&folder.join("teapot_s2.nff"));
    }
}
