//! A court with two storeys of colonnades: fluted shafts, mouldings, planks, bars and stairs, most of
//! them of triangles much longer than wide.

use std::f64::consts::PI;

use octray::math::{DMat3, DVec3};

use super::{Soup, Subject};

/// Half of the court's length and width, and the depth of the walk around it.
const COURT: [f64; 2] = [18.0, 7.0];
const WALK: f64 = 4.0;
const STOREY: f64 = 6.0;
/// Columns along a long and along a short side, without the corners.
const BAYS: [usize; 2] = [14, 6];
/// Radius and height, from the foot of a column to its top.
const COLUMN: [[f64; 2]; 11] = [
    [0.52, 0.0],
    [0.52, 0.15],
    [0.46, 0.22],
    [0.44, 0.30],
    [0.36, 0.36],
    [0.32, 4.10],
    [0.37, 4.16],
    [0.34, 4.24],
    [0.42, 4.40],
    [0.55, 4.46],
    [0.55, 4.60],
];
const BALUSTER: [[f64; 2]; 5] = [
    [0.06, 0.0],
    [0.03, 0.1],
    [0.07, 0.3],
    [0.03, 0.7],
    [0.06, 0.8],
];
/// Outward and upward steps of a cornice's section.
const MOULDING: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [0.08, 0.02],
    [0.08, 0.10],
    [0.14, 0.16],
    [0.22, 0.18],
    [0.22, 0.26],
    [0.30, 0.32],
    [0.34, 0.40],
    [0.0, 0.44],
];

pub(super) fn make(name: &'static str, turn: &DMat3) -> Subject {
    let mut soup = Soup::default();
    for storey in 0..2 {
        colonnade(&mut soup, f64::from(storey) * STOREY);
    }
    walls(&mut soup);
    stairs(&mut soup);
    let (positions, triangles) = soup.finish(turn);
    Subject {
        name,
        positions,
        triangles,
        eye: *turn * DVec3::new(-16.0, -4.5, 3.2),
        target: *turn * DVec3::new(4.0, 2.0, 4.6),
        up: *turn * DVec3::Z,
        angle: 62.0,
        light: *turn * DVec3::new(3.0, -2.0, 11.0),
    }
}

/// Columns with arches between them, a balustrade, cornices and the floor above.
fn colonnade(soup: &mut Soup, floor: f64) {
    let sides = [
        (
            BAYS[0],
            DVec3::new(-COURT[0], -COURT[1], 0.0),
            DVec3::X * (2.0 * COURT[0]),
        ),
        (
            BAYS[0],
            DVec3::new(-COURT[0], COURT[1], 0.0),
            DVec3::X * (2.0 * COURT[0]),
        ),
        (
            BAYS[1],
            DVec3::new(-COURT[0], -COURT[1], 0.0),
            DVec3::Y * (2.0 * COURT[1]),
        ),
        (
            BAYS[1],
            DVec3::new(COURT[0], -COURT[1], 0.0),
            DVec3::Y * (2.0 * COURT[1]),
        ),
    ];
    for (bays, start, along) in sides {
        let start = start + DVec3::Z * floor;
        let bay = along / bays as f64;
        for k in 0..bays {
            let foot = start + bay * k as f64;
            column(soup, foot);
            arch(soup, foot + DVec3::Z * 4.6, bay);
            if floor > 0.0 {
                for b in 1..8 {
                    let place = foot + bay * (f64::from(b) / 8.0);
                    soup.lathe(place, &BALUSTER, 8, |_, _| 1.0);
                }
                let half = DVec3::splat(0.07);
                soup.block(
                    foot - half + DVec3::Z * 0.86,
                    foot + bay + half + DVec3::Z * 0.86,
                );
            }
        }
    }
    for height in [5.4, 5.75] {
        cornice(soup, floor + height);
    }
    // The floor above the walk: planks side by side, each as long as the court.
    let planks = 16;
    for k in 0..planks {
        for side in [-1.0, 1.0] {
            let y = side * (COURT[1] + WALK * (f64::from(k) + 0.5) / f64::from(planks));
            let half = DVec3::new(COURT[0] + WALK, 0.48 * WALK / f64::from(planks), 0.06);
            let center = DVec3::new(0.0, y, floor + STOREY - 0.1);
            soup.block(center - half, center + half);
            let x = side * (COURT[0] + WALK * (f64::from(k) + 0.5) / f64::from(planks));
            let half = DVec3::new(0.48 * WALK / f64::from(planks), COURT[1], 0.06);
            let center = DVec3::new(x, 0.0, floor + STOREY - 0.1);
            soup.block(center - half, center + half);
        }
    }
}

