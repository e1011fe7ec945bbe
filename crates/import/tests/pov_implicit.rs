//! POV-Ray's shapes that are formulas.

use std::path::Path;

use octray_geometry::{Primitive, SolidNode};
use octray_import::{Imported, InMemory, Options, pov};
use octray_math::{Aabb, DVec3};
use octray_scene::Shape;

fn import(text: &str) -> Imported {
    let bytes = text.as_bytes().to_vec();
    pov::import(
        Path::new("s.pov"),
        bytes,
        &InMemory::default(),
        &Options::default(),
    )
}

fn bounds(text: &str) -> Aabb {
    let imported = import(text);
    assert!(
        imported.diagnostics.iter().next().is_none(),
        "{:?}",
        imported.diagnostics
    );
    imported.scene.expect("a scene").bounds()
}

fn assert_close(a: Aabb, min: [f64; 3], max: [f64; 3]) {
    let error = (a.min - DVec3::from(min))
        .abs()
        .max((a.max - DVec3::from(max)).abs());
    assert!(error.max_element() < 1e-9, "{a:?}");
}

#[test]
fn formulas_are_where_their_numbers_say() {
    assert_close(
        bounds("superellipsoid { <0.25, 2.5> scale <1, 2, 3> }"),
        [-1.0, -2.0, -3.0],
        [1.0, 2.0, 3.0],
    );
    // (x^2 + y^2 + z^2)^2 <= 1 and x^2 + y^2 + z^2 <= 2 x.
    let ball = "quartic { <1, 0, 0, 0, 2, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
        1, 0, 0, 2, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, -1> sturm }";
    assert!(bounds(ball).max.max_element() < 1.1 && bounds(ball).max.min_element() >= 1.0);
    assert_close(
        bounds("poly { 2, <1, 0, 0, -2, 1, 0, 0, 1, 0, 0> }"),
        [0.0, -1.0, -1.0],
        [2.0, 1.0, 1.0],
    );
    assert_close(
        bounds(
            "polynomial { 2, xyz(2, 0, 0): 1, xyz(1, 0, 0): -2 xyz(0, 2, 0): 1, xyz(0, 0, 2): 1 }",
        ),
        [0.0, -1.0, -1.0],
        [2.0, 1.0, 1.0],
    );
}

#[test]
fn a_polynomial_is_the_same_in_both_notations() {
    let solid = |text: &str| {
        let made = import(text).scene.expect("a scene");
        let Shape::Solid(solid) = &made.objects()[0].shape else {
            panic!("{made:?}");
        };
        let mut nodes = vec![solid.clone()];
        while let Some(solid) = nodes.pop() {
            match solid.node() {
                SolidNode::Primitive(Primitive::Polynomial { polynomial, .. }) => {
                    return polynomial.clone();
                }
                SolidNode::Transformed { child, .. } | SolidNode::WithMaterial { child, .. } => {
                    nodes.push(child.clone());
                }
                other => panic!("{other:?}"),
            }
        }
        unreachable!("every branch returns or goes on")
    };
    let dense: Vec<String> = (0..20).map(|i| (i + 1).to_string()).collect();
    let cubic = solid(&format!("cubic {{ <{}> }}", dense.join(", ")));
    let powers = [
        "3, 0, 0", "2, 1, 0", "2, 0, 1", "2, 0, 0", "1, 2, 0", "1, 1, 1", "1, 1, 0", "1, 0, 2",
        "1, 0, 1", "1, 0, 0", "0, 3, 0", "0, 2, 1", "0, 2, 0", "0, 1, 2", "0, 1, 1", "0, 1, 0",
        "0, 0, 3", "0, 0, 2", "0, 0, 1", "0, 0, 0",
    ];
    let terms = powers.iter().zip(&dense).rev();
    let terms: Vec<String> = terms.map(|(p, c)| format!("xyz({p}): {c}")).collect();
    let sparse = solid(&format!("polynomial {{ 3, {} }}", terms.join(", ")));
    assert_eq!(cubic, sparse);
}

#[test]
fn bad_polynomials_are_refused_where_they_are() {
    for (text, message) in [
        ("cubic { <1, 2, 3> }", "has 20 coefficients, not 3"),
        (
            "poly { 1, <1, 2, 3, 4> }",
            "a whole number from 2 to 35, not 1",
        ),
        ("poly { 2.5, <1> }", "a whole number from 2 to 35, not 2.5"),
        ("poly { 1e9, <1> }", "a whole number from 2 to 35"),
        (
            "poly { 2, <1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11> }",
            "has 10 coefficients",
        ),
        ("polynomial { 3, xyz(2, 2, 0): 1 }", "more than the order 3"),
        (
            "polynomial { 3, xyz(4, 0, 0): 1 }",
            "a power must be a whole number from 0 to 3",
        ),
        (
            "polynomial { 20, xyz(20, 0, 0): 1 }",
            "the degree must be 1 to 15, not 20",
        ),
        ("superellipsoid { <0, 1> }", "exponent e must be from"),
    ] {
        let imported = import(text);
        let said = imported.diagnostics.iter();
        let said: Vec<String> = said.map(|d| imported.diagnostics.render(d)).collect();
        assert!(
            said.len() == 1 && said[0].contains(message),
            "{text}: {said:?}"
        );
    }
}
