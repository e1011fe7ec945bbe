//! The temporary triangulation of Martinka, *Using an octree to accelerate ray tracing* (1993),
//! section 6.2: an octree is built over triangles, and the triangles are forgotten.
//!
//! A curved surface needs two shells, one inscribed and one circumscribed, with every cube between them
//! counted: the cubes that meet a single triangulation are not those that meet the surface. Here every
//! triangle of the one shell stands beside one of the other ([`ShellPatch`]), and the surface over them
//! lies in their convex hull.
//!
//! | surface | shells |
//! |---|---|
//! | box, half-space, polyhedron, prism of straight edges, mesh, caps | the boundary polygons themselves, both shells in one |
//! | sphere, cylinder, cone | triangles with corners on the surface, and the same ones scaled outwards |
//! | torus, also the outer shape of a spindle | nets on tubes of two radii, by a bound of the second derivatives |
//! | quadrics, polynomials, superellipsoids, curved prisms, lathes | both sides of a layer of boxes that the boundary may cross |
//!
//! All of it is made in the primitive's own frame: hulls survive any affine map.

mod flat;
mod layer;
mod patch;
mod round;
#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3};

use crate::Primitive;
use crate::profile::Formula;
use crate::surface::Canonical;

pub use patch::{ShellPatch, StepCounts};

/// Both triangulations of a surface, pair by pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Shells {
    /// In the coordinates of the scene.
    pub patches: Vec<ShellPatch>,
    /// No point of one shell is farther than this from the surface or the other shell, in the scene.
    pub chord_error: f64,
}

/// The longest that a vector of length 1 becomes, at most.
fn stretch(map: &DAffine3) -> f64 {
    let m = map.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    let row = |a: DVec3| columns.iter().map(|b| a.dot(*b).abs()).sum::<f64>();
    // The norm of a symmetric matrix is at most its largest row sum.
    libm::sqrt(columns.into_iter().map(row).fold(0.0, f64::max))
}

/// The part of the primitive's own frame that matters.
fn region(primitive: &Primitive, scene_from_local: &DAffine3, within: &Aabb) -> Aabb {
    let seen = within.transformed(&scene_from_local.inverse());
    let own = primitive.bounds();
    // Boxes reach beyond what touches their faces.
    let slack = 1e-9 * own.intersection(seen).size().max_element();
    let region = own.inflated(slack.max(0.0)).intersection(seen);
    if region.is_bounded() || region.is_empty() {
        region
    } else {
        seen
    }
}

