//! Menger's sponge of coincident boxes, against integers.
//!
//! Level 4 as a cube minus 2,460 bars, all of which end in the cube's faces and many of which share
//! faces with each other, and level 3 as the union of its 8,000 touching cubes.

use octray_geometry::Solid;
use octray_math::DVec3;

use crate::draw::Draw;
use crate::subject::{Motion, Subject, assert_same_intervals, cases, chains, moved};
use crate::voxels::{DENOMINATOR, GridLine};

/// Whether a cube of the grid belongs to the sponge: no digit of base 3 is 1 in two coordinates.
fn filled(mut cube: [i64; 3]) -> bool {
    while cube.iter().any(|i| *i > 0) {
        if cube.iter().filter(|i| **i % 3 == 1).count() > 1 {
            return false;
        }
        cube = cube.map(|i| i / 3);
    }
    true
}

fn edge(level: u32) -> i64 {
    3_i64.pow(level)
}

fn cuboid(a: [i64; 3], b: [i64; 3]) -> Solid {
    let corner = |v: [i64; 3]| DVec3::from_array(v.map(|x| x as f64));
    Solid::cuboid(corner(a), corner(b)).expect("valid")
}

/// The bars to be cut out of `[0, 3^level]^3`, as long as it is.
fn bars(level: u32) -> Vec<Solid> {
    let n = edge(level);
    let mut bars = Vec::new();
    for l in 1..=level {
        let width = edge(level - l);
        let holes = (0..edge(l - 1)).map(|i| (3 * i + 1) * width);
        for axis in 0..3 {
            for (u, v) in holes
                .clone()
                .flat_map(|u| holes.clone().map(move |v| (u, v)))
            {
                let mut low = [0; 3];
                let mut high = [n; 3];
                for (side, at) in [(1, u), (2, v)] {
                    low[(axis + side) % 3] = at;
                    high[(axis + side) % 3] = at + width;
                }
                bars.push(cuboid(low, high));
            }
        }
    }
    bars
}

fn cut(level: u32) -> Solid {
    let whole = cuboid([0; 3], [edge(level); 3]);
    Solid::difference(std::iter::once(whole).chain(bars(level)))
}

fn assembled(level: u32) -> Solid {
    let n = edge(level);
    let cubes = (0..n * n * n)
        .map(|i| [i / (n * n), i / n % n, i % n])
        .filter(|cube| filled(*cube));
    Solid::union(cubes.map(|cube| cuboid(cube, cube.map(|i| i + 1))))
}

/// Through a random point of the grid, both ways.
fn line(draw: &mut Draw, n: i64) -> GridLine {
    let fine = (n * DENOMINATOR) as i32;
    GridLine {
        origin: std::array::from_fn(|_| i64::from(draw.whole(0, fine))),
        direction: std::array::from_fn(|_| i64::from(draw.whole(-1000, 1000))),
    }
}

/// Rounding of `t` for lines through `[0, n]^3` of whole directions: the distance from the origin
/// of the line is at most `2 n`, the largest component of the direction at least `d`.
fn rounding(n: i64, line: &GridLine) -> f64 {
    let steepest = line.direction.iter().map(|d| d.abs()).max().unwrap_or(1);
    // A plane that is met at a flat angle is met with that much less precision.
    let flattest = line.direction.iter().map(|d| d.abs()).filter(|d| *d > 0);
    let flattest = flattest.min().unwrap_or(1);
    let ratio = steepest as f64 / flattest as f64;
    16.0 * f64::EPSILON * n as f64 / steepest as f64 * ratio
}

fn check_exactly(subject: &Subject, level: u32, line: &GridLine) -> usize {
    let n = edge(level);
    let met = line.met(n, filled);
    let got = subject.intervals(line.ray());
    assert_same_intervals(&got, &met.intervals, rounding(n, line), line.ray());
    got.len()
}

/// Lines in general position and lines parallel to axes and to faces, but not in them.
fn check_general_lines(subject: &Subject, level: u32, rays: u64) {
    let mut met = 0;
    for case in 0..rays {
        let draw = &mut Draw::new(30, case);
        let mut line = line(draw, edge(level));
        for axis in 0..3 {
            // Clear of the planes of the grid.
            line.origin[axis] |= 1;
        }
        if case % 4 == 3 {
            let axis = draw.below(3);
            (0..1 + draw.below(2)).for_each(|i| line.direction[(axis + i) % 3] = 0);
        }
        // All three zero, or through an edge: another test's business.
        if line.direction != [0; 3] && !line.met(edge(level), filled).edge {
            met += check_exactly(subject, level, &line);
        }
    }
    assert!(met as u64 > 2 * rays, "{met} intervals on {rays} rays");
}

