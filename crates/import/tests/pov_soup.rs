//! Broken scenes: whatever the bytes, the importer returns, and says what is wrong where no scene
//! comes out.

use std::path::Path;

use octray_import::{InMemory, Options, pov};
use proptest::prelude::*;

/// Small enough that an endless loop is noticed at once.
const BUDGET: u64 = 1 << 20;

fn check(bytes: Vec<u8>) {
    let options = Options {
        memory_budget: BUDGET,
        ..Options::default()
    };
    let mut files = InMemory::default();
    files.insert("a.inc", "#declare A = 1; #macro M(P) sphere { P, 1 } #end");
    let made = pov::import(Path::new("s.pov"), bytes, &files, &options);
    assert_eq!(made.scene.is_none(), made.diagnostics.has_errors());
    for diagnostic in made.diagnostics.iter() {
        assert!(!made.diagnostics.render(diagnostic).is_empty());
    }
}

const WORDS: [&str; 117] = [
    "#declare",
    "#local",
    "#undef",
    "#macro",
    "#if",
    "#ifdef",
    "#else",
    "#elseif",
    "#end",
    "#while",
    "#for",
    "#switch",
    "#case",
    "#range",
    "#break",
    "#include \"a.inc\"",
    "#include \"colors.inc\"",
    "#include \"textures.inc\"",
    "#version",
    "#default",
    "#debug",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "<",
    ">",
    ",",
    ";",
    "=",
    "+",
    "-",
    "*",
    "/",
    "?",
    ":",
    "!",
    "&",
    "|",
    ".",
    "0",
    "1",
    "-2.5",
    "1e300",
    "0.001",
    "\"text\"",
    "A",
    "B",
    "M",
    "Red",
    "x",
    "y",
    "z",
    "pi",
    "rgb",
    "rgbft",
    "color",
    "red",
    "transmit",
    "sphere",
    "box",
    "cylinder",
    "cone",
    "plane",
    "torus",
    "disc",
    "polygon",
    "prism",
    "lathe",
    "mesh",
    "mesh2",
    "triangle",
    "smooth_triangle",
    "vertex_vectors",
    "face_indices",
    "quadric",
    "quartic",
    "poly",
    "polynomial",
    "xyz",
    "superellipsoid",
    "blob",
    "union",
    "difference",
    "intersection",
    "merge",
    "object",
    "light_source",
    "spotlight",
    "point_at",
    "camera",
    "look_at",
    "angle",
    "location",
    "pigment",
    "checker",
    "gradient",
    "color_map",
    "texture",
    "finish",
    "reflection",
    "interior",
    "ior",
    "translate",
    "rotate",
    "scale",
    "matrix",
    "transform",
    "inverse",
    "clipped_by",
    "open",
    "array",
    "function",
    "rand",
    "concat",
];

const SCENES: [&str; 4] = [
    "#include \"colors.inc\" camera { location <0, 1, -5> look_at 0 angle 40 }
     light_source { <10, 20, -30>, White * 0.8 spotlight radius 10 falloff 20 point_at 0 }
     plane { y, -1 pigment { checker Red, White scale 2 } finish { reflection { 0.1, 1 fresnel } } }
     difference { box { -1, 1 } cylinder { -2*z, 2*z, 0.5 } texture { pigment { Gold } } rotate 30*y }",
    "#macro Ring(Thing, Count) #local I = 0; #while (I < Count) object { Thing rotate 360/Count*I*y }
     #local I = I + 1; #end #end #declare T = torus { 1, 0.25 clipped_by { plane { x, 0.5 } } }
     union { Ring(T, 5) scale <1, 2, 1> } #declare F = function(a) { sin(a)^2 };
     #for (I, 0, 3) sphere { <I, F(I), 0>, 0.2 } #end",
    "mesh2 { vertex_vectors { 4, 0, x, y, z } normal_vectors { 4, z, z, z, x } face_indices { 2, <0, 1, 2>, <0, 1, 3> } }
     mesh { triangle { 0, x, y } smooth_triangle { 0, z, x, z, y, z texture { pigment { rgb 1 } } } }
     polygon { 5, 0, x, x + y, y, 0 } prism { 0, 1, 4, <0, 0>, <1, 0>, <0, 1>, <0, 0> }
     lathe { linear_spline 4, <1, 0>, <2, 0>, <1.5, 1>, <1, 0> pigment { gradient y } }",
    "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 4 } #declare A = array[3] { 1, 2, 3 }
     #switch (A[1]) #case (2) #declare C = rgbt <1, 0, 0, 0.5>; #break #else #error \"no\" #end
     sky_sphere { pigment { gradient y color_map { [0 C] [0.5 0.7 rgb 0 rgb 1] } scale 2 translate -1 } }
     merge { sphere { 0, 1 } cone { 0, 1, 2*y, 0 open } texture { pigment { C } finish { phong 1 } } interior { ior 1.5 } }",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        check(bytes);
    }

    #[test]
    fn any_words(words in prop::collection::vec(prop::sample::select(&WORDS[..]), 0..120)) {
        check(words.join(" ").into_bytes());
    }

    #[test]
    fn scenes_with_pieces_moved(
        scene in prop::sample::select(&SCENES[..]),
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0_usize..12, prop::sample::select(&WORDS[..])),
            1..8,
        ),
    ) {
        let mut bytes = scene.as_bytes().to_vec();
        for (place, removed, word) in edits {
            let at = place.index(bytes.len() + 1);
            let end = (at + removed).min(bytes.len());
            bytes.splice(at..end, format!(" {word} ").into_bytes());
        }
        check(bytes);
    }

    #[test]
    fn scenes_cut_off(scene in prop::sample::select(&SCENES[..]), cut in any::<prop::sample::Index>()) {
        check(scene.as_bytes()[..cut.index(scene.len())].to_vec());
    }
}

#[test]
fn the_scenes_themselves_are_fine() {
    for scene in SCENES {
        let bytes = scene.as_bytes().to_vec();
        let made = pov::import(
            Path::new("s.pov"),
            bytes,
            &InMemory::default(),
            &Options::default(),
        );
        assert!(made.scene.is_some(), "{:?}", made.diagnostics);
    }
}
