//! Makes a case smaller while it still shows the same disagreement.

use octray_geometry::{Primitive, Solid, SolidNode};
use octray_math::transform;

use crate::check::{Tally, Wrong, check};
use crate::model::Case;
use crate::text::{Term, UNWRITTEN, parse, read_case, write_case};

/// The smallest case that could be found, with the same kind of disagreement.
pub(crate) fn shrink(case: &Case, wrong: Wrong) -> Case {
    let mut best = write_case(case);
    if best.contains(UNWRITTEN) {
        return case.clone();
    }
    let mut budget = 4000_u32;
    loop {
        let term = parse(&best);
        // Other numbers may pull boundaries apart that coincide: then a skin is real.
        let numbers = wrong != Wrong::Skin;
        let shorter = variants(&term, numbers).into_iter().find_map(|variant| {
            let case = read_case(&variant);
            let text = write_case(&case);
            if text.len() >= best.len() || budget == 0 {
                return None;
            }
            budget -= 1;
            shows(&case, wrong).then_some(text)
        });
        match shorter {
            Some(text) => best = text,
            None => return read_case(&term),
        }
    }
}

fn shows(case: &Case, wrong: Wrong) -> bool {
    if !case.model.parts.iter().all(|part| is_valid(&part.solid)) {
        return false;
    }
    let Some(subject) = case.model.prepare() else {
        return false;
    };
    let ray = case.ray;
    ray.is_valid()
        && check(&subject, ray, &mut Tally::default()).is_err_and(|found| found.wrong == wrong)
}

/// Whether the constructors would have made it.
fn is_valid(solid: &Solid) -> bool {
    match solid.node() {
        SolidNode::Empty => true,
        SolidNode::Primitive(primitive) => match primitive {
            Primitive::Sphere { radius } => Solid::sphere(*radius).is_ok(),
            Primitive::Box { min, max } => {
                min.cmplt(*max).all() && Solid::cuboid(*min, *max).is_ok()
            }
            Primitive::Cylinder { radius, z } => {
                Solid::infinite_cylinder(*radius).is_ok()
                    && (z[0] == f64::NEG_INFINITY || Solid::cylinder(*radius, z[0], z[1]).is_ok())
            }
            Primitive::Cone { radius, z } => {
                radius[0] != radius[1] && Solid::cone(radius[0], radius[1], z[0], z[1]).is_ok()
            }
            Primitive::Torus { major, minor } => Solid::torus(*major, *minor).is_ok(),
            Primitive::HalfSpace { normal, .. } => (normal.length() - 1.0).abs() < 1e-15,
            Primitive::Superellipsoid { exponents: [e, n] } => {
                e.max(*n) <= 2.0 && Solid::superellipsoid(*e, *n).is_ok()
            }
            _ => true,
        },
        SolidNode::Transformed {
            child,
            parent_from_child,
        } => transform::is_invertible(parent_from_child) && is_valid(child),
        SolidNode::WithMaterial { child, .. } | SolidNode::Complement(child) => is_valid(child),
        SolidNode::Union(all) | SolidNode::Intersection(all) | SolidNode::Difference(all) => {
            all.iter().all(is_valid)
        }
    }
}

/// Everything one step simpler: the large steps first.
fn variants(term: &Term, numbers: bool) -> Vec<Term> {
    let mut all = Vec::new();
    match term {
        Term::Word(_) if !numbers => {}
        Term::Word(word) => all.extend(simpler_numbers(word).into_iter().map(Term::Word)),
        Term::List(terms) => {
            let head = match terms.first() {
                Some(Term::Word(head)) => head.as_str(),
                _ => "",
            };
            if matches!(
                head,
                "union" | "intersection" | "difference" | "complement" | "move"
            ) {
                let children = terms.iter().filter(|t| matches!(t, Term::List(_)));
                all.extend(children.cloned());
            }
            let fewest = match head {
                "union" | "intersection" | "difference" => 3,
                "case" => 2,
                _ => usize::MAX,
            };
            let droppable =
                |t: &Term| matches!(t, Term::List(inner) if inner[0] != Term::Word("ray".into()));
            for index in (1..terms.len()).filter(|i| terms.len() > fewest && droppable(&terms[*i]))
            {
                let mut fewer = terms.clone();
                fewer.remove(index);
                all.push(Term::List(fewer));
            }
            // The count of a polyhedron's planes must stay what it is.
            for index in
                (1..terms.len()).filter(|_| !matches!(head, "convex" | "quadric" | "polynomial"))
            {
                for variant in variants(&terms[index], numbers) {
                    let mut changed = terms.clone();
                    changed[index] = variant;
                    all.push(Term::List(changed));
                }
            }
        }
    }
    all
}

fn simpler_numbers(word: &str) -> Vec<String> {
    let Ok(value) = word.parse::<f64>() else {
        return Vec::new();
    };
    if !value.is_finite() || value == 0.0 {
        return Vec::new();
    }
    let mut all = vec![
        0.0,
        value.signum(),
        value.round(),
        (value * 8.0).round() / 8.0,
    ];
    let unit = libm::ldexp(1.0, libm::ilogb(value));
    for bits in [0, 3, 10, 20, 30, 40] {
        let step = libm::ldexp(unit, -bits);
        all.push((value / step).round() * step);
    }
    for digits in [1, 3, 6, 9, 12] {
        all.extend(format!("{value:.digits$e}").parse::<f64>());
    }
    all.retain(|simple| *simple != value);
    all.into_iter()
        .map(|simple| format!("{simple:?}"))
        .collect()
}
