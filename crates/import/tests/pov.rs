//! The language of POV-Ray scenes: values, scopes, objects, and what is said about mistakes.

use std::path::Path;

use octray_geometry::Solid;
use octray_import::{Imported, InMemory, Options, Severity, pov};
use octray_math::{Aabb, DVec3};
use octray_scene::{
    Background, Encoding, Falloff, LightKind, Object, Pattern, Pigment, Projection, Scene, Shape,
};

fn import(text: &str) -> Imported {
    import_with(text, &InMemory::default(), &Options::default())
}

fn import_with(text: &str, files: &InMemory, options: &Options) -> Imported {
    pov::import(Path::new("s.pov"), text.as_bytes().to_vec(), files, options)
}

fn messages(imported: &Imported, severity: Severity) -> Vec<String> {
    let all = imported.diagnostics.iter();
    all.filter(|d| d.severity == severity)
        .map(|d| imported.diagnostics.render(d))
        .map(|text| text.lines().next().unwrap_or_default().to_owned())
        .collect()
}

/// The scene of a text that nothing is wrong with.
fn scene(text: &str) -> Scene {
    let imported = import(text);
    assert_eq!(
        imported.diagnostics.iter().count(),
        0,
        "{:?}",
        imported.diagnostics
    );
    imported.scene.expect("a scene")
}

/// The value of an expression, read back from where a sphere is.
fn value(declarations: &str, expression: &str) -> f64 {
    let text = format!("{declarations}\nsphere {{ <{expression}, 0, 0>, 1 }}");
    let bounds = scene(&text).bounds();
    0.5 * (bounds.min.x + bounds.max.x)
}

fn bounds(text: &str) -> Aabb {
    scene(text).bounds()
}

fn assert_close(a: Aabb, min: [f64; 3], max: [f64; 3]) {
    let error = (a.min - DVec3::from(min))
        .abs()
        .max((a.max - DVec3::from(max)).abs());
    assert!(error.max_element() < 1e-9, "{a:?}");
}

/// The only error: its place and text.
fn error(text: &str) -> String {
    let imported = import(text);
    assert!(imported.scene.is_none(), "{text}");
    let errors = messages(&imported, Severity::Error);
    assert_eq!(errors.len(), 1, "{errors:?}");
    errors[0].clone()
}

#[test]
fn expressions_have_the_values_of_arithmetic() {
    for (expression, expected) in [
        ("1 + 2*3 - 4/2", 5.0),
        ("-(2 + 3)*2", -10.0),
        ("(1 < 2)", 1.0),
        ("(2 <= 1 | 3 != 3)", 0.0),
        ("(!0 & 1 ? 7 : 8)", 7.0),
        ("vlength(<3, 4, 0>)", 5.0),
        ("vdot(<1, 2, 3>, <4, 5, 6>)", 32.0),
        ("vcross(x, y).z", 1.0),
        ("(2*<1, 2, 3> + 1).y", 5.0),
        ("vrotate(x, 90*z).y", 1.0),
        ("vaxis_rotate(y, x, 90).z", 1.0),
        ("mod(-7, 3)", -1.0),
        ("int(-2.7)", -2.0),
        ("max(1, 5, 3) - min(4, 2)", 3.0),
        ("pow(2, 10)", 1024.0),
        ("degrees(atan2(1, 1))", 45.0),
        ("select(-1, 10, 20, 30)", 10.0),
        ("strlen(concat(\"ab\", str(12.345, 0, 2)))", 7.0),
        ("val(\"2.5\") + asc(\"A\")", 67.5),
        ("(rgb <0.1, 0.2, 0.3>).green", 0.2),
    ] {
        let found = value("", expression);
        assert!((found - expected).abs() < 1e-9, "{expression}: {found}");
    }
}

#[test]
fn random_numbers_are_those_of_pov_ray() {
    // POV-Ray 3.7 prints these for `#declare S = seed(123)`.
    let declarations = "#declare S = seed(123); #declare A = rand(S); #declare B = rand(S);";
    assert!((value(declarations, "A") - RANDOM[0]).abs() < 1e-9);
    assert!((value(declarations, "B") - RANDOM[1]).abs() < 1e-9);
}

