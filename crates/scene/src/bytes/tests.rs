use std::sync::Arc;

use octray_geometry::profile::{Edge, Outline, Region, Turning};
use octray_geometry::{MaterialId, MeshRule, Polynomial, Sheet, Solid, TriangleMesh};
use octray_math::{DAffine3, DVec2, DVec3, hash_combine};
use proptest::prelude::*;

use super::*;
use crate::*;

fn tetrahedron() -> Arc<TriangleMesh> {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = TriangleMesh::new(positions, triangles).expect("valid");
    let normals = octray_geometry::CornerAttribute {
        values: vec![DVec3::Z],
        triangles: vec![[0; 3]; 4],
    };
    let uv = octray_geometry::CornerAttribute {
        values: vec![DVec2::X, DVec2::Y],
        triangles: vec![[0, 1, 0]; 4],
    };
    let mesh = mesh.with_normals(normals).expect("in range");
    let mesh = mesh.with_texcoords(uv).expect("in range");
    let ids = [0, 1, 1, 0].map(MaterialId).to_vec();
    Arc::new(mesh.with_materials(ids).expect("one each"))
}

/// An outline of every kind of edge.
fn region() -> Region {
    let mut outline = Outline::starting_at(DVec2::new(1.0, 0.0));
    outline.push(Edge::Line, DVec2::new(3.0, 0.0));
    outline.push(Edge::Quadratic(DVec2::new(4.0, 0.5)), DVec2::new(3.0, 1.0));
    let cubic = Edge::Cubic(DVec2::new(3.5, 2.0), DVec2::new(2.0, 1.0));
    outline.push(cubic, DVec2::new(2.0, 2.0));
    let center = DVec2::new(1.5, 2.0);
    let clockwise = false;
    outline.push(Edge::Arc { center, clockwise }, DVec2::new(1.0, 2.0));
    let hole = Outline::circle(DVec2::new(2.0, 0.7), 0.3);
    Region::new(&[outline, hole]).expect("closed")
}

/// A block with a notch.
fn concave() -> Solid {
    let outline = [(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)];
    let mut vertices = Vec::new();
    for z in [0.0, 1.0] {
        vertices.extend(outline.map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), z)));
    }
    let mut faces = vec![vec![4, 3, 2, 1, 0], vec![5, 6, 7, 8, 9]];
    faces.extend((0..5).map(|i| vec![i, (i + 1) % 5, (i + 1) % 5 + 5, i + 5]));
    Solid::exact_polyhedron(&vertices, &faces).expect("closed")
}

fn solids() -> Vec<Solid> {
    let polynomial = |degree, change: &[(usize, f64)]| {
        let count = (degree + 1) * (degree + 2) * (degree + 3) / 6;
        let mut all = vec![0.0; count];
        change.iter().for_each(|&(i, c)| all[i] = c);
        Solid::polynomial(Polynomial::new(degree, &all).expect("enough")).expect("valid")
    };
    let turning = Turning {
        start: 10.0,
        sweep: 200.0,
        steps: None,
    };
    let corners = [(1, 0), (2, 0), (2, 1)].map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)));
    let polygon = Region::polygon(&corners).expect("an area");
    let steps = Turning {
        steps: Some(7),
        ..Turning::ROUND
    };
    let cube = Solid::cuboid(DVec3::ZERO, DVec3::ONE).expect("valid");
    let moved = cube.translate(DVec3::new(0.5, -0.0, 0.25)).expect("finite");
    let cut = Solid::difference([cube.clone(), moved.clone()]).with_material(MaterialId(1));
    vec![
        Solid::empty(),
        Solid::sphere(1.5).expect("valid"),
        Solid::cylinder(1.0, -1.0, 2.0).expect("valid"),
        Solid::infinite_cylinder(0.1).expect("valid"),
        Solid::cone(1.0, 0.5, -1.0, 2.0).expect("valid"),
        Solid::torus(2.0, 0.3).expect("valid"),
        Solid::half_space(DVec3::new(0.3, -0.4, 0.7), 0.1).expect("valid"),
        Solid::quadric([1.0, 2.0, -3.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, -0.7]).expect("valid"),
        Solid::quadric([1.0, 1e-9, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0]).expect("valid"),
        polynomial(4, &[(0, 1.0), (20, 1.0), (34, -1.0)]),
        polynomial(3, &[(0, 1.0), (19, -1.0)]),
        Solid::superellipsoid(0.3, 1.7).expect("valid"),
        Solid::prism(&region(), -1.0, 1.0).expect("valid"),
        Solid::tapered_prism(&polygon, [0.0, 1.0], [1.0, 0.5]).expect("valid"),
        Solid::turned_lathe(&region(), turning).expect("valid"),
        Solid::turned_lathe(&polygon, steps).expect("valid"),
        concave(),
        Solid::polyhedron(
            &[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            &[vec![0, 2, 1], vec![0, 1, 3], vec![0, 3, 2], vec![1, 2, 3]],
        )
        .expect("closed"),
        Solid::mesh(tetrahedron(), MeshRule::Strict).expect("closed"),
        Solid::union([cut.clone(), moved.complement()]),
        Solid::intersection([cut, cube]),
    ]
}