/// Lines that run in planes of the grid and along its edges: on one side of each, the same for all
/// boxes that have a face there.
fn check_lines_in_faces(subject: &Subject, level: u32, rays: u64) {
    let n = edge(level);
    for case in 0..rays {
        let draw = &mut Draw::new(31, case);
        let mut line = line(draw, n);
        line.origin = line.origin.map(|x| x | 1);
        let axis = draw.below(3);
        for i in 0..1 + draw.below(2) {
            let flat = (axis + i) % 3;
            line.direction[flat] = 0;
            line.origin[flat] = i64::from(draw.whole(0, n as i32)) * DENOMINATOR;
        }
        if line.direction != [0; 3] && !line.met(n, filled).edge {
            check_exactly(subject, level, &line);
        }
    }
}

/// Lines through edges and corners of whole coordinates: all planes that meet there are crossed at
/// one parameter, so that what touches only in an edge is not met.
fn check_lines_through_edges(subject: &Subject, level: u32, rays: u64) {
    let n = edge(level);
    let mut through = 0;
    for case in 0..rays {
        let draw = &mut Draw::new(32, case);
        let whole = |draw: &mut Draw, low, high| -> [i64; 3] {
            std::array::from_fn(|_| i64::from(draw.whole(low, high)))
        };
        let line = GridLine {
            origin: whole(draw, 0, n as i32).map(|x| x * DENOMINATOR),
            direction: whole(draw, -3, 3),
        };
        if line.direction != [0; 3] {
            check_exactly(subject, level, &line);
            through += u64::from(line.met(n, filled).edge);
        }
    }
    assert!(through > rays / 2, "{through} of {rays}");
}

#[test]
fn a_sponge_of_level_4_cut_by_coincident_boxes_is_right_on_every_line() {
    let subject = Subject::one(&cut(4));
    check_general_lines(&subject, 4, cases(2000));
    check_lines_in_faces(&subject, 4, cases(1000));
    check_lines_through_edges(&subject, 4, cases(1000));
}

#[test]
fn a_sponge_of_8000_touching_cubes_is_right_on_every_line() {
    let subject = Subject::one(&assembled(3));
    check_general_lines(&subject, 3, cases(2000));
    check_lines_in_faces(&subject, 3, cases(1000));
    check_lines_through_edges(&subject, 3, cases(1000));
}

#[test]
fn a_sponge_whose_bars_were_turned_each_in_its_own_way_is_right() {
    let level = 3;
    let motion = Motion {
        degrees: DVec3::new(33.3, -71.0, 128.7),
        offset: DVec3::new(7.7, -23.0, 19.0),
    };
    let chains = chains(&motion);
    let bars = bars(level);
    let bars = bars.iter().zip(chains.iter().cycle());
    let whole = moved(&cuboid([0; 3], [edge(level); 3]), &chains[3]);
    let bars = bars.map(|(bar, chain)| moved(bar, chain));
    let subject = Subject::one(&Solid::difference(std::iter::once(whole).chain(bars)));
    for case in 0..cases(2000) {
        let draw = &mut Draw::new(33, case);
        let mut line = line(draw, edge(level));
        // A line in a face is on one side of it or the other, for every bar as it was rounded.
        line.origin = line.origin.map(|x| x | 1);
        let met = line.met(edge(level), filled);
        if line.direction == [0; 3] || met.edge {
            continue;
        }
        let ray = line.ray().transformed(&motion.matrix());
        let tolerance = 64.0 * rounding(edge(level), &line);
        assert_same_intervals(&subject.intervals(ray), &met.intervals, tolerance, ray);
    }
}

/// Through the middle of every column of cubes along every axis.
fn columns(n: i64) -> impl Iterator<Item = GridLine> {
    let middle = |i: i64| i * DENOMINATOR + DENOMINATOR / 2;
    (0..3 * n * n).map(move |i| {
        let axis = (i / (n * n)) as usize;
        let mut line = GridLine {
            origin: [0; 3],
            direction: [0; 3],
        };
        line.direction[axis] = 1;
        line.origin[(axis + 1) % 3] = middle(i / n % n);
        line.origin[(axis + 2) % 3] = middle(i % n);
        line
    })
}

#[test]
fn volume_and_area_of_every_sponge_are_exact() {
    for level in 1..=4 {
        let subject = Subject::one(&cut(level));
        let (mut volume, mut area) = (0.0, 0);
        for line in columns(edge(level)) {
            let intervals = subject.intervals(line.ray());
            area += 2 * intervals.len();
            volume += intervals.iter().map(|[s, e]| e - s).sum::<f64>();
        }
        // Every cube lies in three columns; V = (20/27)^n, A = 2 (20/9)^n + 4 (8/9)^n.
        let power = |base: i64| base.pow(level);
        assert_eq!(volume / 3.0, power(20) as f64);
        assert_eq!(area as i64, 2 * power(20) + 4 * power(8));
    }
}
