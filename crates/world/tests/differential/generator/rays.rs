//! Random rays, special positions strongly preferred.

use octray_geometry::Primitive;
use octray_math::{DAffine3, DVec3, Ray};

use crate::draw::Draw;
use crate::oracle::Oracle;

/// How a ray was aimed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Family {
    /// Anywhere through the scene.
    Random,
    /// Through a special point of a primitive (vertex, rim, apex, pole), in any direction.
    Point,
    /// Through special points of two primitives.
    Chord,
    /// Along an axis of the world or of a primitive, through a special point.
    Axis,
    /// Along an edge, a ruling, an axis, a tangent.
    Line,
    /// The same, a little off.
    Nearly,
}

/// All of them, with how often.
const FAMILIES: [(Family, u32); 6] = [
    (Family::Random, 4),
    (Family::Point, 4),
    (Family::Chord, 3),
    (Family::Axis, 5),
    (Family::Line, 2),
    (Family::Nearly, 3),
];

/// What rays are aimed at.
#[derive(Debug)]
pub(crate) struct Rays<'a> {
    targets: Vec<(&'a Primitive, DAffine3)>,
    center: DVec3,
    radius: f64,
}

impl<'a> Rays<'a> {
    pub(crate) fn new(oracle: &'a Oracle) -> Self {
        Self {
            targets: oracle.primitives().collect(),
            center: oracle.center(),
            radius: oracle.radius(),
        }
    }

    /// A special point and a special direction through it, of a random primitive.
    fn special(&self, draw: &mut Draw) -> (DVec3, DVec3) {
        let Some((primitive, world)) = self.targets.get(draw.below(self.targets.len().max(1)))
        else {
            return (self.center, draw.direction());
        };
        let (point, direction) = special_line(draw, primitive);
        (
            world.transform_point3(point),
            world.transform_vector3(direction),
        )
    }

    fn axis(&self, draw: &mut Draw) -> DVec3 {
        let axis = draw.pick(&[DVec3::X, DVec3::Y, DVec3::Z]) * draw.pick(&[1.0, -1.0]);
        match self.targets.get(draw.below(2 * self.targets.len().max(1))) {
            Some((_, world)) => world.transform_vector3(axis),
            None => axis,
        }
    }

    fn line(&self, draw: &mut Draw, family: Family) -> (DVec3, DVec3) {
        let (point, direction) = self.special(draw);
        match family {
            Family::Random => {
                let inside = draw.direction() * (0.5 * self.radius * draw.unit());
                (self.center + inside, draw.direction())
            }
            Family::Point => (point, draw.direction()),
            Family::Chord => (point, self.special(draw).0 - point),
            Family::Axis => (point, self.axis(draw)),
            Family::Line => (point, direction),
            Family::Nearly => {
                let size = libm::ldexp(1.0, -draw.whole(4, 60));
                let aside = draw.direction() * (self.radius * size);
                let turn = draw.direction() * (direction.length() * size);
                match draw.below(3) {
                    0 => (point + aside, direction),
                    1 => (point, direction + turn),
                    _ => (point + aside, direction + turn),
                }
            }
        }
    }
}

/// A ray, and how it was aimed.
pub(crate) fn aim(draw: &mut Draw, rays: &Rays<'_>) -> (Family, Ray) {
    loop {
        let family = FAMILIES[draw.weighted(&FAMILIES.map(|f| f.1))].0;
        let (point, direction) = rays.line(draw, family);
        let length = direction.length();
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        // In units of the scene's size: where the ray starts before the point.
        let back = match draw.weighted(&[4, 4, 2, 1, 1]) {
            0 => 0.0,
            1 => draw.between(-2.0, 2.0),
            2 => f64::from(draw.whole(-4, 4)),
            3 => draw.between(0.0, 1e3),
            _ => draw.between(0.0, 1e6),
        };
        let origin = point - direction * (back * rays.radius / length);
        let scale = match draw.weighted(&[6, 2, 1]) {
            0 => 1.0,
            1 => libm::ldexp(1.0, draw.whole(-60, 60)),
            _ => draw.between(0.1, 10.0),
        };
        return (family, Ray::new(origin, direction * scale));
    }
}

