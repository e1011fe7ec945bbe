//! Cases as text that reads back to the same bits: numbers are the shortest that round-trip.
//!
//! ```text
//! (case (object 0 (difference (box 0 0 0 1 1 1) (move 1 0 0 0 1 0 0 0 1 .5 .5 0 (sphere 0.25))))
//!       (ray -2 0.5 0.5 1 0 0))
//! ```
//!
//! `move` has the columns of the matrix, then the translation. A case that starts with `delicate`
//! may have slivers between its boundaries.

use std::fmt::Write;
use std::sync::Arc;

use octray_geometry::surface::QuadricForm;
use octray_geometry::{ConvexPolyhedron, Polynomial, Primitive, Solid, SolidNode};
use octray_math::{Aabb, DAffine3, DVec3, Ray};
use octray_world::Method;

use crate::model::{Case, Model, Part};

/// Quadrics are written by their place here.
const FORMS: [QuadricForm; 7] = [
    QuadricForm::OneSheet,
    QuadricForm::TwoSheets,
    QuadricForm::DoubleCone,
    QuadricForm::EllipticParaboloid,
    QuadricForm::HyperbolicParaboloid,
    QuadricForm::HyperbolicCylinder,
    QuadricForm::ParabolicCylinder,
];

/// Stands for a primitive that has no text.
pub(crate) const UNWRITTEN: &str = "unwritten";

fn numbers(out: &mut String, values: impl IntoIterator<Item = f64>) {
    for value in values {
        write!(out, " {value:?}").expect("a string takes all");
    }
}

fn list(out: &mut String, head: &str, solids: &[Solid]) {
    out.push_str(head);
    for solid in solids {
        out.push(' ');
        write_solid(out, solid);
    }
}

fn write_solid(out: &mut String, solid: &Solid) {
    out.push('(');
    match solid.node() {
        SolidNode::Empty => out.push_str("empty"),
        SolidNode::Primitive(primitive) => write_primitive(out, primitive),
        SolidNode::Transformed {
            child,
            parent_from_child,
        } => {
            out.push_str("move");
            numbers(out, parent_from_child.to_cols_array());
            out.push(' ');
            write_solid(out, child);
        }
        SolidNode::WithMaterial { child, .. } => list(out, "union", std::slice::from_ref(child)),
        SolidNode::Complement(child) => list(out, "complement", std::slice::from_ref(child)),
        SolidNode::Union(all) => list(out, "union", all),
        SolidNode::Intersection(all) => list(out, "intersection", all),
        SolidNode::Difference(all) => list(out, "difference", all),
    }
    out.push(')');
}

fn write_primitive(out: &mut String, primitive: &Primitive) {
    let mut put = |head: &str, values: &[f64]| {
        out.push_str(head);
        numbers(out, values.iter().copied());
    };
    match primitive {
        Primitive::Sphere { radius } => put("sphere", &[*radius]),
        Primitive::Box { min, max } => {
            put("box", &[min.to_array(), max.to_array()].concat());
        }
        Primitive::Cylinder { radius, z } => put("cylinder", &[*radius, z[0], z[1]]),
        Primitive::Cone { radius, z } => put("cone", &[radius[0], radius[1], z[0], z[1]]),
        Primitive::Torus { major, minor } => put("torus", &[*major, *minor]),
        Primitive::HalfSpace { normal, offset } => {
            put("half-space", &[normal.x, normal.y, normal.z, *offset]);
        }
        Primitive::Convex(polyhedron) => {
            let planes = polyhedron.planes.iter();
            put("convex", &[polyhedron.planes.len() as f64]);
            numbers(out, planes.flat_map(|(n, d)| [n.x, n.y, n.z, *d]));
            numbers(out, polyhedron.vertices.iter().flat_map(|v| v.to_array()));
        }
        Primitive::Quadric(form) => {
            let index = FORMS.iter().position(|f| f == form).expect("listed");
            put("quadric", &[index as f64]);
        }
        Primitive::Polynomial { polynomial, bounds } => {
            put("polynomial", &[polynomial.degree() as f64]);
            numbers(out, [bounds.min.to_array(), bounds.max.to_array()].concat());
            numbers(out, polynomial.coefficients().iter().copied());
        }
        Primitive::Superellipsoid { exponents } => put("superellipsoid", exponents),
        // Made from outlines that it does not keep: to be found again by its seed.
        Primitive::Composite(_) => out.push_str(UNWRITTEN),
        other => panic!("no text for {other:?}"),
    }
}

/// A case on one line.
pub(crate) fn write_case(case: &Case) -> String {
    let mut out = String::from("(case");
    if case.model.delicate {
        out.push_str(" delicate");
    }
    if case.model.method != Method::Auto {
        write!(out, " (method {})", case.model.method).expect("a string takes all");
    }
    for part in &case.model.parts {
        write!(out, " (object {} ", part.priority).expect("a string takes all");
        write_solid(&mut out, &part.solid);
        out.push(')');
    }
    out.push_str(" (ray");
    let ray = case.ray;
    numbers(
        &mut out,
        ray.origin
            .to_array()
            .into_iter()
            .chain(ray.direction.to_array()),
    );
    out.push_str("))");
    out
}