/// A shaft with sixteen flutes that run its whole height.
fn column(soup: &mut Soup, foot: DVec3) {
    soup.lathe(foot, &COLUMN, 32, |angle, height| {
        let flute = if (0.36..4.11).contains(&height) {
            0.06
        } else {
            0.0
        };
        1.0 - flute * (0.5 + 0.5 * (16.0 * angle).cos())
    });
    let half = DVec3::new(0.6, 0.6, 0.05);
    soup.block(foot - half, foot + half);
    let top = foot + DVec3::Z * 4.62;
    soup.block(top - half, top + half);
}

/// A half ring from column to column, and what stands on it up to the cornice.
fn arch(soup: &mut Soup, from: DVec3, bay: DVec3) {
    let (along, span) = (bay.normalize(), bay.length());
    let across = along.cross(DVec3::Z) * 0.3;
    let (outer, inner, rise) = (span / 2.0, span / 2.0 - 0.35, 0.8);
    for side in [-1.0, 1.0] {
        soup.lattice((3, 17), false, |i, j| {
            let angle = PI * j as f64 / 16.0;
            let radius = if i == 0 { inner } else { outer };
            let up = if i == 2 {
                rise
            } else {
                rise / outer * radius * angle.sin()
            };
            from + along * (span / 2.0 - radius * angle.cos()) + DVec3::Z * up + across * side
        });
    }
    soup.lattice((2, 17), false, |i, j| {
        let angle = PI * j as f64 / 16.0;
        let up = rise / outer * inner * angle.sin();
        let side = if i == 0 { -1.0 } else { 1.0 };
        from + along * (span / 2.0 - inner * angle.cos()) + DVec3::Z * up + across * side
    });
}

/// A section drawn around the court, one long square to a side.
fn cornice(soup: &mut Soup, height: f64) {
    soup.lattice((MOULDING.len(), 4), true, |i, j| {
        let [inward, up] = MOULDING[i];
        let x = if matches!(j, 0 | 3) { -1.0 } else { 1.0 };
        let y = if j < 2 { -1.0 } else { 1.0 };
        let [long, wide] = COURT.map(|half| half + 0.3 - inward);
        DVec3::new(x * long, y * wide, height + up)
    });
}

/// The ground, outer walls with barred windows, and wires across the court.
fn walls(soup: &mut Soup) {
    let [long, wide] = COURT.map(|half| half + WALK);
    let top = 2.0 * STOREY + 0.6;
    soup.block(DVec3::new(-long, -wide, -0.3), DVec3::new(long, wide, 0.0));
    for side in [-1.0, 1.0] {
        let (y, x) = (side * (wide + 0.2), side * (long + 0.2));
        soup.block(
            DVec3::new(-long, y - 0.2, 0.0),
            DVec3::new(long, y + 0.2, top),
        );
        soup.block(
            DVec3::new(x - 0.2, -wide, 0.0),
            DVec3::new(x + 0.2, wide, top),
        );
        for storey in [0.0, STOREY] {
            for window in 0..12 {
                let left = -long + 1.2 + f64::from(window) * 3.55;
                for bar in 0..9 {
                    let middle = DVec3::new(left + 0.2 * f64::from(bar), side * (wide - 0.1), 0.0);
                    soup.block(
                        middle + DVec3::new(-0.02, -0.02, storey + 1.0),
                        middle + DVec3::new(0.02, 0.02, storey + 4.0),
                    );
                }
            }
        }
    }
    for wire in 0..60 {
        let x = -COURT[0] + 0.6 * (f64::from(wire) + 0.5);
        let half = DVec3::new(0.01, COURT[1], 0.01);
        let center = DVec3::new(x, 0.0, 2.0 * STOREY - 0.4 + 0.15 * f64::from(wire % 3));
        soup.block(center - half, center + half);
    }
}

/// Two flights, each step a slab as wide as the flight.
fn stairs(soup: &mut Soup) {
    let steps = 30;
    for side in [-1.0, 1.0] {
        for step in 0..steps {
            let (out, up) = (
                f64::from(step) * 0.3,
                f64::from(step + 1) * STOREY / f64::from(steps),
            );
            let x = side * (COURT[0] - 2.0 - out);
            soup.block(
                DVec3::new(x - 0.16, -1.8, up - 0.06),
                DVec3::new(x + 0.16, 1.8, up),
            );
            soup.block(
                DVec3::new(x - 0.02, -1.75, up - 0.2),
                DVec3::new(x + 0.02, -1.70, up + 0.9),
            );
        }
    }
}
