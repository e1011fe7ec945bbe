//! Outlines of more sides than there may be patches.

use std::f64::consts::TAU;

use octray_math::{Aabb, DVec2, DVec3};

use super::points::Near;
use super::{Draw, any_meets, placed};
use crate::Solid;
use crate::membership::shells::{ShellPatch, shells};
use crate::profile::Region;

/// A wheel of so many corners about a point, with teeth; and where its corners are.
fn wheel(corners: usize, center: DVec2) -> (Region, Vec<DVec2>) {
    let corner = |i: usize| {
        let angle = TAU * i as f64 / corners as f64;
        let radius = 1.0 + 0.05 * libm::sin(37.0 * angle) + 1e-4 * (i % 2) as f64;
        center + DVec2::new(libm::cos(angle), libm::sin(angle)) * radius
    };
    let all: Vec<DVec2> = (0..corners).map(corner).collect();
    (Region::polygon(&all).expect("a region"), all)
}

/// Of the solid's shells, all of which hold these points: how many patches, and how far apart they are for
/// a size of 1.
fn patches(solid: &Solid, points: &[DVec3], limit: usize) -> (usize, f64) {
    let (primitive, map) = placed(solid);
    let within = primitive.bounds().inflated(0.1);
    let shells = shells(&primitive, &map, &within, 1e-3, limit);
    let bounds: Vec<Aabb> = shells.patches.iter().map(ShellPatch::bounds).collect();
    let near = Near::new(&bounds, &within);
    for p in points {
        let cell = Aabb::new(*p, *p).inflated(1e-8);
        let is_held = near
            .at(*p)
            .any(|i| any_meets(&shells.patches[i..=i], &cell));
        assert!(is_held, "{p}");
    }
    (shells.patches.len(), shells.chord_error)
}

#[test]
fn prisms_are_exact_up_to_thousands_of_sides() {
    for sides in [10, 300, 1500] {
        let (region, corners) = wheel(sides, DVec2::ZERO);
        let solid = Solid::prism(&region, 0.0, 1.0).expect("valid");
        let points: Vec<DVec3> = corners.iter().map(|p| p.extend(1.0)).collect();
        let (count, error) = patches(&solid, &points, 1 << 14);
        assert!(
            error == 0.0 && count <= 7 * sides,
            "{sides}: {count} {error}"
        );
    }
}

#[test]
fn neighbouring_sides_share_patches_where_there_are_too_many() {
    let mut draw = Draw(5);
    let sides = 30_000;
    let (region, corners) = wheel(sides, DVec2::ZERO);
    let solid = Solid::tapered_prism(&region, [0.0, 1.0], [1.0, 0.5]).expect("valid");
    let points: Vec<DVec3> = corners
        .iter()
        .flat_map(|p| {
            [
                p.extend(0.0),
                (*p * 0.5).extend(1.0),
                (*p * 0.75).extend(0.5),
            ]
        })
        .collect();
    let mut last = 0.0;
    for limit in [4000, 600, 100] {
        let (count, error) = patches(&solid, &points, limit);
        assert!(
            count <= limit && error < 0.3 && error > last,
            "{count} {error}"
        );
        last = error;
    }
    let (region, corners) = wheel(sides / 10, DVec2::new(2.0, 0.0));
    let solid = Solid::lathe(&region).expect("valid");
    let turned = |p: &DVec2| {
        let angle = TAU * draw.unit();
        DVec3::new(p.x * libm::cos(angle), p.x * libm::sin(angle), p.y)
    };
    let points: Vec<DVec3> = corners.iter().map(turned).collect();
    let mut last = 0.0;
    for limit in [1 << 14, 2000, 200] {
        let (count, error) = patches(&solid, &points, limit);
        assert!(
            count <= limit && error < 1.5 && error > last,
            "{count} {error}"
        );
        last = error;
    }
}