const RANDOM: [f64; 2] = [0.904_772_982_212, 0.995_137_868_914];

#[test]
fn loops_branches_and_macros_run() {
    for (program, expected) in [
        (
            "#declare N = 0; #while (N < 5) #declare N = N + 1; #end",
            5.0,
        ),
        (
            "#declare N = 0; #for (I, 1, 4) #declare N = N + I; #end",
            10.0,
        ),
        (
            "#declare N = 0; #for (I, 4, 1, -2) #declare N = N + I; #end",
            6.0,
        ),
        (
            "#declare N = 0; #while (1) #if (N > 6) #break #end #declare N = N + 1 #end",
            7.0,
        ),
        (
            "#if (0) #declare N = 1; #elseif (1) #declare N = 2; #else #declare N = 3; #end",
            2.0,
        ),
        (
            "#switch (3) #case (1) #declare N = 1; #break #range (2, 4) #declare N = 2; #break #else #declare N = 3; #end",
            2.0,
        ),
        (
            "#ifdef (N) #declare N = 1; #else #ifndef (M) #declare N = 4; #end #end",
            4.0,
        ),
        (
            "#macro F(A, B) (A*A + B) #end #declare N = F(3, F(1, 1));",
            11.0,
        ),
        (
            "#macro F(A) #if (A <= 1) 1 #else (A*F(A - 1)) #end #end #declare N = F(5);",
            120.0,
        ),
        (
            "#macro Set(A) #declare A = 9; #end #declare N = 1; Set(N)",
            9.0,
        ),
        ("#declare N = 1; #macro F() #local N = 2; #end F()", 1.0),
        (
            "#declare F = function(a, b) { a^2 + b }; #declare N = F(3, 1);",
            10.0,
        ),
        (
            "#declare A = array[2][2] { {1, 2}, {3, 4} } #declare A[1][0] = 8; #declare N = A[1][0] + A[0][1];",
            10.0,
        ),
        (
            "#declare A = array[2] { 1, 2 } #if (A[1] = 2) #declare N = 6; #end",
            6.0,
        ),
        ("#declare N = #if (1) 5 #else 6 #end;", 5.0),
        (
            "#declare A = array[3] {1, 2, 3} #declare N = dimension_size(A, 1);",
            3.0,
        ),
    ] {
        assert_eq!(value(program, "N"), expected, "{program}");
    }
}

#[test]
fn transforms_come_in_their_order() {
    assert_close(
        bounds("box { 0, <1, 2, 3> translate 10*x rotate 90*z scale <1, 2, 1> }"),
        [-2.0, 20.0, 0.0],
        [0.0, 22.0, 3.0],
    );
    assert_close(
        bounds("box { 0, 1 matrix <0, 1, 0, -2, 0, 0, 0, 0, 1, 5, 6, 7> }"),
        [3.0, 6.0, 7.0],
        [5.0, 7.0, 8.0],
    );
    let declared = "#declare T = transform { rotate 90*y translate x }
        box { 0, <1, 2, 3> transform T transform { T inverse } }";
    assert_close(bounds(declared), [0.0; 3], [1.0, 2.0, 3.0]);
    let object = "#declare A = sphere { 0, 1 translate x } object { A rotate 90*z scale 2 }";
    assert_close(bounds(object), [-2.0, 0.0, -2.0], [2.0, 4.0, 2.0]);
}

