//! No cube that the surface meets is missing, and few are that it does not.

mod marked_cells;

use octray_math::{Aabb, DAffine3, DMat3, DVec2, DVec3, Ray};

use super::{ShellPatch, StepCounts, cover, shells};
use crate::csg::{Lowering, evaluate};
use crate::polynomial::powers;
use crate::profile::{Edge, Outline, Region};
use crate::{FaceId, Polynomial, Primitive, SceneFrame, Solid, SolidNode};

/// Random numbers between 0 and 1.
struct Draw(u64);

impl Draw {
    fn unit(&mut self) -> f64 {
        self.0 = octray_math::hash_combine(self.0, 11);
        octray_math::unit_f64(self.0)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// Points at which random lines through a box, given in a frame of its own, cross the boundary, `count` of
/// them.
fn boundary_points(
    solid: &Solid,
    (around, map): (&Aabb, &DAffine3),
    count: usize,
    draw: &mut Draw,
) -> Vec<DVec3> {
    let seen = around.transformed(map);
    let mut lowering = Lowering::new(&SceneFrame::around_origin(seen.diagonal()));
    let code = lowering.lower(solid).expect("not constant");
    let lowered = lowering.finish();
    let mut points = Vec::new();
    let mut lines = 0;
    while points.len() < count {
        lines += 1;
        assert!(lines < 400 * count + 1000, "the lines miss the solid");
        let mut point = || {
            let share = DVec3::new(draw.unit(), draw.unit(), draw.unit());
            map.transform_point3(around.min + around.size() * share)
        };
        let through = point();
        let direction = point() - through;
        if direction == DVec3::ZERO {
            continue;
        }
        let ray = Ray::new(through, direction);
        let mut events = Vec::new();
        let mut negative = Vec::new();
        for (index, surface) in lowered.surfaces.iter().enumerate() {
            negative.push(surface.crossings(&ray, |t| events.push((t, index))));
        }
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        let inside = |negative: &[bool]| {
            evaluate(code.words(), &|id: FaceId| {
                let face = lowered.faces[id.0 as usize];
                negative[face.surface.0 as usize] != face.inside_is_positive
            })
        };
        let mut before = inside(&negative);
        for group in events.chunk_by(|a, b| a.0 == b.0) {
            for (_, surface) in group {
                negative[*surface] ^= true;
            }
            let after = inside(&negative);
            let p = ray.at(group[0].0);
            if before != after && seen.contains(p) {
                points.push(p);
            }
            before = after;
        }
    }
    points
}

/// The primitive of a solid, and where it is.
fn placed(solid: &Solid) -> (Primitive, DAffine3) {
    let mut map = DAffine3::IDENTITY;
    let mut at = solid;
    loop {
        match at.node() {
            SolidNode::Primitive(primitive) => return (primitive.clone(), map),
            SolidNode::Transformed {
                child,
                parent_from_child,
            } => {
                map *= *parent_from_child;
                at = child;
            }
            other => panic!("not a primitive: {other:?}"),
        }
    }
}

/// A region with a notch, a straight side and an arc, to the right of the y axis.
fn region() -> Region {
    let v = DVec2::new;
    let mut outline = Outline::starting_at(v(0.2, -1.0));
    outline.push(Edge::Line, v(1.0, -1.0));
    outline.push(Edge::Quadratic(v(1.8, 0.0)), v(1.0, 1.0));
    outline.push(Edge::Line, v(0.2, 1.0));
    outline.push(Edge::Line, v(0.7, 0.0));
    Region::new(&[outline]).expect("a region")
}

/// `x^4 + y^4 + z^4 - 1 < 0`.
fn quartic() -> Solid {
    let coefficients: Vec<f64> = powers(4)
        .map(|power| match power {
            [0, 0, 0] => -1.0,
            [4, 0, 0] | [0, 4, 0] | [0, 0, 4] => 1.0,
            _ => 0.0,
        })
        .collect();
    let polynomial = Polynomial::new(4, &coefficients).expect("valid");
    Solid::polynomial(polynomial).expect("bounded")
}

/// A cuboid with a step.
fn staircase() -> Solid {
    let profile = [
        (0.0, 0.0),
        (2.0, 0.0),
        (2.0, 1.0),
        (1.0, 1.0),
        (1.0, 2.0),
        (0.0, 2.0),
    ];
    let corners: Vec<DVec3> = [0.0, 1.0]
        .into_iter()
        .flat_map(|z| profile.map(|(x, y)| DVec3::new(x, y, z)))
        .collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..6).rev().collect(), (6..12).collect()];
    faces.extend((0..6).map(|i| vec![i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6]));
    Solid::polyhedron(&corners, &faces).expect("closed")
}

