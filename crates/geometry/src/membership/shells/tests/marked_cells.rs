//! How many cells do shells mark in vain?

use std::cell::Cell;
use std::collections::BTreeSet;

use octray_math::{Aabb, DVec3};

use super::{Draw, boundary_points, placed, primitives, seen};
use crate::csg::{Lowering, reduce};
use crate::membership::shells::{ShellPatch, StepCounts, layer, shells};
use crate::profile::Formula;
use crate::surface::Side;
use crate::{FaceId, Primitive, SceneFrame, Solid};

const SIDE: u32 = 32;

/// The number of a cell along each axis.
fn place(p: DVec3) -> [u32; 3] {
    p.to_array().map(|p| (p.max(0.0) as u32).min(SIDE - 1))
}

/// Of 32^3 cells, how many does the boundary meet as far as its surfaces' bounds tell, how many do the shells,
/// and in how many do points of the boundary lie?
fn marked_cells(solid: &Solid) -> [usize; 3] {
    let (primitive, map) = placed(solid);
    let [own, within] = seen(&primitive, &map);
    let size = within.size() / f64::from(SIDE);
    let mut draw = Draw(13);
    let points = boundary_points(solid, (&own, &map), 20_000, &mut draw);
    let cell = |place: [u32; 3]| {
        let corner = within.min + size * DVec3::from_array(place.map(f64::from));
        Aabb::new(corner, corner + size)
    };
    let at = |p: &DVec3| place((*p - within.min) / size);
    let hit: BTreeSet<[u32; 3]> = points.iter().map(at).collect();
    let shells = shells(&primitive, &map, &within, 0.1 * size.length(), 1 << 16);
    let mut lowering = Lowering::new(&SceneFrame::around_origin(within.diagonal()));
    let code = lowering.lower(solid).expect("not constant");
    let lowered = lowering.finish();
    let bounds: Vec<Aabb> = shells.patches.iter().map(ShellPatch::bounds).collect();
    let mut marked = BTreeSet::new();
    for (patch, bounds) in shells.patches.iter().zip(&bounds) {
        let low = place((bounds.min - within.min) / size - 1e-9);
        let high = place((bounds.max - within.min) / size + 1e-9);
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let cell = cell([x, y, z]);
                    if patch.meets(&cell, &mut StepCounts::default()) {
                        marked.insert([x, y, z]);
                    }
                }
            }
        }
    }
    let mut analytic = 0;
    for index in 0..SIDE.pow(3) {
        let cell = cell([index % SIDE, index / SIDE % SIDE, index / SIDE / SIDE]);
        let mut truth = |id: FaceId| {
            let face = lowered.faces[id.0 as usize];
            match lowered.surfaces[face.surface.0 as usize].classify(&cell) {
                Side::Both => None,
                side => Some((side == Side::Negative) != face.inside_is_positive),
            }
        };
        analytic += usize::from(reduce(code.words(), &mut truth, &mut Vec::new()).is_none());
    }
    let missed = hit.difference(&marked).count();
    assert_eq!(missed, 0, "cells with points of the boundary");
    [analytic, marked.len(), hit.len()]
}

#[test]
#[expect(clippy::print_stdout, reason = "a table")]
fn few_cells_are_marked_in_vain() {
    println!(
        "{:16} {:>8} {:>8} {:>8}",
        "of 32768 cells", "analytic", "shells", "points"
    );
    for (shape, solid) in primitives() {
        let [analytic, marked, hit] = marked_cells(&solid);
        println!("{shape:16} {analytic:8} {marked:8} {hit:8}");
        let most = match shape {
            // As they are; the formula of a composite may even leave more undecided.
            "box" | "half-space" | "pyramid" | "staircase" | "gear" => 1.0,
            // Thinner than the chord error across.
            "long cylinder" | "thin torus" => 2.0,
            // Layers of boxes.
            "saddle" | "prism" | "lathe" | "quartic" | "superellipsoid" => 1.8,
            _ => 1.25,
        };
        assert!(
            marked as f64 <= most * analytic as f64,
            "{shape}: {marked}, analytic {analytic}"
        );
    }
}

/// In a layer of boxes about a prism of 2,000 sides, most are decided before the boxes are small.
#[test]
#[expect(clippy::print_stdout, reason = "figures")]
fn boxes_ask_only_what_was_open_around_them() {
    let sides = 2000;
    let (Primitive::Composite(composite), _) = placed(&super::gear(sides / 4)) else {
        panic!("a prism");
    };
    let (asked, boxes) = (Cell::new(0), Cell::new(0));
    let narrow = layer::composite_crosses(&composite);
    let counted = |open: &Formula, cell: &Aabb| {
        asked.set(asked.get() + names(open));
        boxes.set(boxes.get() + 1);
        narrow(open, cell)
    };
    let bounds = composite.bounds();
    let formula = composite.formula();
    let found = layer::boxes(&bounds, DVec3::ONE, 0.1, 1 << 14, formula, counted);
    let share = asked.get() as f64 / (boxes.get() * sides) as f64;
    println!("{share} of all sides were asked per box of {}", boxes.get());
    assert!(found.len() > 1000 && share < 0.2, "{} {share}", found.len());
}

/// How many sides a formula names.
fn names(formula: &Formula) -> usize {
    match formula {
        Formula::Constant(_) => 0,
        Formula::Side { .. } => 1,
        Formula::All(parts) | Formula::Any(parts) => parts.iter().map(names).sum(),
    }
}