#[test]
fn shapes_are_where_their_numbers_say() {
    assert_close(
        bounds("cylinder { <0, 0, 1>, <0, 0, 4>, 2 }"),
        [-2.0, -2.0, 1.0],
        [2.0, 2.0, 4.0],
    );
    assert_close(
        bounds("cone { 0, 1, 3*y, 0 }"),
        [-1.0, 0.0, -1.0],
        [1.0, 3.0, 1.0],
    );
    assert_close(
        bounds("torus { 3, 1 }"),
        [-4.0, -1.0, -4.0],
        [4.0, 1.0, 4.0],
    );
    let open = bounds("cone { 0, 1, 3*y, 0 open }");
    assert!(open.contains(DVec3::X) && open.max.y <= 3.1, "{open:?}");
    assert_close(
        bounds("prism { 1, 3, 5, <0, 0>, <2, 0>, <2, 2>, <0, 2>, <0, 0> }"),
        [0.0, 1.0, 0.0],
        [2.0, 3.0, 2.0],
    );
    assert_close(
        bounds("lathe { linear_spline 5, <1, 0>, <2, 0>, <2, 3>, <1, 3>, <1, 0> }"),
        [-2.0, 0.0, -2.0],
        [2.0, 3.0, 2.0],
    );
    assert_close(
        bounds("quadric { <1, 4, 1>, 0, <0, 0, -4>, 0 }"),
        [-2.0, -1.0, 0.0],
        [2.0, 1.0, 4.0],
    );
    assert_close(
        bounds("mesh2 { vertex_vectors { 3, 0, x, <0, 1, 2> } face_indices { 1, <0, 1, 2> } }"),
        [0.0; 3],
        [1.0, 1.0, 2.0],
    );
}

#[test]
fn a_plane_is_solid_behind_its_normal() {
    let made = scene("intersection { box { -1, 1 } plane { -y, -0.5 } }");
    let Shape::Solid(solid) = &made.objects()[0].shape else {
        panic!("{made:?}");
    };
    assert_eq!(solid.bounds().max, DVec3::ONE);
    let plane = scene("plane { 2*y, 3 }");
    assert!(!plane.objects()[0].shape.bounds().is_bounded());
}

fn material_of<'s>(scene: &'s Scene, object: &Object) -> &'s octray_scene::Material {
    scene.material(object.material)
}

#[test]
fn textures_are_inherited_and_move_with_their_object() {
    let made = scene(
        "#include \"colors.inc\"
         #default { finish { ambient 0.3 } }
         union {
           sphere { 0, 1 pigment { checker Red, Blue } translate 0.5*x }
           sphere { 3*x, 1 }
           pigment { Green } finish { phong 0.5 }
           translate 10*x
         }",
    );
    let [a, b] = made.objects() else {
        panic!("{made:?}");
    };
    let color = |object: &Object, x: f64| {
        let material = material_of(&made, object);
        material.pigment.at(DVec3::new(x, 0.5, 0.5)).rgb
    };
    // The checkers' faces lie at 10.5, 11.5, ...
    assert_eq!(color(a, 10.6), DVec3::X);
    assert_eq!(color(a, 10.4), DVec3::Z);
    assert_eq!(color(b, 13.0), DVec3::Y);
    let finish = material_of(&made, b).finish;
    assert_eq!((finish.phong, finish.ambient), (0.5, DVec3::splat(0.3)));
    assert_eq!(material_of(&made, a).finish.phong, 0.0);
}

#[test]
fn a_second_texture_lies_over_the_first() {
    let text = "#declare A = sphere { 0, 1 pigment { rgb x } }
        object { A texture { pigment { rgbt <0, 1, 0, 0.5> } } }
        object { A texture { pigment { rgb y } } }
        object { A pigment { rgb z } }";
    let imported = import(text);
    let warnings = messages(&imported, Severity::Warning);
    assert!(
        warnings.iter().all(|w| w.contains("layered")),
        "{warnings:?}"
    );
    let made = imported.scene.expect("a scene");
    let colors: Vec<DVec3> = made
        .objects()
        .iter()
        .map(|object| material_of(&made, object).pigment.at(DVec3::ZERO).rgb)
        .collect();
    // A veil is not shown, only what hides all below it; a pigment replaces a pigment.
    assert_eq!(colors, [DVec3::X, DVec3::Y, DVec3::Z]);
}

