//! Solids that share a boundary have no wall between them.
//!
//! Every assembly is given as pieces that touch and do not overlap. The oracle traces each piece
//! alone, joins the intervals that touch, and must find what octray finds in the union.

use octray_geometry::Solid;
use octray_math::{Aabb, DAffine3, DVec3};

use crate::draw::Draw;
use crate::subject::{
    Motion, Subject, assert_same_intervals, axis_ray, cases, chains, general_ray, joined, moved,
};

fn cuboid(a: [f64; 3], b: [f64; 3]) -> Solid {
    Solid::cuboid(DVec3::from_array(a), DVec3::from_array(b)).expect("valid")
}

fn cylinder(radius: f64, z0: f64, z1: f64) -> Solid {
    Solid::cylinder(radius, z0, z1).expect("valid")
}

fn cone(r0: f64, r1: f64, z0: f64, z1: f64) -> Solid {
    Solid::cone(r0, r1, z0, z1).expect("valid")
}

fn sphere(radius: f64) -> Solid {
    Solid::sphere(radius).expect("valid")
}

fn torus(major: f64, minor: f64) -> Solid {
    Solid::torus(major, minor).expect("valid")
}

fn minus(a: &Solid, b: &Solid) -> Solid {
    Solid::difference([a.clone(), b.clone()])
}

fn above(height: f64) -> Solid {
    Solid::half_space(DVec3::NEG_Z, -height).expect("valid")
}

/// A box in 27 boxes whose faces lie at thirds, which are no short numbers.
fn bricks() -> Vec<Solid> {
    let cut = [-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0];
    let mut pieces = Vec::new();
    for i in 0..27 {
        let [x, y, z] = [i / 9, i / 3 % 3, i % 3];
        pieces.push(cuboid(
            [cut[x], cut[y], cut[z]],
            [cut[x + 1], cut[y + 1], cut[z + 1]],
        ));
    }
    pieces
}

/// A plate with a stud on it, one through a bore of it, and a block beside.
fn studs() -> Vec<Solid> {
    let plate = cuboid([-2.0, -2.0, -0.7], [2.0, 2.0, 0.3]);
    let place = DVec3::new(1.1, 0.9, 0.0);
    let bolt = cylinder(0.6, -0.7, 0.3).translate(place).expect("finite");
    let head = cylinder(0.6, 0.3, 1.2).translate(place).expect("finite");
    vec![
        minus(&plate, &bolt),
        bolt,
        head,
        cylinder(1.0, 0.3, 1.1)
            .translate(DVec3::new(-0.8, -0.8, 0.0))
            .expect("finite"),
        cuboid([2.0, -1.3, -0.7], [2.9, 0.4, 1.2]),
    ]
}

/// Each in the next larger one's hollow.
fn shells(solids: &[Solid]) -> Vec<Solid> {
    let mut pieces: Vec<Solid> = solids.windows(2).map(|w| minus(&w[1], &w[0])).collect();
    pieces.push(solids[0].clone());
    pieces
}

/// Frusta that continue each other, and what is left around them.
fn cones() -> Vec<Solid> {
    let stack = [
        cone(2.0, 1.4, -1.0, -0.1),
        cone(1.4, 0.7, -0.1, 0.95),
        cone(0.7, 0.0, 0.95, 2.0),
    ];
    let all = cone(2.0, 0.0, -1.0, 2.0);
    let mut pieces = stack.to_vec();
    pieces.push(minus(&cylinder(2.0, -1.0, 2.0), &all));
    pieces
}

/// A ring in two halves, in a block with its negative.
fn rings() -> Vec<Solid> {
    let ring = torus(1.5, 0.4);
    let block = cuboid([-2.0, -2.0, -0.4], [2.0, 2.0, 0.4]);
    vec![
        Solid::intersection([ring.clone(), above(0.1)]),
        minus(&ring, &above(0.1)),
        minus(&block, &ring),
    ]
}

/// A flattened ball in a bore that it fits.
fn ellipsoids() -> Vec<Solid> {
    let flat = sphere(1.0)
        .transform(DAffine3::from_scale(DVec3::new(1.2, 0.9, 0.5)))
        .expect("invertible");
    vec![
        minus(&cuboid([-1.5, -1.0, -0.5], [1.5, 1.0, 0.7]), &flat),
        flat,
    ]
}

pub(crate) fn assemblies() -> Vec<(&'static str, Vec<Solid>)> {
    vec![
        ("bricks", bricks()),
        ("studs", studs()),
        (
            "balls",
            shells(&[sphere(0.3), sphere(1.0 / 1.5), sphere(1.7)]),
        ),
        (
            "tubes",
            shells(&[
                cylinder(0.3, -1.0, 1.3),
                cylinder(0.9, -1.0, 1.3),
                cylinder(1.1, -1.0, 1.3),
            ]),
        ),
        (
            "hoops",
            shells(&[torus(1.3, 0.2), torus(1.3, 0.5), torus(1.3, 0.7)]),
        ),
        ("cones", cones()),
        ("rings", rings()),
        ("ellipsoids", ellipsoids()),
    ]
}

/// The pieces one by one and together.
pub(crate) struct Assembly {
    pieces: Vec<Subject>,
    whole: Subject,
    pub(crate) bounds: Aabb,
}