fn scene() -> Scene {
    let mut builder = SceneBuilder::new();
    let checker = Pigment::Pattern {
        pattern: Pattern::Checker(Box::new([
            Pigment::Uniform(Color::rgb(1.0, 0.5, 0.25)),
            Pigment::Pattern {
                pattern: Pattern::Gradient {
                    axis: DVec3::X,
                    map: vec![
                        ColorStop {
                            position: 0.0,
                            color: Color::rgb(0.0, 0.1, 0.2),
                        };
                        2
                    ],
                },
                pattern_from_world: DAffine3::IDENTITY,
            },
        ])),
        pattern_from_world: DAffine3::from_scale(DVec3::splat(2.0)),
    };
    let mut glass = Material::glass("glass", 1.5);
    glass.interior.fade = Some(Fade {
        half_distance: 2.0,
        power: 3.0,
        color: DVec3::ONE,
    });
    builder.add_material(Material {
        pigment: checker.clone(),
        ..Material::default()
    });
    let glass = builder.add_material(glass);
    for (number, solid) in solids().into_iter().enumerate() {
        let mut object = Object::solid(format!("solid {}", number % 9), solid, glass);
        object.priority = number as i32 - 5;
        object.casts_shadows = number % 2 == 0;
        builder.add_object(object);
    }
    let disc = Sheet::disc(DVec3::ONE, DVec3::Z, 2.0, 0.5).expect("valid");
    let mesh = Sheet::mesh(tetrahedron());
    let parts = [Shape::Sheet(mesh.clone()), Shape::Solid(concave())];
    let prototype = Arc::new(Prototype::new(parts).expect("bounded"));
    builder.add_object(Object::sheet("disc", disc, glass));
    builder.add_object(Object::sheet("mesh", mesh, glass));
    for x in [3.0, 5.0] {
        let placed = vec![DAffine3::from_translation(DVec3::X * x); 3];
        let copies = Instances::new(Arc::clone(&prototype), placed).expect("invertible");
        builder.add_object(Object::instances("copies", copies, glass));
    }
    builder.add_light(Light::point(DVec3::ONE, DVec3::X));
    builder.add_light(Light::directional(DVec3::NEG_Z, DVec3::Y));
    builder.add_light(Light {
        falloff: Falloff::Fade {
            distance: 3.0,
            power: 2.0,
        },
        makes_highlights: false,
        ..Light::new(
            LightKind::Spot {
                position: DVec3::Z,
                direction: DVec3::NEG_Z,
                inner: 0.1,
                outer: 0.2,
                tightness: 1.0,
            },
            DVec3::ONE,
        )
    });
    let camera = Camera::look_at(DVec3::NEG_Y * 9.0, DVec3::ZERO, DVec3::Z, 0.7);
    builder.set_camera(camera.expect("eye and target differ"));
    builder.set_background(Background::Sky {
        base: DVec3::Z,
        layers: vec![checker],
    });
    let settings = builder.settings_mut();
    settings.encoding = Encoding::Gamma(2.2);
    settings.view = View::Standard;
    settings.size = Some((320, 200));
    settings.units = "mm".to_owned();
    builder.build().expect("valid")
}

/// With the right hash, so that the rest is looked at.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.len() >= BODY_AT {
        let hash = ContentHash::of(&bytes[BODY_AT..]).to_bytes();
        bytes[HASH_AT..BODY_AT].copy_from_slice(&hash);
    }
    bytes
}