#[test]
fn pigments_and_finishes_say_all_they_can() {
    let made = scene(
        "box { 0, 1
           texture {
             pigment { gradient y color_map { [0 rgb 0] [0.25 0.5 color red 1 color rgbt <0, 1, 0, 0.5>] } scale 2 }
             finish {
               ambient rgb <0.1, 0.2, 0.3> diffuse 0.7 brilliance 2 phong 0.8 phong_size 60
               specular 0.4 roughness 0.01 metallic
               reflection { 0.1, 0.9 fresnel on metallic 0.5 } conserve_energy emission 0.25
             }
           }
           interior { ior 1.5 fade_distance 2 fade_power 1 }
           no_shadow
         }",
    );
    assert!(!made.objects()[0].casts_shadows);
    let material = material_of(&made, &made.objects()[0]);
    let at = |y: f64| material.pigment.at(DVec3::new(0.3, y, 0.3));
    assert_eq!(at(0.25).rgb, DVec3::new(0.5, 0.0, 0.0));
    assert_eq!((at(1.5).rgb, at(1.5).transmit), (DVec3::Y, 0.5));
    let f = material.finish;
    assert_eq!(f.ambient, DVec3::new(0.1, 0.2, 0.3));
    assert_eq!(
        (f.diffuse, f.brilliance, f.phong, f.phong_size),
        (0.7, 2.0, 0.8, 60.0)
    );
    assert_eq!((f.specular, f.roughness, f.metallic), (0.4, 0.01, 1.0));
    assert_eq!((f.reflection.min.x, f.reflection.max.x), (0.1, 0.9));
    assert!(f.reflection.fresnel && f.conserve_energy);
    assert_eq!((f.reflection.metallic, f.emission.y), (0.5, 0.25));
    assert_eq!(material.interior.ior, 1.5);
    assert_eq!(
        material.interior.fade.map(|f| f.transmission(2.0).x),
        Some(0.5)
    );
}

#[test]
fn lights_know_their_kind() {
    let made = scene(
        "light_source { x, rgb 2 translate y fade_distance 3 fade_power 2 }
         light_source { 10*y, rgb 1 spotlight point_at 0 radius 10 falloff 20 tightness 3 }
         light_source { <0, 5, 0>, rgb 1 parallel point_at <0, 0, 5> shadowless }",
    );
    let [point, spot, sun] = made.lights() else {
        panic!("{made:?}");
    };
    let position = DVec3::new(1.0, 1.0, 0.0);
    assert_eq!(point.kind, LightKind::Point { position });
    assert_eq!(
        (point.color, point.falloff),
        (
            DVec3::splat(2.0),
            Falloff::Fade {
                distance: 3.0,
                power: 2.0
            }
        )
    );
    let LightKind::Spot {
        direction,
        inner,
        outer,
        tightness,
        ..
    } = spot.kind
    else {
        panic!("{spot:?}");
    };
    assert_eq!((direction, tightness), (DVec3::NEG_Y, 3.0));
    assert!((inner.to_degrees() - 10.0).abs() < 1e-12 && (outer.to_degrees() - 20.0).abs() < 1e-12);
    let direction = DVec3::new(0.0, -1.0, 1.0).normalize();
    assert_eq!(sun.kind, LightKind::Directional { direction });
    assert!(!sun.casts_shadows && !sun.makes_highlights);
}

#[test]
fn the_camera_is_left_handed_as_written() {
    let default = scene("camera { }");
    let camera = default.camera().expect("a camera");
    assert_eq!((camera.forward, camera.up), (DVec3::Z, DVec3::Y));
    assert_eq!(camera.right, DVec3::new(1.33, 0.0, 0.0));
    assert!(!camera.fit_aspect);
    let aimed =
        scene("camera { location <0, 0, 5> look_at 0 angle 90 right x*image_width/image_height }");
    let camera = aimed.camera().expect("a camera");
    // 90 degrees from left to right: the width is twice the distance of the picture.
    assert!(
        (camera.forward.length() - 2.0 / 3.0).abs() < 1e-12,
        "{camera:?}"
    );
    assert!(
        (camera.right - DVec3::new(-1.0, 0.0, 0.0)).length() < 1e-12,
        "{camera:?}"
    );
    assert!(camera.fit_aspect);
    let flat = scene("camera { orthographic location -3*z right 4*x up 3*y }");
    assert_eq!(
        flat.camera().map(|c| c.projection),
        Some(Projection::Orthographic)
    );
}