/// The shells of a primitive's boundary in `within`, where what has no end is cut off.
///
/// `chord_error` is the distance of the shells to aim at, in the scene. There are never more than
/// `limit` patches where fewer will do (a mesh has as many as it has triangles): then
/// [`Shells::chord_error`] says how coarse they became.
#[must_use]
pub fn shells(
    primitive: &Primitive,
    scene_from_local: &DAffine3,
    within: &Aabb,
    chord_error: f64,
    limit: usize,
) -> Shells {
    if within.is_empty() {
        return Shells {
            patches: Vec::new(),
            chord_error: 0.0,
        };
    }
    let stretch = stretch(scene_from_local);
    let aim = (chord_error / stretch).max(0.0);
    let region = region(primitive, scene_from_local, within);
    if region.is_empty() {
        return Shells {
            patches: Vec::new(),
            chord_error: 0.0,
        };
    }
    let layered = |formula: &Formula, narrow: &dyn Fn(&Formula, &Aabb) -> Option<Formula>| {
        let m = scene_from_local.matrix3;
        let scale = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
        let most = (limit / 2).max(1);
        let cells = layer::boxes(&region, scale, chord_error, most, formula, narrow);
        let thickness = cells.first().map_or(0.0, |cell| cell.diagonal());
        (cells.iter().flat_map(layer::prisms).collect(), thickness)
    };
    let one = |canonical| layered(&Formula::inside(0), &layer::crosses(canonical));
    let ends = |z: &[f64; 2]| [z[0].max(region.min.z), z[1].min(region.max.z)];
    let (patches, error): (Vec<ShellPatch>, f64) = match primitive {
        Primitive::Sphere { radius } => {
            let (patches, error) = round::sphere(aim / radius, limit);
            let scaled = DAffine3::from_scale(DVec3::splat(*radius));
            let patches = patches.iter().map(|p| p.transformed(&scaled));
            (patches.collect(), error * radius)
        }
        Primitive::Box { min, max } => (flat::cuboid(*min, *max), 0.0),
        Primitive::Cylinder { radius, z } => {
            let caps = z.map(f64::is_finite);
            round::frustum([*radius; 2], ends(z), caps, aim, limit)
        }
        Primitive::Cone { radius, z } => round::frustum(*radius, *z, [true; 2], aim, limit),
        Primitive::Torus { major, minor } => {
            let (patches, error) = round::torus(minor / major, aim / major, limit);
            let scaled = DAffine3::from_scale(DVec3::splat(*major));
            let patches = patches.iter().map(|p| p.transformed(&scaled));
            (patches.collect(), error * major)
        }
        Primitive::Quadric(form) => one(Canonical::Quadric(*form)),
        Primitive::Polynomial { polynomial, .. } => {
            one(Canonical::Polynomial(Arc::clone(polynomial)))
        }
        Primitive::Superellipsoid { exponents } => {
            let exponents = *exponents;
            one(Canonical::Superellipsoid { exponents })
        }
        Primitive::HalfSpace { normal, offset } => {
            let (center, radius) = (region.center(), 0.5 * region.diagonal());
            (flat::plane(*normal, *offset, center, radius), 0.0)
        }
        Primitive::Convex(polyhedron) => (flat::convex(polyhedron), 0.0),
        Primitive::Composite(composite) => {
            // What is smaller than the error needs no more than its box.
            let flat = composite.flat().filter(|_| region.diagonal() > aim);
            let triangles = flat.and_then(|flat| flat.triangles(limit));
            match triangles {
                Some(t) => (t.into_iter().map(ShellPatch::flat).collect(), 0.0),
                None => layered(composite.formula(), &layer::composite_crosses(composite)),
            }
        }
        Primitive::Mesh(mesh) => {
            return Shells {
                patches: flat::mesh(mesh, scene_from_local),
                chord_error: 0.0,
            };
        }
    };
    Shells {
        patches: patches
            .iter()
            .map(|p| p.transformed(scene_from_local))
            .collect(),
        chord_error: error * stretch,
    }
}

/// A patch by the size of its box; equal ones by age.
struct BySize {
    size: f64,
    age: usize,
    patch: ShellPatch,
}

impl Ord for BySize {
    fn cmp(&self, other: &Self) -> Ordering {
        self.size
            .total_cmp(&other.size)
            .then(other.age.cmp(&self.age))
    }
}

impl PartialOrd for BySize {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for BySize {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for BySize {}

/// The cover of section 6.1: small boxes that together hold the boundary in `within`, none longer than
/// `size` unless there would be more than `limit` of them.
#[must_use]
pub fn cover(
    primitive: &Primitive,
    scene_from_local: &DAffine3,
    within: &Aabb,
    size: f64,
    limit: usize,
) -> Vec<Aabb> {
    let shells = shells(primitive, scene_from_local, within, 0.25 * size, limit);
    let mut age = 0;
    let mut aged = |patch: ShellPatch| {
        age += 1;
        let size = patch.bounds().size().max_element();
        BySize { size, age, patch }
    };
    // The longest is cut first.
    let mut waiting: BinaryHeap<BySize> = shells.patches.into_iter().map(&mut aged).collect();
    while waiting.len() < limit && waiting.peek().is_some_and(|longest| longest.size > size) {
        let Some(longest) = waiting.pop() else { break };
        waiting.extend(longest.patch.halves().map(&mut aged));
    }
    let mut kept = waiting.into_vec();
    kept.sort_by_key(|entry| entry.age);
    kept.iter()
        .map(|entry| entry.patch.bounds())
        .filter(|bounds| bounds.overlaps(within))
        .collect()
}