/// A list in parentheses, or a word.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Term {
    Word(String),
    List(Vec<Self>),
}

impl Term {
    fn list(&self) -> &[Self] {
        match self {
            Self::List(terms) => terms,
            Self::Word(word) => panic!("a list is expected, not {word}"),
        }
    }

    fn word(&self) -> &str {
        match self {
            Self::Word(word) => word,
            Self::List(_) => panic!("a word is expected, not a list"),
        }
    }

    fn number(&self) -> f64 {
        self.word().parse().expect("a number")
    }
}

/// The term that a text states.
pub(crate) fn parse(text: &str) -> Term {
    let spaced = text.replace('(', " ( ").replace(')', " ) ");
    let mut open: Vec<Vec<Term>> = vec![Vec::new()];
    for token in spaced.split_whitespace() {
        match token {
            "(" => open.push(Vec::new()),
            ")" => {
                let done = Term::List(open.pop().expect("balanced parentheses"));
                open.last_mut().expect("balanced parentheses").push(done);
            }
            word => open
                .last_mut()
                .expect("balanced parentheses")
                .push(Term::Word(word.to_owned())),
        }
    }
    let mut top = open.pop().expect("balanced parentheses");
    assert!(open.is_empty() && top.len() == 1, "one term is expected");
    top.remove(0)
}

/// The case that a term states.
///
/// # Panics
/// For any other term.
pub(crate) fn read_case(term: &Term) -> Case {
    let mut parts = Vec::new();
    let mut delicate = false;
    let mut method = Method::Auto;
    let mut ray = None;
    for term in &term.list()[1..] {
        match term {
            Term::Word(word) => delicate |= word == "delicate",
            Term::List(terms) if terms[0].word() == "object" => parts.push(Part {
                priority: terms[1].number() as i32,
                solid: read_solid(&terms[2]),
            }),
            Term::List(terms) if terms[0].word() == "method" => {
                method = terms[1].word().parse().expect("a method");
            }
            Term::List(terms) => {
                let v: Vec<f64> = terms[1..].iter().map(Term::number).collect();
                ray = Some(Ray::new(DVec3::from_slice(&v), DVec3::from_slice(&v[3..])));
            }
        }
    }
    let ray = ray.expect("a case has a ray");
    let model = Model {
        parts,
        delicate,
        method,
    };
    Case { model, ray }
}

fn read_solid(term: &Term) -> Solid {
    let (head, rest) = term.list().split_first().expect("a solid has a name");
    let solids = || -> Vec<Solid> { rest.iter().map(read_solid).collect() };
    let values = || -> Vec<f64> { rest.iter().map(Term::number).collect() };
    let node = match head.word() {
        "empty" => SolidNode::Empty,
        "union" => SolidNode::Union(solids()),
        "intersection" => SolidNode::Intersection(solids()),
        "difference" => SolidNode::Difference(solids()),
        "complement" => SolidNode::Complement(read_solid(&rest[0])),
        "move" => {
            let matrix: Vec<f64> = rest[..12].iter().map(Term::number).collect();
            SolidNode::Transformed {
                child: read_solid(&rest[12]),
                parent_from_child: DAffine3::from_cols_slice(&matrix),
            }
        }
        primitive => SolidNode::Primitive(read_primitive(primitive, &values())),
    };
    node.into()
}

fn read_primitive(head: &str, v: &[f64]) -> Primitive {
    let at = DVec3::from_slice;
    match head {
        "sphere" => Primitive::Sphere { radius: v[0] },
        "box" => Primitive::Box {
            min: at(v),
            max: at(&v[3..]),
        },
        "cylinder" => Primitive::Cylinder {
            radius: v[0],
            z: [v[1], v[2]],
        },
        "cone" => Primitive::Cone {
            radius: [v[0], v[1]],
            z: [v[2], v[3]],
        },
        "torus" => Primitive::Torus {
            major: v[0],
            minor: v[1],
        },
        "half-space" => Primitive::HalfSpace {
            normal: at(v),
            offset: v[3],
        },
        "convex" => {
            let (planes, vertices) = v[1..].split_at(4 * v[0] as usize);
            Primitive::Convex(Arc::new(ConvexPolyhedron {
                planes: planes.chunks(4).map(|p| (at(p), p[3])).collect(),
                vertices: vertices.chunks(3).map(at).collect(),
            }))
        }
        "quadric" => Primitive::Quadric(FORMS[v[0] as usize]),
        "polynomial" => {
            let polynomial = Polynomial::new(v[0] as usize, &v[7..]).expect("a polynomial");
            Primitive::Polynomial {
                polynomial: Arc::new(polynomial),
                bounds: Aabb::new(at(&v[1..]), at(&v[4..])),
            }
        }
        "superellipsoid" => Primitive::Superellipsoid {
            exponents: [v[0], v[1]],
        },
        other => panic!("no primitive is called {other}"),
    }
}