#[test]
fn settings_follow_the_version() {
    let encoding = |text: &str| scene(text).settings().encoding;
    assert_eq!(encoding("sphere { 0, 1 }"), Encoding::Srgb);
    assert_eq!(encoding("#version 3.7; sphere { 0, 1 }"), Encoding::Linear);
    assert_eq!(
        encoding("global_settings { assumed_gamma 2.2 }"),
        Encoding::Gamma(2.2)
    );
    let made = scene(
        "global_settings { max_trace_level 7 adc_bailout 0.1 ambient_light rgb 0.5 }
         background { rgb <0.1, 0.2, 0.3> }",
    );
    let settings = made.settings();
    assert_eq!(
        (settings.max_generations, settings.contribution_threshold),
        (7, 0.1)
    );
    assert_eq!(settings.ambient_light, DVec3::splat(0.5));
    assert_eq!(
        *made.background(),
        Background::Uniform(DVec3::new(0.1, 0.2, 0.3))
    );
    let sky = scene(
        "sky_sphere { pigment { gradient y color_map { [0 rgb 0] [1 rgb 1] } scale 2 translate -1 } }",
    );
    assert!((sky.background().at(DVec3::X).x - 0.5).abs() < 1e-12);
}

#[test]
fn clipping_leaves_a_surface_and_csg_a_solid() {
    let made = scene(
        "sphere { 0, 1 clipped_by { plane { y, 0 } } translate 5*x }
         difference { box { -1, 1 } sphere { 0, 1.2 pigment { rgb x } } pigment { rgb y } }
         merge { sphere { 0, 1 } sphere { x, 1 } }",
    );
    let kinds: Vec<bool> = made
        .objects()
        .iter()
        .map(|o| matches!(o.shape, Shape::Solid(_)))
        .collect();
    assert_eq!(kinds, [false, true, true]);
    let clipped = made.objects()[0].shape.bounds();
    assert_eq!((clipped.min.x, clipped.max.x), (4.0, 6.0));
    let Pigment::Uniform(color) = &material_of(&made, &made.objects()[1]).pigment else {
        panic!("{made:?}");
    };
    assert_eq!(color.rgb, DVec3::Y);
}

#[test]
fn includes_are_found_beside_the_scene_first() {
    let mut files = InMemory::default();
    files.insert("colors.inc", "#declare Red = 4; #local Hidden = 1;");
    let text = "#include \"colors.inc\" #ifdef (Hidden) oops #end sphere { <Red, 0, 0>, 1 }";
    let made = import_with(text, &files, &Options::default());
    let scene = made.scene.expect("a scene");
    assert_eq!(scene.bounds().max.x, 5.0);
}

#[test]
fn mistakes_are_named_with_their_place_and_a_suggestion() {
    assert_eq!(
        error("sphere { 0, 1\n  pigment { Rde } }"),
        "s.pov:2:13: error: `Rde` is not declared"
    );
    let imported = import("#declare Steel = 1;\nsphere { 0, Stel }");
    let shown = imported
        .diagnostics
        .iter()
        .map(|d| imported.diagnostics.render(d));
    assert!(shown.last().is_some_and(|text| text.contains("`Steel`")));
    let both = import("sphere { 0 wrong }\nbox { 0, 1 }\ncone { 0, 1, nope, 2 }");
    let errors = messages(&both, Severity::Error);
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(errors[0].starts_with("s.pov:1:12:") && errors[1].starts_with("s.pov:3:14:"));
    assert!(error("#include \"nothere.inc\"").contains("nothere.inc"));
    assert!(error("union { sphere { 0, 1 }").contains("is not closed"));
    assert!(error("#if (1) sphere { 0, 1 }").contains("no `#end`"));
    assert!(error("#end").contains("closes nothing"));
    assert!(error("#macro A(B) #end A(1, 2)").contains("takes 1 arguments"));
    assert!(error("#declare A = 1/0;").contains("division by zero"));
    assert!(error("#error \"stop here\"").contains("stop here"));
    assert!(error("sphere { 0, \"a\" }").contains("expected a value"));
    assert!(error("/* never closed").contains("not closed"));
}

