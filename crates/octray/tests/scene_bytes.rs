//! Scenes that went through bytes against those that did not: pictures and answers to the last bit.

mod corpus;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use corpus::corpus;
use octray::import::{Disk, Options, load};
use octray::math::{DVec3, Ray};
use octray::render::{Film, RenderConfig, render};
use octray::scene::Scene;
use octray::world::{Counters, Hit, RayQuery, World, WorldConfig};

const SIZE: (u32, u32) = (48, 36);

/// One scene for each kind of thing that a scene may hold.
const SELECTION: [&str; 22] = [
    "pov/advanced/swirlbox.pov",
    "pov/advanced/lamppost.pov",
    "pov/interior/crystal.pov",
    "pov/lights/parallel_lights.pov",
    "pov/objects/lathe1a.pov",
    "pov/objects/polygon.pov",
    "pov/objects/prism3a.pov",
    "pov/objects/quartic/teardrop.pov",
    "pov/objects/superel1.pov",
    "pov/camera/orthographic.pov",
    "openscad/dump/*.csg",
    "spd/balls_s2.nff",
    "spd/gears_s2.nff",
    "spd/mount_s2.nff",
    "spd/rings_s2.nff",
    "spd/teapot_s2.nff",
    "spd/tetra_s2.nff",
    "spd/tree_s2.nff",
    "ply/cube_uv.ply",
    "ply/cube_binary.ply",
    "obj/tinyobj/*.obj",
    "pov/objects/*.pov",
];

/// What rays from all around meet, and the light of a small picture.
fn answers(scene: Arc<Scene>) -> (Vec<Hit>, Option<Film>) {
    let world = World::prepare(scene, &WorldConfig::default()).expect("a world");
    let bounds = world.scene().bounds();
    let bounds = if bounds.is_empty() {
        None
    } else {
        Some(bounds)
    };
    let (center, size) = bounds.map_or((DVec3::ZERO, 1.0), |b| (b.center(), b.diagonal()));
    let queries: Vec<RayQuery> = (0..400)
        .map(|i| {
            let at = |n: f64| f64::from(i) * n % 2.0 - 1.0;
            let origin = center + DVec3::new(at(0.37), at(0.73), at(0.19)) * size;
            let target = center + DVec3::new(at(0.51), at(0.11), at(0.29)) * (0.3 * size);
            RayQuery::new(Ray::new(origin, target - origin))
        })
        .collect();
    let mut hits = Vec::new();
    world.closest(&queries, &mut hits, &mut Counters::default());
    let config = RenderConfig {
        size: Some(SIZE),
        ..RenderConfig::default()
    };
    // A scene without anything to look at has no camera.
    let rendering = render(&world, None, &config, &()).ok();
    (hits, rendering.map(|r| r.film))
}

fn check(path: &Path) {
    let imported = load(path, &Disk, &Options::default());
    // Files that are wrong on purpose have none.
    let Some(scene) = imported.scene else { return };
    let bytes = scene.to_bytes();
    assert_eq!(scene.to_bytes(), bytes);
    let name = path.display();
    let read = Scene::from_bytes(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(read.to_bytes() == bytes, "{name}");
    // What `Debug` shows is everything, numbers with all their digits.
    if bytes.len() < 1 << 20 {
        assert!(format!("{read:?}") == format!("{scene:?}"), "{name}");
    }
    assert!(
        answers(Arc::new(read)) == answers(Arc::new(scene)),
        "{name}"
    );
}

/// The files of a pattern whose last part may be `*.suffix`, at most six.
fn files(root: &Path, pattern: &str) -> Vec<PathBuf> {
    let Some((folder, suffix)) = pattern.split_once('*') else {
        return vec![root.join(pattern)];
    };
    let mut found: Vec<PathBuf> = std::fs::read_dir(root.join(folder))
        .expect("a folder")
        .map(|entry| entry.expect("readable").path())
        .filter(|path| path.to_string_lossy().ends_with(suffix))
        .collect();
    found.sort();
    let all = std::env::var_os("OCTRAY_CASES").is_some();
    found.truncate(if all { usize::MAX } else { 6 });
    found
}

#[test]
fn our_own_scenes_survive_bytes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut checked = 0;
    for folder in std::fs::read_dir(root).expect("scenes") {
        let folder = folder.expect("readable").path();
        if !folder.is_dir() {
            continue;
        }
        for file in std::fs::read_dir(folder).expect("a folder") {
            let path = file.expect("readable").path();
            if matches!(
                path.extension().and_then(|e| e.to_str()),
                Some("pov" | "csg")
            ) {
                check(&path);
                checked += 1;
            }
        }
    }
    assert!(checked >= 4, "{checked}");
}

#[test]
fn scenes_of_others_survive_bytes() {
    let Some(root) = corpus(".") else { return };
    for pattern in SELECTION {
        for path in files(&root, pattern) {
            assert!(path.exists(), "{}", path.display());
            check(&path);
        }
    }
}
