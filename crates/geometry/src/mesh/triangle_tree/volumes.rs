//! A volume around each object, tested before its triangles (Weghorst, Hooper and Greenberg,
//! *Improved Computational Methods for Ray Tracing*, 1984).

use std::ops::Range;

use octray_math::{Aabb, DVec3, Interval, Ray};

use super::search::SearchCost;

/// The objects, each with its volume.
#[derive(Clone, Debug)]
pub(super) struct ObjectVolumes(Vec<(Range<u32>, Volume)>);

#[derive(Clone, Copy, Debug)]
enum Volume {
    Box(Aabb),
    Sphere { center: DVec3, radius: f64 },
}

/// Rounding is below this share of the coordinates of ray and volume: `2^-53` for each of a few
/// steps.
const SLACK: f64 = 1.0 / (1u64 << 46) as f64;
/// Squares of lengths between these bounds suffer no harm from under- or overflow.
const TAME: std::ops::RangeInclusive<f64> = 1e-140..=1e140;

impl ObjectVolumes {
    /// Around objects of consecutive triangles; `spheres` or boxes.
    pub(super) fn new(
        objects: impl Iterator<Item = Range<u32>>,
        corners: impl Fn(u32) -> [DVec3; 3],
        spheres: bool,
    ) -> Self {
        let with_volume = |object: Range<u32>| {
            let bounds = Aabb::from_points(object.clone().flat_map(&corners));
            let center = bounds.center();
            let distance = |p: DVec3| p.distance(center);
            let volume = if spheres {
                let radius = object.clone().flat_map(&corners).map(distance);
                Volume::Sphere {
                    center,
                    radius: radius.fold(0.0, f64::max),
                }
            } else {
                Volume::Box(bounds)
            };
            (object, volume)
        };
        Self(objects.filter(|o| !o.is_empty()).map(with_volume).collect())
    }

    /// Shows `test` the triangles of the objects whose volumes the line meets before the end; it
    /// returns the new end.
    pub(super) fn visit(
        &self,
        ray: &Ray,
        span: Interval,
        cost: &mut SearchCost,
        mut test: impl FnMut(u32, f64) -> f64,
    ) {
        let mut end = span.end;
        let line = TestLine::new(ray);
        for (object, volume) in &self.0 {
            cost.steps.cells += 1;
            if !line.may_meet(volume, Interval::new(span.start, end)) {
                continue;
            }
            for triangle in object.clone() {
                if end < span.start {
                    return;
                }
                cost.walk.items += 1;
                end = test(triangle, end);
            }
        }
    }
}

/// A line with what the tests of volumes need.
struct TestLine<'a> {
    ray: &'a Ray,
    far: f64,
    length: f64,
    tame: bool,
}

impl<'a> TestLine<'a> {
    fn new(ray: &'a Ray) -> Self {
        let far = ray.origin.abs().max_element();
        let largest = ray.direction.abs().max_element();
        Self {
            ray,
            far,
            length: ray.direction.length(),
            tame: TAME.contains(&largest) && far <= *TAME.end(),
        }
    }

    /// Whether the line meets the volume in `within`; also where rounding leaves it open, and where
    /// numbers are so extreme that nothing is ruled out.
    fn may_meet(&self, volume: &Volume, within: Interval) -> bool {
        match volume {
            Volume::Box(bounds) => {
                let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
                let grown = bounds.inflated((reach + self.far) * SLACK);
                !self.tame
                    || reach > *TAME.end()
                    || !grown.clip(self.ray).intersection(&within).is_empty()
            }
            Volume::Sphere { center, radius } => {
                let reach = center.abs().max_element() + radius;
                if !self.tame || reach > *TAME.end() {
                    return true;
                }
                let radius = radius + (reach + self.far) * SLACK;
                let to_center = *center - self.ray.origin;
                let along = to_center.dot(self.ray.direction) / self.length;
                let away = to_center.cross(self.ray.direction).length() / self.length;
                // The half chord is at most the radius: a bound that needs no root.
                away <= radius
                    && (along + radius) / self.length >= within.start
                    && (along - radius) / self.length <= within.end
            }
        }
    }
}
