//! Nested and touching dielectrics: every interface bends by the two media that meet there,
//! however the solids that hold them were drawn.

use octray_math::DVec3;
use octray_scene::{Background, Color, ColorStop, Light, Material, Object, Reflection};

use crate::refraction::ruler;
use crate::stage::*;

const GLASS: f64 = 1.5;
const WATER: f64 = 1.33;
const ICE: f64 = 1.31;

/// Bends and absorbs, but mirrors nothing unless it has to.
fn medium(ior: f64, absorption: f64) -> Material {
    let mut material = clear(ior);
    material.finish.reflection = Reflection::default();
    material.interior.absorption = DVec3::splat(absorption);
    material
}

/// One way to draw a scene: solids with material and priority.
type Drawing = Vec<(Solid, Material, i32)>;

fn draw(mut stage: Stage, drawing: &Drawing) -> Stage {
    for (solid, material, priority) in drawing {
        let material = stage.material(material.clone());
        stage.builder.add_object(Object {
            priority: *priority,
            ..Object::solid("layer", solid.clone(), material)
        });
    }
    stage
}

fn without(a: Solid, b: Solid) -> Solid {
    Solid::difference([a, b])
}

/// The radii of the concentric layers, and the index inside of each.
const RADII: [f64; 3] = [1.0, 0.9, 0.5];
const INDICES: [f64; 4] = [1.0, GLASS, WATER, 1.0];

/// A shell of glass, water in it, and in its middle a bubble, drawn in five ways.
fn bubbles(absorption: [f64; 3]) -> Vec<Drawing> {
    let ball = |radius: f64| ball(DVec3::ZERO, radius);
    let glass = medium(GLASS, absorption[0]);
    let water = medium(WATER, absorption[1]);
    let air = medium(1.0, absorption[2]);
    let [outer, inner, bubble] = RADII.map(ball);
    let shell = without(outer.clone(), inner.clone());
    let filling = without(inner.clone(), bubble.clone());
    vec![
        // One in the other, the smaller one counts.
        vec![
            (outer.clone(), glass.clone(), 0),
            (inner.clone(), water.clone(), 0),
            (bubble.clone(), air.clone(), 0),
        ],
        // Side by side, touching.
        vec![
            (bubble.clone(), air.clone(), 0),
            (shell.clone(), glass.clone(), 0),
            (filling.clone(), water.clone(), 0),
        ],
        // The water reaches into the glass, which has priority, and around the bubble.
        vec![
            (ball(0.95), water.clone(), 0),
            (shell, glass.clone(), 1),
            (bubble.clone(), air.clone(), 2),
        ],
        // All of them full, by priority alone, larger ones last.
        vec![
            (bubble.clone(), air.clone(), 3),
            (inner, water.clone(), 2),
            (outer.clone(), glass.clone(), 1),
        ],
        // Glass around everything that is not, the bubble in two halves.
        vec![
            (without(outer, filling.clone()), glass, 0),
            (filling, water, 0),
            (
                Solid::intersection([bubble.clone(), ground(0.1)]),
                air.clone(),
                1,
            ),
            (Solid::intersection([bubble, ceiling(0.1)]), air, 1),
        ],
    ]
}

/// The turn towards the centre of a ray that passes concentric balls at the distance `b`: at each
/// of them `n r sin(angle)` stays `b`.
fn turned(b: f64) -> f64 {
    let mut turn = 0.0;
    for (layer, radius) in RADII.into_iter().enumerate() {
        let [outside, inside] = [0, 1].map(|side| b / (INDICES[layer + side] * radius));
        if outside >= 1.0 {
            // It does not come so near.
            break;
        }
        if inside >= 1.0 {
            // Totally reflected.
            return turn - (std::f64::consts::PI - 2.0 * outside.asin());
        }
        turn += 2.0 * (outside.asin() - inside.asin());
    }
    turn
}

/// A background whose value is `(1 + direction along y) / 2`.
fn directions() -> Background {
    let stop = |position, v| ColorStop {
        position,
        color: Color::rgb(v, v, v),
    };
    Background::Gradient {
        axis: DVec3::Y,
        map: vec![stop(0.0, 0.0), stop(1.0, 1.0)],
    }
}

fn distances() -> impl Iterator<Item = f64> {
    // Through the bubble, reflected by it, past it, through the glass alone; 0 meets it head on.
    (0..40).map(|i| f64::from(i) * 0.0249)
}

#[test]
fn a_bubble_in_water_in_glass_turns_rays_as_snell_says() {
    for (index, drawing) in bubbles([0.0; 3]).iter().enumerate() {
        for b in distances() {
            let mut stage = draw(Stage::new(), drawing);
            stage.builder.set_background(directions());
            let world = stage
                .parallel(DVec3::new(-5.0, b, 0.0), DVec3::X, 1e-10)
                .world();
            let along_y = 2.0 * reds(&shoot(&world, &small()))[0] - 1.0;
            let expected = -turned(b).sin();
            assert!(
                (along_y - expected).abs() < 1e-6,
                "drawing {index}, {b}: {along_y} {expected}"
            );
        }
    }
}