/// A line on which rounding decides most: through or along what is special about a primitive.
fn special_line(draw: &mut Draw, primitive: &Primitive) -> (DVec3, DVec3) {
    // Points of a unit circle, mostly exact ones.
    let turn = match draw.weighted(&[3, 1]) {
        0 => 90.0 * f64::from(draw.whole(0, 3)),
        _ => draw.between(0.0, 360.0),
    };
    let (sin, cos) = octray_math::transform::sin_cos_degrees(turn);
    let round = |radius: f64, z: f64| DVec3::new(radius * cos, radius * sin, z);
    let tangent = DVec3::new(-sin, cos, 0.0);
    let outward = DVec3::new(cos, sin, 0.0);
    let finite = |z: [f64; 2]| z.map(|z| if z.is_finite() { z } else { 0.0 });
    match primitive {
        Primitive::Sphere { radius } => {
            let point = round(*radius, 0.0);
            match draw.below(3) {
                0 => (point, tangent),
                1 => (point, DVec3::Z),
                _ => (DVec3::new(0.0, 0.0, *radius), outward),
            }
        }
        Primitive::Box { min, max } => {
            let corner = |draw: &mut Draw| {
                DVec3::from_array(std::array::from_fn(|i| {
                    if draw.chance(0.5) { min[i] } else { max[i] }
                }))
            };
            let from = corner(draw);
            let mut direction = corner(draw) - from;
            if direction == DVec3::ZERO {
                direction = draw.pick(&[DVec3::X, DVec3::Y, DVec3::Z]);
            }
            // In a face but through no vertex.
            let aside = if draw.chance(0.3) {
                (corner(draw) - from) * draw.unit()
            } else {
                DVec3::ZERO
            };
            (from + aside, direction)
        }
        Primitive::Cylinder { radius, z } => {
            let z = finite(*z)[draw.below(2)];
            match draw.below(4) {
                0 => (round(*radius, z), DVec3::Z),
                1 => (round(*radius, z), tangent),
                2 => (round(*radius, z), outward),
                _ => (DVec3::new(0.0, 0.0, z), DVec3::Z),
            }
        }
        Primitive::Cone { radius, z } => {
            let at = [round(radius[0], z[0]), round(radius[1], z[1])];
            let from = draw.below(2);
            match draw.below(5) {
                0 | 1 => (at[from], at[1] - at[0]),
                2 => (at[from], tangent),
                3 => (at[from], outward),
                _ => (DVec3::new(0.0, 0.0, z[from]), DVec3::Z),
            }
        }
        Primitive::Torus { major, minor } => {
            let (inner, outer) = (major - minor, major + minor);
            match draw.below(8) {
                0 => (round(inner, 0.0), tangent),
                1 => (round(outer, 0.0), tangent),
                // On the plane that touches it along a circle.
                2 => (round(*major, *minor), outward),
                3 => (round(*major, *minor), tangent),
                4 => (DVec3::ZERO, DVec3::Z),
                5 => (round(*major, 0.0), tangent),
                6 => (round(*major, 0.0), DVec3::Z),
                // Touches the tube from both sides, in the plane of Villarceau's circles.
                _ if minor < major => {
                    let slope = minor / (major * major - minor * minor).sqrt();
                    (DVec3::ZERO, outward + DVec3::Z * slope)
                }
                // The tip of the lemon.
                _ => {
                    let tip = (minor * minor - major * major).sqrt();
                    (DVec3::new(0.0, 0.0, tip), outward)
                }
            }
        }
        Primitive::HalfSpace { normal, offset } => {
            let along = normal.any_orthogonal_vector();
            let direction = if draw.chance(0.8) { along } else { *normal };
            (*normal * *offset, direction)
        }
        Primitive::Convex(polyhedron) => {
            let from = draw.pick(&polyhedron.vertices);
            let to = draw.pick(&polyhedron.vertices);
            let direction = if from == to {
                draw.direction()
            } else {
                to - from
            };
            (from, direction)
        }
        _ => (DVec3::ZERO, draw.direction()),
    }
}
