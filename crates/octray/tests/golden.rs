//! The project's own scenes against the pictures that are kept beside them.
//!
//! The same scene gives the same bits on every machine, so the comparison is exact: by the octree on
//! one thread and on several, and by brute force. After an intended change, run with
//! `UPDATE_GOLDEN=1` and look at what changed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use octray::import::{Disk, Options, load};
use octray::render::{RenderConfig, encode_png, render};
use octray::world::{Method, World, WorldConfig};

const SIZE: (u32, u32) = (256, 144);

fn picture(path: &Path, method: Method, threads: usize) -> Vec<u8> {
    let imported = load(path, &Disk, &Options::default());
    assert_eq!(
        imported.diagnostics.iter().count(),
        0,
        "{:?}",
        imported.diagnostics
    );
    let scene = Arc::new(imported.scene.expect("a scene"));
    let view = scene.settings().view;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads");
    pool.install(|| {
        let config = WorldConfig {
            method,
            ..WorldConfig::default()
        };
        let world = World::prepare(scene, &config).expect("a world");
        let config = RenderConfig {
            size: Some(SIZE),
            ..RenderConfig::default()
        };
        let rendering = render(&world, None, &config, &()).expect("a picture");
        assert!(rendering.is_complete());
        encode_png(&rendering.image(), view).expect("encodes")
    })
}

fn check(scene: &str, brute: bool) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let path = root.join(scene);
    let expected_path = path.with_file_name("expected.png");
    let one = picture(&path, Method::Auto, 1);
    assert!(
        one == picture(&path, Method::Auto, 4),
        "{scene}: threads change the picture"
    );
    if brute {
        assert!(
            one == picture(&path, Method::Brute, 4),
            "{scene}: brute force differs"
        );
    }
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&expected_path, &one).expect("writes");
    }
    let pixels = |bytes: &[u8]| image::load_from_memory(bytes).expect("a PNG").to_rgb8();
    let expected = std::fs::read(&expected_path).unwrap_or_default();
    if expected.is_empty() || pixels(&expected) != pixels(&one) {
        let got = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(scene.replace('/', "_") + ".png");
        std::fs::write(&got, &one).expect("writes");
        panic!(
            "{scene} differs from {}: see {}",
            expected_path.display(),
            got.display()
        );
    }
}

#[test]
fn hello_is_the_same_everywhere() {
    check("hello/hello.pov", true);
}

#[test]
fn the_glass_is_the_same_everywhere() {
    check("glass/glass.pov", true);
}

#[test]
fn the_coupling_is_the_same_everywhere() {
    check("coupling/coupling.csg", true);
}

#[test]
fn the_workbench_is_the_same_everywhere() {
    // 73,728 triangles by brute force are for `octray render --accel brute`.
    check("workbench/workbench.pov", false);
}
