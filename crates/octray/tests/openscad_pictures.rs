//! Dumps against OpenSCAD itself: silhouettes of its pictures, volumes of its exports.
//!
//! OpenSCAD's polyhedra are made throughout (`facets`), so that both show the same solid.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use octray_import::{Disk, Options, openscad};
use octray_math::{Aabb, DVec3, Ray, transform};
use octray_scene::Scene;
use octray_world::{Counters, RayQuery, Region, World, WorldConfig};

/// The folder of test files, or `None` (said on the console) where there is none.
#[expect(clippy::print_stdout, reason = "a skipped test says so")]
fn corpus(folder: &str) -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("OCTRAY_CORPUS").map_or(default, PathBuf::from);
    let folder = root.join(folder);
    if !folder.is_dir() {
        println!("skipped: there is no {}", folder.display());
        return None;
    }
    Some(folder)
}

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

/// The box around the points of the world, closer than [`World::bounds`] where something is cut
/// off: on each side the nearest hit of a grid of parallel rays, then of finer grids around it.
fn tight_bounds(world: &World) -> Aabb {
    const GRID: usize = 96;
    let outer = world.bounds();
    let mut found = outer;
    for side in 0..6 {
        let (axis, up) = (side / 2, side % 2 == 1);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut direction = DVec3::ZERO;
        direction[axis] = if up { -1.0 } else { 1.0 };
        let start = if up {
            outer.max[axis] + 1.0
        } else {
            outer.min[axis] - 1.0
        };
        let (mut low, mut high) = (outer.min, outer.max);
        let mut best = f64::INFINITY;
        for _ in 0..6 {
            let step = (high - low) / GRID as f64;
            let origins: Vec<DVec3> = (0..GRID * GRID)
                .map(|i| {
                    let mut origin = DVec3::ZERO;
                    origin[axis] = start;
                    origin[u] = low[u] + ((i % GRID) as f64 + 0.5) * step[u];
                    origin[v] = low[v] + ((i / GRID) as f64 + 0.5) * step[v];
                    origin
                })
                .collect();
            let queries: Vec<RayQuery> = origins
                .iter()
                .map(|&origin| RayQuery::new(Ray::new(origin, direction)))
                .collect();
            let mut hits = Vec::new();
            world.closest(&queries, &mut hits, &mut Counters::default());
            let nearest = hits
                .iter()
                .zip(&origins)
                .min_by(|a, b| a.0.t.total_cmp(&b.0.t));
            let Some((hit, &at)) = nearest.filter(|(hit, _)| hit.t <= best) else {
                break;
            };
            best = hit.t;
            (low, high) = (at - step * 3.0, at + step * 3.0);
        }
        if up {
            found.max[axis] = start - best;
        } else {
            found.min[axis] = start + best;
        }
    }
    found
}

/// The volume inside of all objects: the middle of each cell of a grid stands for the cell.
fn volume(world: &World, bounds: Aabb, grid: usize) -> f64 {
    let step = bounds.size() / grid as f64;
    let mut hits = Vec::new();
    let mut length = 0.0;
    for i in 0..grid * grid {
        let at = |i: usize| i as f64 + 0.5;
        let offset = DVec3::new(-1.0, at(i % grid) * step.y, at(i / grid) * step.z);
        let query = RayQuery::new(Ray::new(bounds.min + offset, DVec3::X));
        world.crossings(&query, true, &mut hits, &mut Counters::default());
        for pair in hits.windows(2) {
            if pair[0].to != Region::OUTSIDE {
                length += pair[1].t - pair[0].t;
            }
        }
    }
    length * step.y * step.z
}

#[test]
fn explore() {
    let mut reference = std::collections::BTreeMap::new();
    let folder = corpus("openscad/examples").unwrap();
    for line in std::fs::read_to_string(folder.join("REFERENCE.tsv"))
        .unwrap()
        .lines()
        .skip(1)
    {
        let f: Vec<&str> = line.split('\t').collect();
        let b: Vec<f64> = f[3]
            .split_whitespace()
            .map(|x| x.parse().unwrap())
            .collect();
        reference.insert(f[0].to_owned(), (f[1].parse::<f64>().unwrap(), b));
    }
    for folder in ["openscad/examples", "openscad/dump"] {
        let Some(folder) = corpus(folder) else { return };
        let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().path())
            .collect();
        paths.sort();
        for path in paths {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if !name.ends_with(".csg") || name.ends_with(".master.csg") {
                continue;
            }
            let picture =
                path.with_file_name(format!("{}.render.png", name.split('.').next().unwrap()));
            let picture = if picture.is_file() {
                picture
            } else {
                path.with_file_name(format!("{}.preview.png", name.split('.').next().unwrap()))
            };
            if !picture.is_file() {
                continue;
            }
            let Some(scene) = scene(&path) else { continue };
            if scene.objects().is_empty() {
                println!("{name}: empty");
                continue;
            }
            let t = std::time::Instant::now();
            let world = world(scene);
            let prep = t.elapsed();
            let bounds = tight_bounds(&world);
            let tb = t.elapsed() - prep;
            let expected = Silhouette::of_picture(&picture);
            let ours = Silhouette::of_world(&world, bounds, expected.size);
            let (d, far) = ours.differences(&expected);
            println!(
                "{name}: area {} of {}, differ {d}, far {far} prep {prep:?} tight {tb:?} {:?}",
                ours.area(),
                expected.area(),
                t.elapsed()
            );
            if let Some((v, b)) = reference.get(&name) {
                let e = (0..3)
                    .map(|i| {
                        (bounds.min[i] - b[i])
                            .abs()
                            .max((bounds.max[i] - b[i + 3]).abs())
                    })
                    .fold(0.0, f64::max);
                let t = std::time::Instant::now();
                let m = volume(&world, bounds, 256);
                println!(
                    "     bounds error {e}, volume {m} of {v}: {:.3e} {:?}",
                    m / v - 1.0,
                    t.elapsed()
                );
            }
        }
    }
}
