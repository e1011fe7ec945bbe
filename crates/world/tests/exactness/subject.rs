//! Solids ready for rays, and rays for them.

use std::sync::Arc;

use octray_geometry::Solid;
use octray_math::{Aabb, DAffine3, DVec3, Ray, transform};
use octray_scene::{Material, Object, SceneBuilder};
use octray_world::{Chord, Counters, Hit, Overlaps, RayQuery, World, WorldConfig};

use crate::draw::Draw;

/// `count`, times what the environment says.
pub(crate) fn cases(count: u64) -> u64 {
    match std::env::var("OCTRAY_CASES") {
        Ok(times) => count * times.parse::<u64>().expect("a whole number"),
        Err(_) => count,
    }
}

/// Solids as the objects of one world.
pub(crate) struct Subject {
    pub(crate) world: World,
}

impl Subject {
    pub(crate) fn new(solids: impl IntoIterator<Item = Solid>) -> Self {
        let mut builder = SceneBuilder::new();
        let material = builder.add_material(Material::default());
        for solid in solids {
            builder.add_object(Object::solid("part", solid, material));
        }
        let scene = Arc::new(builder.build().expect("valid"));
        let world = World::prepare(scene, &WorldConfig::default()).expect("no meshes");
        Self { world }
    }

    pub(crate) fn one(solid: &Solid) -> Self {
        Self::new([solid.clone()])
    }

    /// The boundaries on the whole line.
    pub(crate) fn crossings(&self, ray: Ray) -> Vec<Hit> {
        let mut hits = Vec::new();
        let mut counters = Counters::default();
        self.world
            .crossings(&RayQuery::new(ray), true, &mut hits, &mut counters);
        hits
    }

    /// The chords of the whole line, of every object as if it were alone.
    pub(crate) fn chords(&self, ray: Ray) -> Vec<Chord> {
        let mut chords = Vec::new();
        let mut counters = Counters::default();
        let query = RayQuery::new(ray);
        self.world
            .chords(&query, true, Overlaps::Objects, &mut chords, &mut counters);
        chords
    }

    /// Where the whole line is in the only object, as pairs of parameters.
    ///
    /// Asserts that boundaries alternate, which they do for one object on every line.
    pub(crate) fn intervals(&self, ray: Ray) -> Vec<[f64; 2]> {
        let hits = self.crossings(ray);
        assert!(hits.len().is_multiple_of(2), "odd: {ray:?} {hits:?}");
        let pairs = hits.chunks_exact(2);
        pairs
            .map(|pair| {
                assert!(pair[0].entering && !pair[1].entering, "{ray:?} {hits:?}");
                assert!(pair[0].t <= pair[1].t, "{ray:?} {hits:?}");
                [pair[0].t, pair[1].t]
            })
            .collect()
    }
}

/// Intervals without what is longer apart than `gap` being joined: those that touch become one.
pub(crate) fn joined(mut intervals: Vec<[f64; 2]>, gap: f64) -> Vec<[f64; 2]> {
    intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut whole: Vec<[f64; 2]> = Vec::new();
    for [start, end] in intervals {
        match whole.last_mut() {
            Some(last) if start - last[1] <= gap => last[1] = last[1].max(end),
            _ => whole.push([start, end]),
        }
    }
    whole
}

/// Asserts that there are as many intervals, each within `tolerance` of the other.
#[track_caller]
pub(crate) fn assert_same_intervals(
    got: &[[f64; 2]],
    expected: &[[f64; 2]],
    tolerance: f64,
    ray: Ray,
) {
    let near = |(a, b): (&[f64; 2], &[f64; 2])| {
        (a[0] - b[0]).abs() <= tolerance && (a[1] - b[1]).abs() <= tolerance
    };
    assert!(
        got.len() == expected.len() && got.iter().zip(expected).all(near),
        "{ray:?}\n     got {got:?}\nexpected {expected:?}"
    );
}

/// How much of a line lies in one of the two lists of intervals and not in the other.
pub(crate) fn symmetric_difference(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let length = |all: &[[f64; 2]]| all.iter().map(|[s, e]| e - s).sum::<f64>();
    let mut common = 0.0;
    for [s, e] in a {
        for [other_s, other_e] in b {
            common += (e.min(*other_e) - s.max(*other_s)).max(0.0);
        }
    }
    length(a) + length(b) - 2.0 * common
}

/// A ray through a point of the box, towards anywhere.
pub(crate) fn general_ray(draw: &mut Draw, bounds: &Aabb) -> Ray {
    let direction = draw.direction();
    let through = point_in(draw, bounds);
    Ray::new(through - direction * bounds.diagonal(), direction)
}

/// A ray along an axis through a point of the box.
pub(crate) fn axis_ray(draw: &mut Draw, bounds: &Aabb) -> Ray {
    let mut direction = DVec3::AXES[draw.below(3)];
    if draw.chance(0.5) {
        direction = -direction;
    }
    let through = point_in(draw, bounds);
    Ray::new(through - direction * bounds.diagonal(), direction)
}

fn point_in(draw: &mut Draw, bounds: &Aabb) -> DVec3 {
    let u = DVec3::new(draw.unit(), draw.unit(), draw.unit());
    bounds.min + (bounds.max - bounds.min) * u
}

/// One rigid motion, reached on different ways: the matrices agree but for rounding.
///
/// Each entry is a list of transforms to apply one after the other.
pub(crate) fn chains(motion: &Motion) -> Vec<Vec<DAffine3>> {
    let Motion { degrees, offset } = *motion;
    let turn = |axis: DVec3, degrees: f64| transform::rotation_degrees(axis, degrees);
    let shift = DAffine3::from_translation(offset);
    let scale = |k: f64| DAffine3::from_scale(DVec3::splat(k));
    let at_once = shift * transform::rotation_xyz_degrees(degrees);
    let in_sevenths = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| std::iter::repeat_n(turn(axis, axis.dot(degrees) / 7.0), 7));
    let mirror = transform::mirror(DVec3::new(1.0, 2.0, -0.5));
    vec![
        vec![at_once],
        vec![
            turn(DVec3::X, degrees.x),
            turn(DVec3::Y, degrees.y),
            turn(DVec3::Z, degrees.z),
            shift,
        ],
        in_sevenths.chain([shift]).collect(),
        vec![
            scale(3.0),
            DAffine3::from_translation(DVec3::new(0.1, 0.7, -0.3)),
            DAffine3::from_translation(DVec3::new(-0.1, -0.7, 0.3)),
            scale(1.0 / 3.0),
            at_once,
        ],
        vec![mirror, mirror, at_once],
        vec![at_once.inverse(), at_once, at_once],
    ]
}

/// Turns about x, y, z, then an offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) degrees: DVec3,
    pub(crate) offset: DVec3,
}

impl Motion {
    pub(crate) fn matrix(&self) -> DAffine3 {
        DAffine3::from_translation(self.offset) * transform::rotation_xyz_degrees(self.degrees)
    }
}

/// The solid after all these transforms.
pub(crate) fn moved(solid: &Solid, chain: &[DAffine3]) -> Solid {
    chain.iter().fold(solid.clone(), |solid, step| {
        solid.transform(*step).expect("invertible")
    })
}