#[test]
fn everything_comes_back() {
    let scene = scene();
    let bytes = scene.to_bytes();
    let read = Scene::from_bytes(&bytes).expect("a scene");
    // What `Debug` shows is everything, numbers with all their digits.
    let text = |scene: &Scene| format!("{scene:?}");
    assert_eq!(text(&read), text(&scene));
    assert_eq!(read.to_bytes(), bytes, "and sharing is kept");
    let hash = Scene::hash_of_bytes(&bytes).expect("a scene");
    let damaged = [&bytes[..bytes.len() - 1], &[!bytes[bytes.len() - 1]]].concat();
    assert_eq!(
        Scene::from_bytes(&damaged).err(),
        Some(SceneBytesError::Damaged)
    );
    assert_ne!(Scene::hash_of_bytes(&sealed(damaged)), Ok(hash));
}

#[test]
fn what_is_shared_stays_shared() {
    let mut wide = Solid::sphere(1.0).expect("valid");
    for _ in 0..20 {
        let moved = wide.translate(DVec3::X).expect("finite");
        wide = Solid::intersection([wide.complement(), moved]);
    }
    let mut builder = SceneBuilder::new();
    let material = builder.add_material(Material::default());
    builder.add_object(Object::solid("wide", wide, material));
    let scene = builder.build().expect("a million operands");
    let bytes = scene.to_bytes();
    assert!(bytes.len() < 10_000, "{}", bytes.len());
    let read = Scene::from_bytes(&bytes).expect("a scene");
    assert_eq!(read.to_bytes(), bytes);
}

#[test]
fn other_files_and_versions_are_named() {
    let bytes = Scene::to_bytes(&SceneBuilder::new().build().expect("empty"));
    assert!(Scene::from_bytes(&bytes).is_ok());
    let error = |bytes: &[u8]| Scene::from_bytes(bytes).expect_err("none").to_string();
    assert_eq!(error(b""), "these bytes are not a scene of octray");
    assert_eq!(error(b"\x89PNG"), "these bytes are not a scene of octray");
    let mut newer = bytes.clone();
    newer[8] = 77;
    assert_eq!(
        error(&newer),
        "the scene has version 77 of the format; this octray reads version 1"
    );
    assert!(error(&sealed([&bytes[..], &[0; 8]].concat())).contains("behind the end"));
}

/// An exponential tree over nothing has no operands that would be counted.
#[test]
fn small_bytes_of_endless_work_are_refused() {
    let mut wide = Solid::empty();
    for _ in 0..40 {
        wide = Solid::intersection([wide.complement(), wide.complement()]);
    }
    let mut builder = SceneBuilder::new();
    builder.add_material(Material::default());
    // Not built: that would walk the tree.
    builder.add_object(Object::solid("wide", wide, MaterialId(0)));
    let error = Scene::from_bytes(&builder.so_far().to_bytes()).expect_err("too much");
    assert!(error.to_string().contains("too large"), "{error}");
}

#[test]
fn every_length_short_of_the_whole_is_an_error() {
    let bytes = scene().to_bytes();
    for length in 0..bytes.len() {
        assert!(Scene::from_bytes(&sealed(bytes[..length].to_vec())).is_err());
    }
}

#[test]
fn changed_bytes_are_a_scene_or_an_error() {
    let cases = std::env::var("OCTRAY_CASES")
        .ok()
        .and_then(|n| n.parse().ok());
    let bytes = scene().to_bytes();
    let mut valid = 0;
    for case in 0..3000 * cases.unwrap_or(1_u64) {
        let random = |branch: u64| hash_combine(case, branch);
        let mut changed = bytes.clone();
        for change in 0..=random(1) % 3 {
            let at = BODY_AT + (random(10 + change) as usize) % (bytes.len() - BODY_AT);
            changed[at] = match random(20 + change) % 4 {
                0 => 0,
                1 => 0xff,
                2 => changed[at] ^ 1 << (random(30 + change) % 8),
                _ => random(40 + change) as u8,
            };
        }
        if let Ok(read) = Scene::from_bytes(&sealed(changed)) {
            valid += 1;
            assert!(read.to_bytes().len() > BODY_AT);
        }
    }
    // Most bytes are parts of numbers, so many changes give another scene.
    assert!(valid > 100, "{valid}");
}

proptest! {
    #[test]
    fn any_bytes_are_an_error(tail in proptest::collection::vec(any::<u8>(), 0..300)) {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]);
        bytes.extend([0; 16]);
        bytes.extend(tail);
        prop_assert!(Scene::from_bytes(&sealed(bytes)).is_err());
    }
}