#[test]
fn what_is_not_supported_is_left_out_with_a_warning() {
    let made = import(
        "#include \"textures.inc\"
         sphere { 0, 1 texture { Jade } normal { bumps 0.5 } }
         blob { threshold 0.6 sphere { 0, 1, 1 } }
         box { 0, 1 pigment { bozo turbulence 0.5 color_map { [0 rgb 0] [1 rgb 1] } } }",
    );
    assert_eq!(messages(&made, Severity::Error), [""; 0]);
    assert_eq!(
        messages(&made, Severity::Warning).len(),
        5,
        "{:?}",
        made.diagnostics
    );
    let scene = made.scene.expect("a scene");
    assert_eq!(scene.objects().len(), 2);
    let Pigment::Uniform(color) = &material_of(&scene, &scene.objects()[1]).pigment else {
        panic!("{scene:?}");
    };
    assert_eq!(color.rgb, DVec3::splat(0.5));
}

#[test]
fn what_is_cut_from_something_left_out_is_not_shown() {
    let blob = "blob { threshold 0.6 sphere { 0, 1, 1 } }";
    let bounds = |text: String| import(&text).scene.expect("a scene").bounds();
    assert!(bounds(format!("difference {{ {blob} sphere {{ 0, 5 }} }}")).is_empty());
    assert!(bounds(format!("intersection {{ plane {{ y, 0 }} {blob} }}")).is_empty());
    assert_eq!(
        bounds(format!("difference {{ sphere {{ 0, 5 }} {blob} }}")).max,
        DVec3::splat(5.0)
    );
    assert_eq!(
        bounds(format!("union {{ sphere {{ 0, 5 }} {blob} }}")).max,
        DVec3::splat(5.0)
    );
}

#[test]
fn nothing_goes_on_for_ever_or_too_deep() {
    let small = Options {
        memory_budget: 1 << 20,
        ..Options::default()
    };
    let deep_parens = format!("#declare A = {}1;", "(".repeat(100_000));
    let deep_minus = format!("#declare A = {}1;", "-".repeat(100_000));
    let deep_unions = "union { ".repeat(100_000);
    let deep_ifs = "#if (#if (".repeat(50_000);
    for text in [
        "#while (1) #end",
        "#for (I, 0, 1e30) #end",
        "#macro A() A() #end A()",
        "#macro A(B) (A(B) + 1) #end #declare C = A(1);",
        "#declare F = function(a) { F(a) }; #declare N = F(1);",
        "#declare A = array[1e9]",
        "#declare A = array[60000][60000]",
        "#declare S = \"ab\"; #while (1) #declare S = concat(S, S) #end",
        "#declare A = sphere { 0, 1 } #while (1) #declare A = union { object { A } } #end",
        "#declare A = sphere { 0, 1 } #for (I, 1, 60) #declare A = union { object { A } object { A } } #end object { A }",
        "#declare A = array[1] #while (1) #declare B = array[1] #declare B[0] = A; #declare A = B #end",
        "polygon { 900000, 0 }",
        &deep_parens,
        &deep_minus,
        &deep_unions,
        &deep_ifs,
    ] {
        let made = import_with(text, &InMemory::default(), &small);
        assert!(made.scene.is_none(), "{}", &text[..text.len().min(60)]);
        assert!(made.diagnostics.has_errors());
    }
    let mut files = InMemory::default();
    files.insert("a.inc", "#include \"a.inc\"");
    let made = import_with("#include \"a.inc\"", &files, &small);
    assert!(made.scene.is_none());
}