/// A ring of teeth with a hole, tapering; `teeth` of them.
fn gear(teeth: usize) -> Solid {
    let rim = |scale: f64| -> Vec<DVec2> {
        let corner = |i: usize| {
            let angle = std::f64::consts::PI * i as f64 / teeth as f64;
            let radius = if i.is_multiple_of(2) { 1.0 } else { 0.8 };
            DVec2::new(libm::cos(angle), libm::sin(angle)) * (radius * scale)
        };
        (0..2 * teeth).map(corner).collect()
    };
    let outlines = [1.0, 0.5].map(|scale| Outline::polygon(&rim(scale)));
    let region = Region::new(&outlines).expect("a region");
    Solid::tapered_prism(&region, [-0.5, 0.8], [1.0, 0.6]).expect("valid")
}

/// One of every kind, and difficult ones.
fn primitives() -> Vec<(&'static str, Solid)> {
    let v = DVec3::new;
    let saddle = {
        let p = crate::Primitive::Quadric(crate::surface::QuadricForm::HyperbolicParaboloid);
        Solid::primitive(p)
    };
    let tower = crate::ConvexPolyhedron::from_faces(
        vec![
            v(-1.0, -1.0, 0.0),
            v(1.0, -1.0, 0.0),
            v(1.0, 1.0, 0.0),
            v(-1.0, 1.0, 0.0),
            v(0.0, 0.0, 3.0),
        ],
        &[
            vec![3, 2, 1, 0],
            vec![0, 1, 4],
            vec![1, 2, 4],
            vec![2, 3, 4],
            vec![3, 0, 4],
        ],
    );
    let tower = Primitive::Convex(std::sync::Arc::new(tower.expect("convex")));
    let good = |solid: Result<Solid, crate::ShapeError>| solid.expect("valid");
    vec![
        ("sphere", good(Solid::sphere(1.3))),
        (
            "box",
            good(Solid::cuboid(v(-1.0, -2.0, 0.0), v(0.5, 1.0, 2.0))),
        ),
        (
            "half-space",
            good(Solid::half_space(v(1.0, 2.0, -1.0), 0.3)),
        ),
        ("cylinder", good(Solid::cylinder(0.7, -1.0, 1.5))),
        ("long cylinder", good(Solid::cylinder(1e-3, -1.0, 1.0))),
        (
            "endless cylinder",
            Solid::primitive(Primitive::Cylinder {
                radius: 0.5,
                z: [f64::NEG_INFINITY, f64::INFINITY],
            }),
        ),
        ("cone", good(Solid::cone(1.0, 0.2, -1.0, 1.0))),
        ("needle", good(Solid::cone(1e-6, 0.0, -1.0, 1.0))),
        ("torus", good(Solid::torus(1.0, 0.3))),
        ("thin torus", good(Solid::torus(1.0, 1e-3))),
        ("spindle", good(Solid::torus(0.6, 1.0))),
        ("nearly a horn", good(Solid::torus(1.0, 0.99))),
        ("horn", good(Solid::torus(1.0, 1.0))),
        ("hardly a spindle", good(Solid::torus(1.0, 1.001))),
        ("saddle", saddle),
        ("pyramid", Solid::primitive(tower)),
        ("prism", good(Solid::prism(&region(), -0.5, 0.8))),
        ("lathe", good(Solid::lathe(&region()))),
        ("staircase", staircase()),
        ("gear", gear(12)),
        ("quartic", quartic()),
        (
            "superellipsoid",
            Solid::primitive(Primitive::Superellipsoid {
                exponents: [0.5, 0.8],
            }),
        ),
    ]
}

