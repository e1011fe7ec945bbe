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
//! | box, half-space, polyhedron, mesh, caps, straight sides of prisms, facets of lathes that turn in steps | the polygons themselves, both shells in one |
//! | sphere, cylinder, cone | triangles with corners on the surface, and the same ones scaled outwards |
//! | torus, also the outer shape of a spindle | nets on tubes of two radii, by a bound of the second derivatives |
//! | curved sides of prisms | the chords of pieces of the curves, and the same moved as far as the curve is high over its chord |
//! | lathe, quadric, superellipsoid | such chords and heights of the outline, turned from facet to facet and as much wider as the turn is than its chord |
//! | polynomial of degree 3 and more | both sides of a layer of boxes that the boundary may cross: it has no parametrisation |
//!
//! Quadrics that are ellipsoids, cylinders or frusta of cones are those primitives under an affine map; the
//! others have no end, and are cut off where nothing is looked at. Where there would be too many patches, neighbouring
//! edges of an outline share one, and pieces stay larger.
//!
//! All of it is made in the primitive's own frame: hulls survive any affine map.

mod band;
mod curved;
mod flat;
mod layer;
mod patch;
mod plane_curve;
mod refine;
mod round;
mod strokes;
mod swept;
#[cfg(test)]
mod tests;
mod trapezoids;

use std::sync::Arc;

use octray_math::{Aabb, DAffine3, DVec3};

use crate::Primitive;
use crate::boundary::Boundary;
use crate::surface::Canonical;
use refine::refined;
use swept::Aim;

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
/// `limit` patches where fewer will do (a mesh or polyhedron has as many as it has triangles): then
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
    let aims = Aim { error: aim, limit };
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
        Primitive::Quadric(form) => curved::quadric(*form, &region, aims),
        Primitive::Polynomial { polynomial, .. } => {
            let m = scene_from_local.matrix3;
            let scale = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
            let canonical = Canonical::Polynomial(Arc::clone(polynomial));
            let cells = layer::boxes(&region, scale, chord_error, (limit / 2).max(1), canonical);
            let thickness = cells.first().map_or(0.0, Aabb::diagonal);
            (cells.iter().flat_map(layer::prisms).collect(), thickness)
        }
        Primitive::Superellipsoid { exponents } => {
            curved::superellipsoid(*exponents, &region, aims)
        }
        Primitive::HalfSpace { normal, offset } => {
            let (center, radius) = (region.center(), 0.5 * region.diagonal());
            (flat::plane(*normal, *offset, center, radius), 0.0)
        }
        Primitive::Convex(polyhedron) => (flat::convex(polyhedron), 0.0),
        Primitive::Composite(composite) => {
            let bounds = composite.bounds();
            let size = bounds.diagonal();
            match composite.boundary() {
                // What is smaller than the error needs no more than its box.
                Boundary::Triangles { .. } if size <= aim => {
                    (layer::prisms(&bounds).to_vec(), size)
                }
                Boundary::Triangles { triangles, .. } => (
                    triangles.iter().copied().map(ShellPatch::flat).collect(),
                    0.0,
                ),
                Boundary::Prism { pieces, z, scale } => {
                    swept::prism(pieces, *z, *scale, size, aims)
                }
                Boundary::Lathe { pieces, turning } => swept::lathe(pieces, *turning, size, aims),
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
    let length = |patch: &ShellPatch| patch.bounds().size().max_element();
    let pieces = refined(shells.patches, length, size, limit, ShellPatch::halves);
    pieces
        .iter()
        .map(ShellPatch::bounds)
        .filter(|bounds| bounds.overlaps(within))
        .collect()
}
