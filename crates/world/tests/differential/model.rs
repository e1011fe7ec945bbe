//! A scene of solids to be compared with its oracle.

use std::sync::Arc;

use octray_geometry::Solid;
use octray_math::{DVec3, Ray};
use octray_scene::{Material, Object, Scene, SceneBuilder};
use octray_world::{
    Chord, Counters, Criteria, Hit, Method, Overlaps, RayQuery, Region, World, WorldConfig,
};

use crate::oracle::Oracle;

/// An object: a solid and its priority.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) priority: i32,
    pub(crate) solid: Solid,
}

/// A scene.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    pub(crate) parts: Vec<Part>,
    /// Whether distinct boundaries may be as near to each other as the surface table's tolerance,
    /// so that thin slivers between them are real.
    pub(crate) delicate: bool,
    /// What is compared with the oracle and with brute force.
    pub(crate) method: Method,
}

/// A scene and a ray.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) model: Model,
    pub(crate) ray: Ray,
}

/// A scene made ready twice, with its oracle.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) oracle: Oracle,
    pub(crate) is_delicate: bool,
    /// For each object.
    pub(crate) is_bounded: Vec<bool>,
    engine: World,
    brute: World,
}

/// Criteria that divide small scenes as far as large ones.
fn deep() -> Criteria {
    Criteria {
        max_depth: 6,
        visit_cost: 0.1,
        ..Criteria::default()
    }
}

impl Model {
    /// `None` if the scene is refused.
    pub(crate) fn prepare(&self) -> Option<Subject> {
        self.prepare_as(self)
    }

    /// The engine gets another scene than the oracle: to see whether that is noticed.
    pub(crate) fn prepare_as(&self, other: &Self) -> Option<Subject> {
        let scene = other.scene()?;
        let world = |method| {
            let config = WorldConfig {
                method,
                criteria: deep(),
                ..WorldConfig::default()
            };
            World::prepare(Arc::clone(&scene), &config).ok()
        };
        let (engine, brute) = (world(other.method)?, world(Method::Brute)?);
        let merged = brute.stats().merged_surfaces > 0;
        let is_bounded = |part: &Part| {
            let bounds = part.solid.bounds();
            bounds.is_bounded() || bounds.is_empty()
        };
        Some(Subject {
            oracle: Oracle::new(&*self.scene()?, merged),
            is_delicate: self.delicate,
            is_bounded: self.parts.iter().map(is_bounded).collect(),
            engine,
            brute,
        })
    }

    /// The same scene elsewhere.
    pub(crate) fn moved(&self, by: DVec3) -> Self {
        let parts = self.parts.iter().map(|part| Part {
            solid: part.solid.translate(by).expect("finite"),
            ..*part
        });
        Self {
            parts: parts.collect(),
            ..*self
        }
    }

    fn scene(&self) -> Option<Arc<Scene>> {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        for part in &self.parts {
            let mut object = Object::solid("part", part.solid.clone(), material);
            object.priority = part.priority;
            builder.add_object(object);
        }
        builder.build().ok().map(Arc::new)
    }
}

impl Subject {
    /// All boundaries on a ray or its whole line, by the method and by brute force.
    pub(crate) fn crossings(&self, ray: Ray, whole: bool) -> [Vec<Hit>; 2] {
        [&self.engine, &self.brute].map(|world| {
            let mut hits = Vec::new();
            let query = RayQuery::new(ray);
            world.crossings(&query, whole, &mut hits, &mut Counters::default());
            hits
        })
    }

    /// All chords of a line, by the method and by brute force.
    pub(crate) fn chords(&self, ray: Ray, overlaps: Overlaps) -> [Vec<Chord>; 2] {
        [&self.engine, &self.brute].map(|world| {
            let mut chords = Vec::new();
            let query = RayQuery::new(ray);
            world.chords(
                &query,
                true,
                overlaps,
                &mut chords,
                &mut Counters::default(),
            );
            chords
        })
    }

    /// The region of a point, by the method and by brute force.
    pub(crate) fn region(&self, point: DVec3) -> [Region; 2] {
        [&self.engine, &self.brute].map(|world| {
            let mut regions = Vec::new();
            world.regions(&[point], &mut regions, &mut Counters::default());
            regions[0]
        })
    }

    /// Whether anything is on a ray, by the method and by brute force.
    pub(crate) fn occluded(&self, ray: Ray) -> [bool; 2] {
        [&self.engine, &self.brute].map(|world| {
            let mut blocked = Vec::new();
            let query = RayQuery::new(ray);
            world.occluded(&[query], &mut blocked, &mut Counters::default());
            blocked[0]
        })
    }

    /// The first boundary on a ray, by the method and by brute force.
    pub(crate) fn closest(&self, ray: Ray) -> [Hit; 2] {
        [&self.engine, &self.brute].map(|world| {
            let mut hits = Vec::new();
            let query = RayQuery::new(ray);
            world.closest(&[query], &mut hits, &mut Counters::default());
            hits[0]
        })
    }
}
