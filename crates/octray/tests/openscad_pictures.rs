//! Dumps against OpenSCAD itself: silhouettes of its pictures, volumes of its exports.
//!
//! OpenSCAD's polyhedra are made throughout (`facets`), so that both show the same solid.

mod corpus;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use corpus::corpus;
use octray_import::{Disk, Options, openscad};
use octray_math::{Aabb, DVec3, Ray, transform};
use octray_scene::Scene;
use octray_world::{Counters, RayQuery, Region, World, WorldConfig};

/// The scene of a dump, with OpenSCAD's polyhedra; `None` if something in it is not supported.
fn scene(path: &Path) -> Option<Scene> {
    let options = Options {
        facets: true,
        ..Options::default()
    };
    let bytes = std::fs::read(path).expect("a dump");
    let imported = openscad::import(path, bytes, &Disk, &options);
    let mut messages = imported.diagnostics.iter();
    if messages.any(|d| d.message.contains("supported")) {
        return None;
    }
    imported.scene
}

fn world(scene: Scene) -> World {
    World::prepare(Arc::new(scene), &WorldConfig::default()).expect("a world")
}

/// Pixels that something is on, row by row from the top.
struct Silhouette {
    size: usize,
    covered: Vec<bool>,
}

impl Silhouette {
    /// What is not of the colour of the upper left corner.
    fn of_picture(path: &Path) -> Self {
        let picture = image::open(path).expect("a picture").to_rgb8();
        let size = picture.width() as usize;
        assert_eq!(picture.height() as usize, size);
        let background = *picture.get_pixel(0, 0);
        let covered = picture.pixels().map(|pixel| *pixel != background).collect();
        Self { size, covered }
    }

    /// Seen as OpenSCAD sees a model in `bounds` when it is given no camera: field of view 22.5
    /// degrees, turned by -25 degrees about z, then tilted by 35 about x.
    fn of_world(world: &World, bounds: Aabb, size: usize) -> Self {
        let half_view = 11.25_f64.to_radians();
        let distance = bounds.diagonal() / 2.0 / half_view.sin();
        let view_from_world = transform::rotation_degrees(DVec3::X, 35.0)
            * transform::rotation_degrees(DVec3::Z, -25.0);
        let world_from_view = view_from_world.inverse();
        let turn = |v: DVec3| world_from_view.transform_vector3(v);
        let eye = bounds.center() + turn(DVec3::new(0.0, -distance, 0.0));
        let at = |i: usize| ((i as f64 + 0.5) / size as f64 * 2.0 - 1.0) * half_view.tan();
        let queries: Vec<RayQuery> = (0..size * size)
            .map(|i| turn(DVec3::new(at(i % size), 1.0, -at(i / size))))
            .map(|direction| RayQuery::new(Ray::new(eye, direction)))
            .collect();
        let mut hits = Vec::new();
        world.closest(&queries, &mut hits, &mut Counters::default());
        let covered = hits.iter().map(|hit| !hit.is_miss()).collect();
        Self { size, covered }
    }

    fn area(&self) -> usize {
        self.covered.iter().filter(|c| **c).count()
    }

    /// Pixels that differ, and of these the ones without a pixel of their kind next to them in
    /// `other`.
    fn differences(&self, other: &Self) -> (usize, usize) {
        let size = self.size as isize;
        let at = |x: isize, y: isize| {
            let inside = (0..size).contains(&x) && (0..size).contains(&y);
            inside.then(|| other.covered[(y * size + x) as usize])
        };
        let (mut different, mut far) = (0, 0);
        for (i, &covered) in self.covered.iter().enumerate() {
            if covered == other.covered[i] {
                continue;
            }
            different += 1;
            let (x, y) = (i as isize % size, i as isize / size);
            let near = |k: isize| at(x + k % 3 - 1, y + k / 3 - 1) == Some(covered);
            far += usize::from(!(0..9).any(near));
        }
        (different, far)
    }
}

/// The volume inside of all objects, by lines in a direction that no face is parallel to: each
/// stands for a square of a grid of squares across.
fn volume(world: &World, grid: usize) -> f64 {
    let bounds = world.bounds();
    let direction = DVec3::new(0.81, 0.37, 0.45).normalize();
    let (u, v) = direction.any_orthonormal_pair();
    let side = bounds.diagonal();
    let at = |i: usize| ((i as f64 + 0.5) / grid as f64 - 0.5) * side;
    let mut hits = Vec::new();
    let mut length = 0.0;
    for i in 0..grid * grid {
        let origin = bounds.center() + u * at(i % grid) + v * at(i / grid);
        let query = RayQuery::new(Ray::new(origin, direction));
        world.crossings(&query, true, &mut hits, &mut Counters::default());
        let inside = hits.windows(2).filter(|pair| pair[0].to != Region::OUTSIDE);
        length += inside.map(|pair| pair[1].t - pair[0].t).sum::<f64>();
    }
    length * (side / grid as f64).powi(2)
}

