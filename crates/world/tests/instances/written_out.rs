//! The same scene with every copy an object of its own: the same answers up to rounding.

use octray_math::{DVec3, Ray};
use octray_scene::ObjectId;
use octray_world::{Counters, Hit, Method, Overlaps, RayQuery, Region, World};

use crate::scenes::{Recipe, cases, rays, world};

/// Parameters count in lengths of about 10, in a scene of about 10; coordinates of copies are
/// rounded a few times more than those of objects.
const CLOSE: f64 = 1e-10;

/// Both worlds, and what the objects of the second are in the first.
struct Pair {
    instanced: World,
    written: World,
    origins: Vec<(u32, i64)>,
}

impl Pair {
    fn of(recipe: &Recipe) -> Self {
        Self {
            instanced: world(&recipe.instanced(), Method::Auto),
            written: world(&recipe.written_out(), Method::Auto),
            origins: recipe.origins(),
        }
    }

    /// Object, copy, face in the object, and material of a hit in the instanced scene.
    fn here(&self, hit: &Hit) -> (u32, i64, u32, u32) {
        let world = &self.instanced;
        let (object, face) = world.face_in_object(hit.face).expect("a face");
        let (owner, material) = world.owner(hit.face).expect("a face");
        assert_eq!(owner, object);
        let copy = world.instance(hit.instance).map_or(-1, |(of, copy)| {
            assert_eq!(of, object, "the copy is of the face's object");
            i64::from(copy)
        });
        (object.0, copy, face, material.0)
    }

    fn there(&self, hit: &Hit) -> (u32, i64, u32, u32) {
        let (object, face) = self.written.face_in_object(hit.face).expect("a face");
        let (_, material) = self.written.owner(hit.face).expect("a face");
        let (object, copy) = self.origins[object.0 as usize];
        (object, copy, face, material.0)
    }

    fn region(&self, written: Region) -> Region {
        let object = written.object().map(|id| self.origins[id.0 as usize].0);
        object.map_or(Region::OUTSIDE, |id| Region::of(ObjectId(id)))
    }

    fn check_hit(&self, query: &RayQuery, a: &Hit, b: &Hit, with_regions: bool) {
        assert_eq!(a.is_miss(), b.is_miss(), "{a:?} {b:?}");
        if a.is_miss() {
            return;
        }
        assert!((a.t - b.t).abs() < CLOSE, "{a:?} {b:?}");
        assert_eq!(self.here(a), self.there(b), "{a:?} {b:?}");
        assert_eq!(a.entering, b.entering);
        if with_regions {
            assert_eq!(a.from, self.region(b.from), "{a:?} {b:?}");
            assert_eq!(a.to, self.region(b.to), "{a:?} {b:?}");
        }
        let surface = self.instanced.interact(query, a);
        let same = self.written.interact(query, b);
        for (x, y) in [
            (surface.position, same.position),
            (surface.normal, same.normal),
            (surface.shading_normal, same.shading_normal),
        ] {
            assert!((x - y).abs().max_element() < 1e-8, "{surface:?} {same:?}");
        }
        let media = |s: &octray_world::SurfaceHit| (s.ior_from, s.ior_to, s.medium, s.material);
        if with_regions {
            assert_eq!(media(&surface), media(&same));
        }
    }

    fn closest(&self, queries: [&[RayQuery]; 2]) -> [Vec<Hit>; 2] {
        let ask = |world: &World, queries: &[RayQuery]| {
            let mut hits = Vec::new();
            world.closest(queries, &mut hits, &mut Counters::default());
            hits
        };
        [
            ask(&self.instanced, queries[0]),
            ask(&self.written, queries[1]),
        ]
    }

    fn check(&self, rays: &[Ray], transparent: bool) {
        let queries: Vec<RayQuery> = rays.iter().map(|ray| RayQuery::new(*ray)).collect();
        let [here, there] = self.closest([&queries, &queries]);
        let mut onward: [Vec<RayQuery>; 2] = [Vec::new(), Vec::new()];
        for ((query, a), b) in queries.iter().zip(&here).zip(&there) {
            self.check_hit(query, a, b, transparent);
            if !a.is_miss() {
                // A ray onward, through the surface, from one point.
                let mut onward_from = |world: usize, hit: &Hit| {
                    onward[world].push(RayQuery {
                        ray: Ray::new(query.ray.at(a.t), query.ray.direction),
                        departure: hit.departure(!hit.entering),
                        ..*query
                    });
                };
                onward_from(0, a);
                onward_from(1, b);
            }
        }
        let [here, there] = self.closest([&onward[0], &onward[1]]);
        for ((query, a), b) in onward[0].iter().zip(&here).zip(&there) {
            self.check_hit(query, a, b, transparent);
        }
        let [mut dark, mut dark_there] = [Vec::new(), Vec::new()];
        let counters = &mut Counters::default();
        self.instanced.occluded(&onward[0], &mut dark, counters);
        self.written.occluded(&onward[1], &mut dark_there, counters);
        assert_eq!(dark, dark_there);
        for query in &queries {
            self.check_lists(query);
        }
    }

