//! Points of boundaries, found by the surfaces' own solvers, and which boxes are near a point.

use octray_math::{Aabb, DAffine3, DVec3, Ray};

use super::Draw;
use crate::csg::{Lowering, evaluate};
use crate::{FaceId, SceneFrame, Solid};

/// Points at which random lines through a box, given in a frame of its own, cross the boundary, `count` of
/// them.
pub(super) fn boundary_points(
    solid: &Solid,
    (around, map): (&Aabb, &DAffine3),
    count: usize,
    draw: &mut Draw,
) -> Vec<DVec3> {
    let seen = around.transformed(map);
    let mut lowering = Lowering::new(&SceneFrame::around_origin(seen.diagonal()));
    let code = lowering.lower(solid).expect("not constant");
    let lowered = lowering.finish();
    let mut points = Vec::new();
    let mut lines = 0;
    while points.len() < count {
        lines += 1;
        assert!(lines < 400 * count + 1000, "the lines miss the solid");
        let mut point = || {
            let share = DVec3::new(draw.unit(), draw.unit(), draw.unit());
            map.transform_point3(around.min + around.size() * share)
        };
        let through = point();
        let direction = point() - through;
        if direction == DVec3::ZERO {
            continue;
        }
        let ray = Ray::new(through, direction);
        let mut events = Vec::new();
        let mut negative = Vec::new();
        for (index, surface) in lowered.surfaces.iter().enumerate() {
            negative.push(surface.crossings(&ray, |t| events.push((t, index))));
        }
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        let inside = |negative: &[bool]| {
            evaluate(code.words(), &|id: FaceId| {
                let face = lowered.faces[id.0 as usize];
                negative[face.surface.0 as usize] != face.inside_is_positive
            })
        };
        let mut before = inside(&negative);
        for group in events.chunk_by(|a, b| a.0 == b.0) {
            for (_, surface) in group {
                negative[*surface] ^= true;
            }
            let after = inside(&negative);
            let p = ray.at(group[0].0);
            if before != after && seen.contains(p) {
                points.push(p);
            }
            before = after;
        }
    }
    points
}

/// Which boxes are near a point, by a grid.
pub(super) struct Near {
    low: DVec3,
    bin: DVec3,
    bins: Vec<Vec<u32>>,
}

impl Near {
    const SIDE: usize = 24;

    pub(super) fn new(boxes: &[Aabb], around: &Aabb) -> Self {
        let bin = around.size() / Self::SIDE as f64;
        let mut near = Self {
            low: around.min,
            bin,
            bins: vec![Vec::new(); Self::SIDE.pow(3)],
        };
        for (index, bounds) in boxes.iter().enumerate() {
            let slack = 1e-9 * around.diagonal();
            let (low, high) = (
                near.place(bounds.min - slack),
                near.place(bounds.max + slack),
            );
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        near.bins[(z * Self::SIDE + y) * Self::SIDE + x].push(index as u32);
                    }
                }
            }
        }
        near
    }

    fn place(&self, p: DVec3) -> [usize; 3] {
        let q = (p - self.low) / self.bin;
        [q.x, q.y, q.z].map(|q| (q.max(0.0) as usize).min(Self::SIDE - 1))
    }

    pub(super) fn at(&self, p: DVec3) -> impl Iterator<Item = usize> + '_ {
        let [x, y, z] = self.place(p);
        let bin = &self.bins[(z * Self::SIDE + y) * Self::SIDE + x];
        bin.iter().map(|index| *index as usize)
    }
}