#[test]
fn layers_absorb_by_the_ways_in_them() {
    let absorption = [0.9, 0.4, 1.7];
    for (index, drawing) in bubbles(absorption).iter().enumerate() {
        for b in distances() {
            let world = draw(Stage::new(), drawing)
                .background(1.0)
                .parallel(DVec3::new(-5.0, b, 0.0), DVec3::X, 1e-10)
                .world();
            let got = reds(&shoot(&world, &small()))[0];
            // In a layer the line runs b / n from the centre.
            let mut depth = 0.0;
            for layer in 0..3 {
                let p = b / INDICES[layer + 1];
                let half = |r: f64| (r * r - p * p).max(0.0).sqrt();
                let inner = RADII.get(layer + 1).map_or(0.0, |r| half(*r));
                depth += absorption[layer] * 2.0 * (half(RADII[layer]) - inner);
                if RADII
                    .get(layer + 1)
                    .is_some_and(|r| b / INDICES[layer + 2] >= *r)
                {
                    break;
                }
            }
            let expected = f64::exp(-depth);
            assert!(
                (got - expected).abs() < 1e-6,
                "drawing {index}, {b}: {got} {expected}"
            );
        }
    }
}

#[test]
fn slabs_that_touch_shift_what_lies_behind_them() {
    // From below: glass, water, ice, each on the other; and the same overlapping.
    let [glass, water, ice] = [GLASS, WATER, ICE].map(|ior| medium(ior, 0.0));
    let drawings: [Drawing; 2] = [
        vec![
            (slab(1.0, 1.5), glass.clone(), 0),
            (slab(1.5, 2.25), water.clone(), 0),
            (slab(2.25, 3.0), ice.clone(), 0),
        ],
        vec![
            (slab(1.2, 2.5), water, 0),
            (slab(1.0, 1.5), glass, 1),
            (slab(2.25, 3.0), ice, 2),
        ],
    ];
    for drawing in &drawings {
        for degrees in [0.0_f64, 25.0, 60.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let world = draw(Stage::new().solid(ground(0.0), ruler()), drawing)
                .parallel(DVec3::new(0.0, 0.0, 4.0), DVec3::new(sin, 0.0, -cos), 1e-9)
                .world();
            let got = reds(&shoot(&world, &small()))[0] * 100.0 - 50.0;
            let along = |ior: f64, height: f64| {
                let sin_t = sin / ior;
                height * sin_t / (1.0 - sin_t * sin_t).sqrt()
            };
            let expected =
                along(1.0, 2.0) + along(GLASS, 0.5) + along(WATER, 0.75) + along(ICE, 0.75);
            assert!((got - expected).abs() < 3e-5, "{degrees}: {got} {expected}");
        }
    }
}

/// A glass with water, a bubble and an ice cube whose lower half is in the water.
fn tumbler(overlap: f64) -> Stage {
    let cylinder =
        |radius: f64, from: f64, to: f64| Solid::cylinder(radius, from, to).expect("a cylinder");
    let glass = without(cylinder(1.0, 0.0, 2.5), cylinder(0.9, 0.15, 2.5));
    let water = cylinder(0.9 + overlap, 0.15 - overlap, 1.9);
    let cube = Solid::cuboid(DVec3::new(-0.4, -0.5, 1.5), DVec3::new(0.4, 0.3, 2.2));
    let mut murky = Material::glass("water", WATER);
    murky.interior.absorption = DVec3::splat(0.1);
    let drawing = vec![
        (water, murky, 0),
        (glass, Material::glass("glass", GLASS), 3),
        (cube.expect("a box"), Material::glass("ice", ICE), 2),
        (
            ball(DVec3::new(0.2, -0.3, 0.8), 0.25),
            Material::glass("air", 1.0),
            1,
        ),
    ];
    let light = Light::point(DVec3::new(3.0, -5.0, 9.0), DVec3::ONE);
    let stage = Stage::new().solid(ground(0.0), ruler()).light(light);
    draw(stage, &drawing)
        .background(0.5)
        .pinhole(DVec3::new(1.0, -5.0, 3.0), DVec3::new(-0.2, 1.0, -0.4))
}

#[test]
fn water_that_touches_its_glass_looks_like_water_that_overlaps_it() {
    let mut config = small();
    config.size = Some((96, 96));
    config.contribution_threshold = Some(1e-4);
    let touching = reds(&shoot(&tumbler(0.0).world(), &config));
    let overlapping = reds(&shoot(&tumbler(0.03).world(), &config));
    let pairs = touching.iter().zip(&overlapping);
    let differ = pairs.filter(|(a, b)| (*a - *b).abs() > 1.0 / 255.0).count();
    // One in a thousand, where rays graze an edge.
    assert!(differ <= 9, "{differ} of {}", touching.len());
    let spread = touching.iter().copied().fold(0.0, f64::max);
    assert!(spread > 0.5, "something is seen");
}