#[test]
fn prisms_and_lathes_of_curves_are_solids() {
    // A circle of radius 1 by four Bezier pieces, as prism and cone.
    let k = 0.552_284_75;
    let circle = format!(
        "16, <1, 0>, <1, {k}>, <{k}, 1>, <0, 1>, <0, 1>, <-{k}, 1>, <-1, {k}>, <-1, 0>, \
         <-1, 0>, <-1, -{k}>, <-{k}, -1>, <0, -1>, <0, -1>, <{k}, -1>, <1, -{k}>, <1, 0>"
    );
    let prism = bounds(&format!("prism {{ bezier_spline 1, 3, {circle} }}"));
    assert_close(prism, [-1.0, 1.0, -1.0], [1.0, 3.0, 1.0]);
    let square = "5, <-1, -1>, <1, -1>, <1, 1>, <-1, 1>, <-1, -1>";
    let twice = bounds(&format!("prism {{ conic_sweep -1, 2, {square} }}"));
    assert_close(twice, [-2.0, -1.0, -2.0], [2.0, 2.0, 2.0]);
    // A control point, then from the axis out and back to it.
    let turned = bounds("lathe { quadratic_spline 4, <0, -1>, <0, 0>, <2, 1>, <0, 2> }");
    assert!(turned.contains(DVec3::new(2.0, 1.0, 0.0)) && turned.min.y <= 0.0);
    // Not closed: a surface without inside, which is no operand.
    let vase = "lathe { cubic_spline 6, <1, -1>, <1, 0>, <2, 1>, <1, 2>, <2, 3>, <2, 4> }";
    let imported = import(vase);
    let scene = imported.scene.expect("a scene");
    let is_sheet =
        |object: &octray_scene::Object| matches!(object.shape, octray_scene::Shape::Sheet(_));
    assert!(!scene.objects().is_empty() && scene.objects().iter().all(is_sheet));
}

#[test]
fn numbers_out_of_all_bounds_are_no_crash() {
    for text in [
        "sphere { <1e308, 1e308, 1e308>*10, 1 }",
        "sphere { 0, 1e999 }",
        "box { -1e308, 1e308 scale 1e308 }",
        "cylinder { 0, 0, 1 }",
        "sphere { 0, -1 }",
        "plane { 0, 1 }",
        "disc { 0, 0, 1 }",
        "prism { 0, 0, 3, <0, 0>, <1, 1>, <0, 0> }",
        "prism { bezier_spline 0, 1e300, 4, <0, 0>, <1e200, 1>, <1, 1e308>, <0, 0> }",
        "lathe { cubic_spline 5, <0, 0>, <1e308, 0>, <-1e308, 1>, <0, 1e-300>, <0, 0> }",
        "camera { angle 0 }",
        "camera { right 0 }",
        "camera { location 0 look_at 0 }",
        "light_source { 1e999, rgb 1 }",
        "mesh2 { vertex_vectors { 1, 0 } face_indices { 1, <0, 1, 2> } }",
        "mesh2 { vertex_vectors { 3000000000, 0 } face_indices { 1, <0, 0, 0> } }",
        "sphere { 0, 1 scale 1e-300 scale 1e-300 }",
        "sphere { 0, 1 finish { roughness 0 phong_size 1e999 } interior { ior -1 } }",
    ] {
        let made = import(text);
        assert!(made.diagnostics.iter().count() > 0, "{text}");
    }
}

#[test]
fn empty_scenes_are_scenes() {
    assert_eq!(scene("").objects().len(), 0);
    assert_eq!(scene("union { }").objects().len(), 0);
    assert!(matches!(
        scene("intersection { sphere { 0, 1 } }").objects()[0].shape,
        Shape::Solid(Solid { .. })
    ));
    let checker = scene("plane { y, 0 pigment { checker } }");
    let Pigment::Pattern { pattern, .. } = &checker.materials()[0].pigment else {
        panic!("{checker:?}");
    };
    assert!(matches!(pattern, Pattern::Checker(_)));
}