fn placements() -> Vec<(&'static str, DAffine3)> {
    let turn = DAffine3::from_rotation_x(0.7) * DAffine3::from_rotation_z(1.9);
    let shear = DAffine3::from_mat3(DMat3::from_cols(
        DVec3::new(1.0, 0.2, 0.0),
        DVec3::new(0.4, 0.9, 0.1),
        DVec3::new(0.0, 0.3, -1.2),
    ));
    vec![
        ("as it is", DAffine3::IDENTITY),
        ("turned", turn),
        ("sheared and mirrored", shear),
        (
            "flattened",
            turn * DAffine3::from_scale(DVec3::new(1.0, 1e-4, 1.0)),
        ),
        ("tiny", turn * DAffine3::from_scale(DVec3::splat(1e-9))),
        ("huge", turn * DAffine3::from_scale(DVec3::splat(1e12))),
    ]
}

/// What is looked at: in the primitive's frame, and in the scene.
fn seen(primitive: &Primitive, map: &DAffine3) -> [Aabb; 2] {
    let window = Aabb::new(DVec3::splat(-3.0), DVec3::splat(3.0));
    let own = primitive.bounds().intersection(window);
    let whole = own.transformed(map);
    [own, whole.inflated(1e-3 * whole.diagonal())]
}

fn any_meets(patches: &[ShellPatch], cell: &Aabb) -> bool {
    let mut counts = StepCounts::default();
    patches
        .iter()
        .any(|p| p.bounds().overlaps(cell) && p.meets(cell, &mut counts))
}

/// Which boxes are near a point, by a grid.
struct Near {
    low: DVec3,
    bin: DVec3,
    bins: Vec<Vec<u32>>,
}

impl Near {
    const SIDE: usize = 24;

    fn new(boxes: &[Aabb], around: &Aabb) -> Self {
        let bin = around.size() / Self::SIDE as f64;
        let mut near = Self {
            low: around.min,
            bin,
            bins: vec![Vec::new(); Self::SIDE.pow(3)],
        };
        for (index, bounds) in boxes.iter().enumerate() {
            let slack = 1e-9 * around.diagonal();
            let (low, high) = (
                near.place(bounds.min - slack),
                near.place(bounds.max + slack),
            );
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        near.bins[(z * Self::SIDE + y) * Self::SIDE + x].push(index as u32);
                    }
                }
            }
        }
        near
    }

    fn place(&self, p: DVec3) -> [usize; 3] {
        let q = (p - self.low) / self.bin;
        [q.x, q.y, q.z].map(|q| (q.max(0.0) as usize).min(Self::SIDE - 1))
    }

    fn at(&self, p: DVec3) -> impl Iterator<Item = usize> + '_ {
        let [x, y, z] = self.place(p);
        let bin = &self.bins[(z * Self::SIDE + y) * Self::SIDE + x];
        bin.iter().map(|index| *index as usize)
    }
}

/// Points per primitive and placement.
fn cases() -> usize {
    let factor = std::env::var("OCTRAY_CASES").ok();
    let factor = factor.map_or(1, |f| f.parse().expect("OCTRAY_CASES is a number"));
    300 * factor
}

/// With `OCTRAY_CASES=556` a million points per primitive.
#[test]
#[expect(clippy::print_stdout, reason = "the full run is reported")]
fn no_cell_that_the_surface_meets_is_missing() {
    std::thread::scope(|scope| {
        for (kind, (shape, solid)) in primitives().into_iter().enumerate() {
            scope.spawn(move || {
                let count = misses_nothing(shape, &solid, &mut Draw(7 + kind as u64));
                println!("{shape}: {count} points, none missed");
            });
        }
    });
}