    fn check_lists(&self, query: &RayQuery) {
        let counters = &mut Counters::default();
        for whole in [false, true] {
            let [mut here, mut there] = [Vec::new(), Vec::new()];
            self.instanced.crossings(query, whole, &mut here, counters);
            self.written.crossings(query, whole, &mut there, counters);
            assert_eq!(here.len(), there.len());
            for (a, b) in here.iter().zip(&there) {
                self.check_hit(query, a, b, true);
            }
            let counts = [&self.instanced, &self.written]
                .map(|world| world.count_crossings(query, whole, &mut Counters::default()));
            assert_eq!(counts[0], counts[1]);
            for kind in [Overlaps::Regions, Overlaps::Priorities, Overlaps::Objects] {
                let [mut here, mut there] = [Vec::new(), Vec::new()];
                self.instanced
                    .chords(query, whole, kind, &mut here, counters);
                self.written
                    .chords(query, whole, kind, &mut there, counters);
                assert_eq!(here.len(), there.len(), "{here:?} {there:?}");
                for (a, b) in here.iter().zip(&there) {
                    let copy = self.instanced.instance(a.instance);
                    let copy = copy.map_or(-1, |(_, copy)| i64::from(copy));
                    let origin = self.origins[b.object.0 as usize];
                    assert_eq!((a.object.0, copy), origin, "{a:?} {b:?}");
                    for (a, b) in [(a.enter, b.enter), (a.exit, b.exit)] {
                        assert!(a.t == b.t || (a.t - b.t).abs() < CLOSE);
                        assert_eq!((a.displaced, a.entering), (b.displaced, b.entering));
                        let normal = self.instanced.chord_normal(query, &a);
                        let same = self.written.chord_normal(query, &b);
                        assert!((normal - same).abs().max_element() < 1e-8);
                    }
                }
            }
        }
    }

    fn check_regions(&self, points: &[DVec3]) -> usize {
        let [mut here, mut there] = [Vec::new(), Vec::new()];
        let counters = &mut Counters::default();
        self.instanced.regions(points, &mut here, counters);
        self.written.regions(points, &mut there, counters);
        for ((a, b), point) in here.iter().zip(&there).zip(points) {
            assert_eq!(*a, self.region(*b), "{point}");
        }
        here.iter().filter(|r| **r != Region::OUTSIDE).count()
    }
}

#[test]
fn copies_are_where_objects_would_be() {
    for seed in 0..cases(12) {
        let (transparent, priorities) = (seed % 2 == 0, seed % 3 == 0);
        let recipe = Recipe::random(seed, transparent, priorities);
        let pair = Pair::of(&recipe);
        let rays = rays(seed, 150);
        pair.check(&rays, transparent);
        let points: Vec<DVec3> = rays.iter().map(|ray| ray.origin * 0.7).collect();
        assert!(pair.check_regions(&points) > 0);
    }
}

#[test]
fn figures_tell_of_copies_and_of_what_is_copied() {
    let recipe = Recipe::random(3, false, false);
    let pair = Pair::of(&recipe);
    let stats = pair.instanced.stats();
    assert_eq!(stats.instances, 12 + 7 + 20);
    assert_eq!((stats.objects, stats.prototypes), (4 + 4, 4));
    let tree = stats.instance_tree.expect("an octree over the copies");
    assert_eq!(tree.items, 39);
    assert_eq!(stats.memory.instances, tree.bytes);
    assert!(pair.written.stats().faces > stats.faces);
    assert_eq!(pair.written.stats().instances, 0);
    let [a, b] = [&pair.instanced, &pair.written].map(World::bounds);
    assert!(a.inflated(1e-9).contains_box(&b), "{a:?} {b:?}");
}