impl Assembly {
    pub(crate) fn new(solids: &[Solid]) -> Self {
        let whole = Solid::union(solids.iter().cloned());
        Self {
            pieces: solids.iter().map(Subject::one).collect(),
            bounds: whole.bounds(),
            whole: Subject::one(&whole),
        }
    }

    /// `gap`: what counts as touching; the pieces alone are not given the same rounding.
    pub(crate) fn check(&self, ray: octray_math::Ray, gap: f64) -> usize {
        let alone = self.pieces.iter().flat_map(|piece| piece.intervals(ray));
        let expected = joined(alone.collect(), gap);
        let got = self.whole.intervals(ray);
        assert_same_intervals(&got, &expected, gap, ray);
        got.len()
    }
}

#[test]
fn no_wall_stands_between_solids_that_touch() {
    for (seed, (name, pieces)) in assemblies().into_iter().enumerate() {
        let assembly = Assembly::new(&pieces);
        let mut met = 0;
        let rays = cases(1250);
        for case in 0..rays {
            let draw = &mut Draw::new(seed as u64, case);
            let ray = if case % 2 == 0 {
                axis_ray(draw, &assembly.bounds)
            } else {
                general_ray(draw, &assembly.bounds)
            };
            met += assembly.check(ray, 1e-12);
        }
        assert!(met as u64 > rays / 2, "{name}: {met}");
    }
}

#[test]
fn no_wall_stands_between_solids_that_touch_after_turning_each_in_its_own_way() {
    let motion = Motion {
        degrees: DVec3::new(33.3, -71.0, 128.7),
        offset: DVec3::new(0.77, -2.3, 1.9),
    };
    let chains = chains(&motion);
    for (seed, (name, pieces)) in assemblies().into_iter().enumerate() {
        let turned: Vec<Solid> = pieces
            .iter()
            .enumerate()
            .map(|(index, piece)| moved(piece, &chains[index % chains.len()]))
            .collect();
        let assembly = Assembly::new(&turned);
        let mut met = 0;
        let rays = cases(1250);
        for case in 0..rays {
            let draw = &mut Draw::new(100 + seed as u64, case);
            let ray = if case % 2 == 0 {
                // Along an axis of the solids.
                let straight = Assembly::new(&pieces[..1]).bounds;
                let ray = axis_ray(draw, &straight);
                ray.transformed(&motion.matrix())
            } else {
                general_ray(draw, &assembly.bounds)
            };
            met += assembly.check(ray, 1e-11);
        }
        assert!(met as u64 > rays / 2, "{name}: {met}");
    }
}

#[test]
fn lines_in_the_faces_that_bricks_share_see_one_solid() {
    // Exact coordinates: a line in a face is on one side of it for all bricks alike.
    let assembly = Assembly::new(&bricks());
    let whole = Subject::one(&cuboid([-1.0; 3], [1.0; 3]));
    let levels = [-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0];
    for case in 0..cases(2000) {
        let draw = &mut Draw::new(7, case);
        // In one shared plane, every other time in two: along a shared edge.
        let mut origin = DVec3::new(
            draw.between(-1.0, 1.0),
            draw.between(-1.0, 1.0),
            draw.between(-1.0, 1.0),
        );
        let mut direction = draw.direction();
        let axis = draw.below(3);
        for flat in axis..=axis + draw.below(2) {
            origin[flat % 3] = draw.pick(&levels);
            direction[flat % 3] = 0.0;
        }
        let ray = octray_math::Ray::new(origin, direction);
        let got = assembly.whole.intervals(ray);
        let expected = whole.intervals(ray);
        assert_eq!(got, expected, "{ray:?}");
    }
}

#[test]
fn a_drill_as_long_as_its_plate_leaves_a_clean_hole() {
    // difference() { cube(10); cylinder(h = 10); }, upright and turned.
    let plate = cuboid([0.0; 3], [10.0; 3]);
    let drill = cylinder(1.0, 0.0, 10.0);
    let motion = Motion {
        degrees: DVec3::new(12.0, 34.0, 56.0),
        offset: DVec3::new(-3.0, 5.0, 0.5),
    };
    let chains = chains(&motion);
    let still = Subject::one(&minus(&plate, &drill));
    let turned: Vec<Subject> = chains
        .iter()
        .map(|chain| Subject::one(&minus(&moved(&plate, &chains[0]), &moved(&drill, chain))))
        .collect();
    for case in 0..cases(4000) {
        let draw = &mut Draw::new(8, case);
        // Parallel to the axis: through the quarter of the hole that the plate's corner holds, or
        // past it through the full height.
        let x = draw.between(-1.0, 4.0);
        let y = draw.between(-1.0, 4.0);
        let ray = octray_math::Ray::new(DVec3::new(x, y, 20.0), DVec3::NEG_Z);
        let solid = x > 0.0 && y > 0.0 && x * x + y * y > 1.0;
        let expected: &[[f64; 2]] = if solid { &[[10.0, 20.0]] } else { &[] };
        assert_eq!(still.intervals(ray), expected);
        let subject = &turned[draw.below(turned.len())];
        let ray = ray.transformed(&motion.matrix());
        assert_same_intervals(&subject.intervals(ray), expected, 1e-12, ray);
    }
}