/// The number of points.
fn misses_nothing(shape: &str, solid: &Solid, draw: &mut Draw) -> usize {
    let mut count = 0;
    for (pose, map) in placements() {
        let solid = solid.clone().transform(map).expect("invertible");
        let (primitive, map) = placed(&solid);
        let [own, within] = seen(&primitive, &map);
        let size = within.diagonal();
        let points = boundary_points(&solid, (&own, &map), cases(), draw);
        count += points.len();
        for (error, limit) in [(0.01, 1 << 16), (0.3, 100)] {
            let shells = shells(&primitive, &map, &within, error * size, limit);
            let boxes = cover(&primitive, &map, &within, error * size, limit);
            let bounds: Vec<Aabb> = shells.patches.iter().map(ShellPatch::bounds).collect();
            let near = [&bounds, &boxes].map(|boxes| Near::new(boxes, &within));
            for p in &points {
                let h = size * libm::exp2(draw.between(-20.0, 0.0));
                let share = DVec3::new(draw.unit(), draw.unit(), draw.unit());
                let low = *p - share * h;
                // Larger by less than cells are when their contents are decided.
                let cell = Aabb::new(low, low + h).inflated(1e-9 * size);
                // What holds the point is near it: nothing else may stand in for it.
                let meets = |i: usize| any_meets(&shells.patches[i..=i], &cell);
                assert!(
                    near[0].at(*p).any(meets),
                    "{shape} {pose}: {p} in {cell:?}, error {error}"
                );
                assert!(
                    near[1].at(*p).any(|i| boxes[i].overlaps(&cell)),
                    "{shape} {pose}: the cover misses {p}, error {error}"
                );
            }
        }
    }
    count
}

#[test]
fn shells_stay_as_close_to_the_surface_as_they_say() {
    let mut draw = Draw(9);
    for (shape, solid) in primitives() {
        let (primitive, map) = placed(&solid);
        let [own, within] = seen(&primitive, &map);
        let size = within.diagonal();
        let points = boundary_points(&solid, (&own, &map), 5000, &mut draw);
        let shells = shells(&primitive, &map, &within, 0.02 * size, 1 << 16);
        assert!(
            shells.chord_error <= 0.021 * size,
            "{shape}: {}",
            shells.chord_error / size
        );
        // Corners of the shells are near the surface, as far as the sampling tells.
        let sampling = 0.1 * size;
        // The formula of a composite is not decided where its pieces touch inside of it.
        let is_composite = matches!(&primitive, Primitive::Composite(c) if c.flat().is_none());
        if primitive.bounds().is_bounded() && !is_composite {
            for patch in shells.patches.iter().step_by(7) {
                for corner in patch.inner.iter().chain(&patch.outer) {
                    let near = points.iter().map(|p| p.distance_squared(*corner));
                    let near = libm::sqrt(near.fold(f64::INFINITY, f64::min));
                    assert!(near <= shells.chord_error + sampling, "{shape}: {corner}");
                }
            }
        }
    }
}

#[test]
fn small_things_get_few_patches() {
    let within = Aabb::new(DVec3::splat(-1e6), DVec3::splat(1e6));
    for (shape, solid) in primitives() {
        let (primitive, map) = placed(&solid);
        if !primitive.bounds().is_bounded() {
            continue;
        }
        let shells = shells(&primitive, &map, &within, 1e3, 1 << 20);
        assert!(
            shells.patches.len() <= 100,
            "{shape}: {}",
            shells.patches.len()
        );
    }
}

#[test]
fn odd_questions_have_answers() {
    let within = Aabb::new(DVec3::splat(-2.0), DVec3::splat(2.0));
    for (shape, solid) in primitives() {
        let (primitive, map) = placed(&solid);
        assert!(
            shells(&primitive, &map, &Aabb::EMPTY, 0.1, 100)
                .patches
                .is_empty()
        );
        for (error, limit) in [(0.0, 1000), (f64::INFINITY, 1000), (1e-3, 0), (1e-3, 1)] {
            let shells = shells(&primitive, &map, &within, error, limit);
            assert!(
                shells.patches.len() <= limit.max(100),
                "{shape} {error} {limit}"
            );
            assert!(
                shells.patches.iter().all(|p| p.bounds().is_bounded()),
                "{shape}"
            );
            assert!(cover(&primitive, &map, &within, error, limit).len() <= limit.max(100));
        }
    }
}
