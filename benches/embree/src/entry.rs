//! The structures over one mesh, and the contenders that use them.

use std::sync::Arc;

use octray::geometry::mesh::{SearchMemory, TriangleSearch, TriangleTree};
use octray::geometry::{Sheet, TriangleMesh};
use octray::math::DVec3;
use octray::scene::{Material, Object, Scene, SceneBuilder};
use octray::tree::WideTreeConfig;
use octray::world::{World, WorldConfig};

use crate::contender::{Buffers, Contender};
use crate::library::{Embree, EmbreeScene};
use crate::measure::timed;
use crate::meshes::Subject;
use crate::options::Options;

/// What building took.
#[derive(Clone, Debug)]
pub struct Build {
    /// As contenders are named.
    pub name: String,
    /// Of the fastest of the builds.
    pub seconds: f64,
    /// Bytes of the structure with the triangles it needs.
    pub bytes: u64,
    /// The most bytes there were while it was built, where that is known.
    pub most: Option<u64>,
}

/// All structures over a mesh.
pub struct Structures<'a> {
    pub world: World,
    tree: Option<TriangleTree>,
    embree: Vec<(String, &'a Embree, EmbreeScene<'a>)>,
    pub builds: Vec<Build>,
}

/// The scene of a mesh.
fn scene(subject: &Subject) -> Result<Arc<Scene>, String> {
    let positions = subject.positions.iter();
    let positions = positions.map(|p| DVec3::from(p.map(f64::from))).collect();
    let mesh = TriangleMesh::new(positions, subject.triangles.clone());
    let mesh = mesh.map_err(|error| error.to_string())?;
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    builder.add_object(Object::sheet(
        subject.name,
        Sheet::mesh(Arc::new(mesh)),
        material,
    ));
    let scene = builder.build().map_err(|errors| format!("{errors:?}"))?;
    Ok(Arc::new(scene))
}

/// The last of several builds and the time of the fastest.
fn fastest<T>(
    options: &Options,
    mut build: impl FnMut() -> Result<T, String>,
) -> Result<(T, f64), String> {
    let mut once = || {
        let (built, seconds) = timed(options.threads == 1, &mut build);
        Ok::<_, String>((built?, seconds))
    };
    let (mut built, mut least) = once()?;
    for _ in 1..options.builds {
        let seconds;
        (built, seconds) = once()?;
        least = least.min(seconds);
    }
    Ok((built, least))
}

impl<'a> Structures<'a> {
    /// Builds what the wanted contenders need.
    pub fn build(
        subject: &Subject,
        devices: &'a [(String, Embree)],
        options: &Options,
    ) -> Result<Self, String> {
        let mut builds = Vec::new();
        let scene = scene(subject)?;
        let (world, seconds) = fastest(options, || {
            World::prepare(Arc::clone(&scene), &WorldConfig::default()).map_err(|e| e.to_string())
        })?;
        builds.push(Build {
            name: "octray/world".to_owned(),
            seconds,
            bytes: world.stats().memory.total(),
            most: None,
        });
        let mut tree = None;
        if wanted(options, "octray/tree") {
            let search = TriangleSearch::Wide(WideTreeConfig::default());
            let positions: Vec<DVec3> = subject
                .positions
                .iter()
                .map(|p| DVec3::from(p.map(f64::from)))
                .collect();
            let (built, seconds) = fastest(options, || {
                TriangleTree::new(positions.clone(), subject.triangles.clone(), &[0], &search)
                    .map_err(|e| e.to_string())
            })?;
            let bytes = built.bytes() + built.tree_stats().map_or(0, |stats| stats.bytes);
            builds.push(Build {
                name: "octray/tree".to_owned(),
                seconds,
                bytes,
                most: None,
            });
            tree = Some(built);
        }
        let mut embree = Vec::new();
        for (device_name, device) in devices {
            for (quality, high) in [("default", false), ("high", true)] {
                let name = format!("{device_name}/{quality}");
                if !modes(&name, device).any(|(name, ..)| wanted(options, &name)) {
                    continue;
                }
                let mut built: Option<EmbreeScene<'_>> = None;
                let mut least = f64::INFINITY;
                let (mut bytes, mut most) = (0, 0);
                for _ in 0..options.builds {
                    drop(built.take());
                    let (before, _) = device.memory();
                    let triangles =
                        device.triangles(&subject.positions, &subject.triangles, high)?;
                    let (scene, seconds) = timed(options.threads == 1, || triangles.build());
                    let (after, peak) = device.memory();
                    built = Some(scene?);
                    least = least.min(seconds);
                    (bytes, most) = (after - before, peak - before);
                }
                builds.push(Build {
                    name: name.clone(),
                    seconds: least,
                    bytes: bytes.max(0) as u64,
                    most: Some(most.max(0) as u64),
                });
                embree.extend(built.map(|scene| (name, device, scene)));
            }
        }
        Ok(Self {
            world,
            tree,
            embree,
            builds,
        })
    }

    /// The contenders that are wanted, with their names; neighbours use different structures as far
    /// as that can be, so that none finds its own in the cache.
    pub fn contenders(&self, options: &Options) -> Vec<(String, Contender<'_>)> {
        let buffers = Buffers::default;
        let octray = vec![
            (
                "octray/slice".to_owned(),
                Contender::Slice(&self.world, buffers()),
            ),
            (
                "octray/one".to_owned(),
                Contender::One(&self.world, buffers()),
            ),
        ];
        let tree = self.tree.iter();
        let tree = tree.map(|tree| {
            let contender = Contender::Tree(tree, SearchMemory::default());
            ("octray/tree".to_owned(), contender)
        });
        let embree = self.embree.iter().map(|(name, device, scene)| {
            let contender = |(name, width, coherent)| {
                let contender = Contender::Embree {
                    scene,
                    width,
                    coherent,
                };
                (name, contender)
            };
            modes(name, device).map(contender).collect()
        });
        let groups = std::iter::once(octray)
            .chain([tree.collect()])
            .chain(embree);
        let mut groups: Vec<_> = groups.map(Vec::into_iter).collect();
        let mut all = Vec::new();
        loop {
            let before = all.len();
            all.extend(groups.iter_mut().filter_map(Iterator::next));
            if all.len() == before {
                break;
            }
        }
        all.retain(|(name, _)| wanted(options, name));
        all
    }
}

/// How a structure of Embree's can be asked: name, width of packets, told to be coherent.
fn modes(name: &str, device: &Embree) -> impl Iterator<Item = (String, usize, bool)> {
    const MODES: [(&str, usize, bool); 5] = [
        ("1", 1, false),
        ("8", 8, false),
        ("8-coherent", 8, true),
        ("16", 16, false),
        ("16-coherent", 16, true),
    ];
    let there = MODES
        .into_iter()
        .filter(|&(_, width, _)| device.has_packets_of(width));
    there.map(move |(mode, width, coherent)| (format!("{name}/{mode}"), width, coherent))
}

fn wanted(options: &Options, name: &str) -> bool {
    options.only.is_empty() || options.only.iter().any(|text| name.contains(text.as_str()))
}