/// Volume and bounds of what OpenSCAD 2021.01 exports, by the name of the dump.
fn reference(folder: &Path) -> BTreeMap<String, (f64, Aabb)> {
    let table = std::fs::read_to_string(folder.join("REFERENCE.tsv")).expect("a table");
    let row = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let box_: Vec<f64> = fields[3].split(' ').map(number).collect();
        let bounds = Aabb::new(DVec3::from_slice(&box_[..3]), DVec3::from_slice(&box_[3..]));
        (fields[0].to_owned(), (number(fields[1]), bounds))
    };
    table.lines().skip(1).map(row).collect()
}

/// The picture OpenSCAD has of a dump, rendered or previewed.
fn picture_of(dump: &Path) -> Option<PathBuf> {
    let name = dump.file_name()?.to_string_lossy();
    let stem = name.split('.').next()?;
    ["render", "preview"]
        .map(|kind| dump.with_file_name(format!("{stem}.{kind}.png")))
        .into_iter()
        .find(|picture| picture.is_file())
}

fn dumps(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "csg"));
    paths.sort();
    paths
}

/// Pixels that may differ, all at the outline: rasterising takes a side where an edge runs through
/// a pixel's centre. Measured: at most 6 of more than 10 000.
const PIXELS: usize = 10;

/// Lines across a model and back, and the relative difference of volumes that is put down to them.
/// Measured: at most 7e-5 with 512 lines and 1e-5 with 1000, so the solids are the same.
const GRID: (usize, f64) = (512, 2e-4);

/// The same for a few small balls in a large box, which slip through a coarse grid (3e-4).
const SPARSE_GRID: (usize, f64) = (1000, 1e-3);

/// Preparing these takes most of a minute each: they have round shapes of thousands of faces.
const SLOW: [&str; 3] = [
    "CSG-modules.2021.csg",
    "candleStand.2021.csg",
    "sphere-tests.csg",
];

fn is_slow(dump: &Path) -> bool {
    SLOW.iter().any(|name| dump.ends_with(name))
}

fn compare_silhouettes(dump: &Path, picture: &Path, world: &World, bounds: Aabb) {
    let expected = Silhouette::of_picture(picture);
    let ours = Silhouette::of_world(world, bounds, expected.size);
    let (different, far) = ours.differences(&expected);
    let areas = (ours.area(), expected.area());
    assert!(
        far == 0 && different <= PIXELS,
        "{}: of {areas:?} {different} differ, {far} not at the outline",
        dump.display()
    );
}

/// Compares the chosen examples with the table and their pictures; says how many.
fn compare_examples(folder: &Path, choose: impl Fn(&Path) -> bool) -> usize {
    let mut compared = 0;
    for (name, (expected, bounds)) in reference(folder) {
        let dump = folder.join(&name);
        let Some(scene) = scene(&dump).filter(|_| choose(&dump)) else {
            continue;
        };
        let world = world(scene);
        if let Some(picture) = picture_of(&dump) {
            compare_silhouettes(&dump, &picture, &world, bounds);
        }
        let is_sparse = expected < bounds.size().element_product() * 1e-2;
        let (grid, tolerance) = if is_sparse { SPARSE_GRID } else { GRID };
        let measured = volume(&world, grid);
        let error = (measured / expected - 1.0).abs();
        assert!(error < tolerance, "{name}: {measured}, not {expected}");
        compared += 1;
    }
    compared
}

/// Compares the chosen regression dumps with their pictures; says how many.
fn compare_dumps(folder: &Path, choose: impl Fn(&Path) -> bool) -> usize {
    let mut compared = 0;
    for dump in dumps(folder).into_iter().filter(|dump| choose(dump)) {
        // OpenSCAD aims at the intersection, whose bounds are not known here before it is traced;
        // the same solid is `example014`.
        if dump.ends_with("intersection_for-tests.csg") {
            continue;
        }
        let (Some(picture), Some(scene)) = (picture_of(&dump), scene(&dump)) else {
            continue;
        };
        // Some pictures belong to examples of the same name.
        if scene.objects().is_empty() {
            continue;
        }
        let world = world(scene);
        compare_silhouettes(&dump, &picture, &world, world.bounds());
        compared += 1;
    }
    compared
}

#[test]
fn examples_have_the_silhouettes_and_volumes_of_openscad() {
    if let Some(folder) = corpus("openscad/examples") {
        let compared = compare_examples(&folder, |dump| !is_slow(dump));
        assert!(compared >= 14, "{compared}");
    }
}

#[test]
fn regression_dumps_have_the_silhouettes_of_openscad() {
    if let Some(folder) = corpus("openscad/dump") {
        let compared = compare_dumps(&folder, |dump| !is_slow(dump));
        assert!(compared >= 30, "{compared}");
    }
}

#[test]
fn slow_dumps_have_the_silhouettes_and_volumes_of_openscad() {
    if let Some(folder) = corpus("openscad/examples") {
        assert_eq!(compare_examples(&folder, is_slow), 2);
    }
    if let Some(folder) = corpus("openscad/dump") {
        assert_eq!(compare_dumps(&folder, is_slow), 1);
    }
}
