//! A ray as the primitives see it, and how near to a boundary is too near to tell.

use octray_geometry::surface::SURFACE_TOLERANCE;
use octray_math::{DVec3, Ray};

use super::clearance::faces;
use super::number::{Number, Twofold};
use super::{Answer, Leaf, Oracle};

/// Rounding errors of the engine are bounded by this many units in the last place of the lengths
/// that are added: a dozen operations from the ray to a crossing, each wrong by half a unit, and
/// norms that are bounded by sums.
const ROUNDINGS: f64 = 4.0;

/// A ray in front of an oracle.
#[derive(Debug)]
pub(crate) struct Sight<'a> {
    pub(crate) oracle: &'a Oracle,
    ray: Ray,
    /// Where the ray passes the centre.
    pub(super) shift: f64,
    pub(super) lines: Vec<LocalLine>,
}

/// The ray in one primitive's frame, from the point nearest to the scene's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalLine {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
}

impl<'a> Sight<'a> {
    pub(crate) fn new(oracle: &'a Oracle, ray: Ray) -> Self {
        let shift = ray.closest_approach(oracle.center);
        let near = point_at(&ray, shift);
        let direction = ray.direction.to_array().map(Twofold::of);
        let plain = |v: [Twofold; 3]| DVec3::from_array(v.map(Number::rounded));
        let lines = oracle.leaves.iter().map(|leaf| LocalLine {
            origin: plain(leaf.frame.local(near)),
            direction: plain(leaf.frame.local_vector(direction)),
        });
        Self {
            oracle,
            ray,
            shift,
            lines: lines.collect(),
        }
    }

    pub(crate) fn ray(&self) -> &Ray {
        &self.ray
    }

    pub(crate) fn center(&self) -> DVec3 {
        self.oracle.center
    }

    pub(crate) fn radius(&self) -> f64 {
        self.oracle.radius
    }

    /// The parameter nearest to the centre of the scene.
    pub(crate) fn shift(&self) -> f64 {
        self.shift
    }

    /// How much of the parameter is the length `distance`.
    pub(crate) fn parameter(&self, distance: f64) -> f64 {
        distance / self.ray.direction.length()
    }

    /// The lengths that are added on the way from the ray to a crossing at `t`.
    fn far(&self, t: f64) -> f64 {
        let Ray { origin, direction } = self.ray;
        let near = origin.length() + self.shift.abs() * direction.length();
        near + self.ray.at(t).length() + t.abs() * direction.length() + self.oracle.radius
    }

    /// The largest error that the engine may make in space near parameter `t`, apart from what
    /// transforms add.
    pub(crate) fn uncertainty(&self, t: f64) -> f64 {
        let scene = &self.oracle.scene;
        let away = self.ray.at(t).distance(scene.origin).max(scene.size);
        let rounding = ROUNDINGS * f64::EPSILON * self.far(t);
        // Subnormal coordinates have few digits or none.
        rounding + self.oracle.tolerance * away + 1e-290
    }

    /// How far from its start a ray may cross a surface without anyone being able to tell that it
    /// does not start on it: some rounding errors of its coordinates, at a flat angle.
    pub(crate) fn start_rounding(&self) -> f64 {
        let scene = &self.oracle.scene;
        let away = self.ray.origin.distance(scene.origin) + scene.size;
        2.0_f64.powi(-28) * (away + self.oracle.radius)
    }

    /// Whether each object holds the point at `t`, by rank.
    pub(crate) fn answers(&self, t: f64, answers: &mut Vec<Answer>) {
        let (far, uncertainty) = (self.far(t), self.uncertainty(t));
        let u = t - self.shift;
        self.oracle.answers(answers, &mut |index| {
            self.is_inside(index, t, u, far, uncertainty)
        });
    }

    /// How far a primitive's boundary may be off at a point, in the primitive's units.
    fn margin(&self, leaf: &Leaf, q: DVec3, far: f64, uncertainty: f64) -> f64 {
        let frame = &leaf.frame;
        // What the point is off, what composing and inverting transforms costs, and what the
        // formula itself adds.
        let size = q.length() + leaf.extent;
        let chain = frame.shrink * (frame.stretch * size + frame.reach);
        let inverse = frame.condition * frame.shrink * far;
        frame.shrink * uncertainty + ROUNDINGS * f64::EPSILON * (chain + inverse + size)
    }

    fn is_inside(&self, index: usize, t: f64, u: f64, far: f64, uncertainty: f64) -> Answer {
        let leaf = &self.oracle.leaves[index];
        let line = &self.lines[index];
        let q = line.origin + line.direction * u;
        let margin = self.margin(leaf, q, far, uncertainty);
        let coarse = leaf.clearance(q.to_array());
        if coarse.abs() > 2.0 * margin {
            return Some(coarse < 0.0);
        }
        if coarse.abs() < 0.5 * margin {
            return None;
        }
        let point = leaf.frame.local(point_at(&self.ray, t));
        let fine = leaf.clearance(point).rounded();
        (fine.abs() > margin).then_some(fine < 0.0)
    }

    /// The normal of the flat faces that are too near to tell their sides at `t`, if there are any,
    /// all are one plane but for rounding, and nothing else is nearer than `room`.
    pub(crate) fn shared_normal(&self, t: f64, room: f64) -> Option<DVec3> {
        let (far, uncertainty) = (self.far(t), self.uncertainty(t));
        let point = point_at(&self.ray, t);
        let same = self.oracle.scene.size * SURFACE_TOLERANCE / 16.0;
        let mut shared: Option<(DVec3, f64)> = None;
        for leaf in &self.oracle.leaves {
            let fine = leaf.frame.local(point);
            let q = DVec3::from_array(fine.map(Number::rounded));
            let near = 2.0 * self.margin(leaf, q, far, uncertainty);
            let clear = near.max(room * leaf.frame.shrink);
            let (flat, curved) = faces(leaf, q);
            if curved.is_some_and(|clearance| clearance.abs() <= clear) {
                return None;
            }
            for (normal, offset) in flat {
                let [x, y, z] = normal.to_array().map(Twofold::of);
                let height = x * fine[0] + y * fine[1] + z * fine[2] - Twofold::of(offset);
                let height = height.rounded();
                if height.abs() > clear {
                    continue;
                }
                let normal = leaf.frame.world_normal(normal);
                let height_in_world = height / normal.length();
                let normal = normal.normalize();
                let (first, at) = *shared.get_or_insert((normal, height_in_world));
                let apart = height_in_world * normal.dot(first).signum() - at;
                if height.abs() > near || first.cross(normal).length() > 1e-9 || apart.abs() > same
                {
                    return None;
                }
            }
        }
        shared.map(|(normal, _)| normal)
    }
}

/// The point of a ray at a parameter, to about 100 bits.
fn point_at(ray: &Ray, t: f64) -> [Twofold; 3] {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    std::array::from_fn(|i| Twofold::of(origin[i]) + Twofold::of(direction[i]) * Twofold::of(t))
}
