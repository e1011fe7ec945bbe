//! What is said of what is wrong or not supported.

use crate::reading::{mistakes, read, read_with, shown};

#[test]
fn what_is_not_supported_is_said_once_per_use() {
    let (scene, warnings) = read(
        "cube(1);\nlinear_extrude(height = 3, twist = 90) {\n  square(1);\n}\n\
         union() {\n  circle(r = 1);\n  hull() { cube(1); }\n  sphere(1);\n}\n\
         linear_extrude(height = 3) {\n  text(\"a\");\n  square(1);\n  cube(1);\n}\n",
    );
    assert_eq!(scene.objects().len(), 3);
    let starts = ["2:1: ", "6:3: ", "7:3: ", "11:3: ", "13:3: "];
    assert_eq!(warnings.len(), starts.len(), "{warnings:#?}");
    for (warning, start) in warnings.iter().zip(starts) {
        assert!(
            warning.starts_with(&format!("a.csg:{start}warning: `")),
            "{warning}"
        );
        assert!(warning.contains("; it is left out"), "{warning}");
    }
}

#[test]
fn all_mistakes_are_reported_at_once() {
    let found = mistakes(
        "cube(size = [1, 2);\nsphre(r = 1);\nunion() {\n  cube(1) sphere(1;\n  cylinder(h = ];\n}\n\
         sphere(r = 1)\n}\ncube(1);\nintersection( {",
    );
    let starts: Vec<&str> = found
        .iter()
        .map(|m| m.split(": ").next().unwrap_or(""))
        .collect();
    for place in [
        "a.csg:1:18",
        "a.csg:2:1",
        "a.csg:4:19",
        "a.csg:5:16",
        "a.csg:8:1",
        "a.csg:10:15",
    ] {
        assert!(starts.contains(&place), "{place}: {found:#?}");
    }
}

#[test]
fn unknown_modules_get_a_suggestion() {
    let help = |text: &str| shown(&read_with(text, false)).join("\n");
    assert!(help("cylindre(h = 1);").contains("did you mean `cylinder`?"));
    assert!(help("translate([1, 2, 3]) cube(1);").contains("openscad -o model.csg"));
    assert!(help("x = 3;").contains("openscad -o model.csg"));
    assert!(help("module a() { cube(1); }").contains("openscad -o model.csg"));
}
