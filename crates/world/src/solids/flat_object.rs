//! Objects that are a convex hull less convex holes: drilled blocks, lenses, balls.
//!
//! A line is in the hull, and in every hole, in one stretch at most: the latest of the entries to the
//! earliest of the exits. That takes no lists, no sorting and no evaluation of expressions, and finds
//! the changes of the sweep to the bit, with their faces: stretches are taken without their ends, so
//! that what is entered where another is left is not entered at all.

use octray_geometry::FaceId;
use octray_geometry::csg::{self, Face, Term};
use octray_geometry::surface::{Side, Stretch, Surface};
use octray_math::{Aabb, Interval};

use super::leaf::{LeafObject, LeafView};
use crate::Counters;
use crate::line::Line;

/// The most holes of an object.
const MOST_HOLES: usize = 15;
/// The most literals of an object.
const MOST_LITERALS: usize = 64;

/// One side of a surface, which is convex.
#[derive(Clone, Copy, Debug)]
struct Literal {
    surface: u32,
    /// The face, whether the side is the negative one, whether it is the last of a hole.
    word: u32,
}

const NEGATIVE: u32 = 1;
const LAST: u32 = 2;

impl Literal {
    const fn new(surface: u32, face: FaceId, negative: bool) -> Self {
        Self {
            surface,
            word: face.0 << 2 | if negative { NEGATIVE } else { 0 },
        }
    }

    const fn face(self) -> u32 {
        self.word >> 2
    }

    const fn is_negative(self) -> bool {
        self.word & NEGATIVE != 0
    }
}

/// Where an object's literals are: none for one of another form.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    start: u32,
    hull_end: u32,
    end: u32,
}

/// The objects of a leaf, in its order.
#[derive(Debug, Default)]
pub(super) struct FlatObjects {
    places: Vec<Place>,
    literals: Vec<Literal>,
}

/// A boundary on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FirstChange {
    pub(super) s: f64,
    pub(super) face: FaceId,
    pub(super) entering: bool,
}

/// What is known of an object on a part of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ahead {
    /// The line is outside all along.
    Outside,
    /// It is inside all along.
    Inside,
    /// It is not.
    Change(FirstChange),
    /// To be asked of the expression.
    Unknown,
}

/// The part of a line that counts, and the surface that it starts on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<'a> {
    pub(super) line: &'a Line,
    /// Crossings before it are passed.
    bound: f64,
    /// The surface and whether the line goes to its positive side.
    departed: Option<(u32, bool)>,
    start: f64,
}

impl<'a> Course<'a> {
    /// Of a line from `start` on.
    pub(super) fn new(line: &'a Line, start: f64, departed: Option<(u32, bool)>) -> Self {
        Self {
            line,
            bound: start.max(line.origin.next_up()),
            departed,
            start,
        }
    }
}

/// A stretch with the lowest faces at its ends.
#[derive(Clone, Copy, Debug)]
struct Bounded {
    stretch: Stretch,
    enter_face: u32,
    leave_face: u32,
}

impl Bounded {
    const ALL: Self = Self {
        stretch: Stretch::ALL,
        enter_face: u32::MAX,
        leave_face: u32::MAX,
    };

    /// The common part.
    #[inline(always)]
    fn cut(&mut self, other: Stretch, face: u32) {
        let own = &mut self.stretch;
        if other.enter > own.enter {
            own.enter = other.enter;
            self.enter_face = face;
        } else if other.enter == own.enter {
            self.enter_face = self.enter_face.min(face);
        }
        if other.leave < own.leave {
            own.leave = other.leave;
            self.leave_face = face;
        } else if other.leave == own.leave {
            self.leave_face = self.leave_face.min(face);
        }
    }

    /// Whether nothing of it lies between two parameters.
    #[inline(always)]
    fn misses(&self, start: f64, end: f64) -> bool {
        let Stretch { enter, leave } = self.stretch;
        enter >= leave || enter > end || leave < start
    }
}

impl FlatObjects {
    /// Of the objects of a leaf that have the form; `bounds` by rank, `shell` says of a rank whether
    /// it is a sheet.
    pub(super) fn new(
        view: &LeafView<'_>,
        bounds: &[Aabb],
        shell: impl Fn(u32) -> bool,
        faces: &[Face],
        surfaces: &[Surface],
    ) -> Self {
        let mut all = Self::default();
        for object in view.objects {
            let start = all.literals.len();
            let place = (view.clip(object).is_none() && !shell(object.rank))
                .then(|| {
                    let bounds = &bounds[object.rank as usize];
                    all.add(view.expression(object), bounds, faces, surfaces)
                })
                .flatten();
            if place.is_none() {
                all.literals.truncate(start);
            }
            all.places.push(place.unwrap_or_default());
        }
        all.places.shrink_to_fit();
        all.literals.shrink_to_fit();
        all
    }

    /// Whether an expression has the form.
    pub(super) fn suits(words: &[u32], faces: &[Face], surfaces: &[Surface]) -> bool {
        let unbounded = Aabb::ALL;
        Self::default()
            .add(words, &unbounded, faces, surfaces)
            .is_some()
    }

    /// Bytes of the lists.
    pub(super) fn list_bytes(&self) -> u64 {
        (size_of_val(self.places.as_slice()) + size_of_val(self.literals.as_slice())) as u64
    }

    fn add(
        &mut self,
        words: &[u32],
        bounds: &Aabb,
        faces: &[Face],
        surfaces: &[Surface],
    ) -> Option<Place> {
        if csg::faces(words).nth(MOST_LITERALS).is_some() {
            return None;
        }
        let convex = |face: FaceId, complement: bool| {
            let Face {
                surface,
                inside_is_positive,
                ..
            } = faces[face.0 as usize];
            let negative = inside_is_positive == complement;
            surfaces
                .get(surface.0 as usize)?
                .has_convex_side(negative)
                .then_some(Literal::new(surface.0, face, negative))
        };
        let start = self.literals.len();
        let whole = [0];
        let terms: Vec<usize> = match csg::term(words, 0) {
            Term::And => csg::operands(words, 0).collect(),
            Term::Literal(_) | Term::Or => whole.to_vec(),
        };
        let mut holes = Vec::new();
        for at in terms {
            match csg::term(words, at) {
                Term::Literal(face) => match convex(face, false) {
                    Some(literal) => self.literals.push(literal),
                    None => holes.push(vec![convex(face, true)?]),
                },
                Term::Or => {
                    let literal = |at: usize| match csg::term(words, at) {
                        Term::Literal(face) => convex(face, true),
                        _ => None,
                    };
                    let hole: Option<Vec<Literal>> =
                        csg::operands(words, at).map(literal).collect();
                    holes.push(hole?);
                }
                Term::And => return None,
            }
        }
        if holes.len() > MOST_HOLES {
            return None;
        }
        let hull_end = self.literals.len();
        for mut hole in holes {
            cut_short(&mut hole, bounds, surfaces);
            if let Some(last) = hole.last_mut() {
                last.word |= LAST;
            }
            self.literals.append(&mut hole);
        }
        Some(Place {
            start: start as u32,
            hull_end: hull_end as u32,
            end: self.literals.len() as u32,
        })
    }

    /// What happens first to an object of the leaf on the course, up to `end`.
    #[inline]
    pub(super) fn ahead(
        &self,
        index: u32,
        course: &Course<'_>,
        end: f64,
        surfaces: &[Surface],
        counters: &mut Counters,
    ) -> Ahead {
        let Place {
            start,
            hull_end,
            end: literals_end,
        } = self.places[index as usize];
        if start == literals_end {
            return Ahead::Unknown;
        }
        let mut hull = Bounded::ALL;
        for literal in &self.literals[start as usize..hull_end as usize] {
            counters.surface_tests += 1;
            let Some(stretch) = course.stretch(*literal, surfaces) else {
                return Ahead::Unknown;
            };
            hull.cut(stretch, literal.face());
            if hull.misses(course.bound, end) {
                return Ahead::Outside;
            }
        }
        let holes = &self.literals[hull_end as usize..literals_end as usize];
        if holes.is_empty() {
            return course.first(&hull, &[], end);
        }
        let mut met = [Bounded::ALL; MOST_HOLES];
        let mut count = 0;
        let Stretch { enter, leave } = hull.stretch;
        let (from, to) = (enter.max(course.bound), leave.min(end));
        let mut hole = Bounded::ALL;
        let mut skip = false;
        for literal in holes {
            if !skip {
                counters.surface_tests += 1;
                let Some(stretch) = course.stretch(*literal, surfaces) else {
                    return Ahead::Unknown;
                };
                hole.cut(stretch, literal.face());
                skip = hole.misses(from, to);
            }
            if literal.word & LAST != 0 {
                if !skip {
                    met[count] = hole;
                    count += 1;
                }
                hole = Bounded::ALL;
                skip = false;
            }
        }
        course.first(&hull, &met[..count], end)
    }
}

impl Course<'_> {
    /// The part up to `end`.
    pub(super) const fn until(&self, end: f64) -> Interval {
        Interval::new(self.start, end)
    }

    /// Where the line is on the literal's side; `None` where the surface is the departed one and that
    /// does not say which crossings are passed.
    #[inline(always)]
    fn stretch(&self, literal: Literal, surfaces: &[Surface]) -> Option<Stretch> {
        let surface = &surfaces[literal.surface as usize];
        let Stretch { enter, leave } =
            surface.convex_stretch(literal.is_negative(), &self.line.ray);
        // There is one zero.
        let stretch = Stretch {
            enter: enter + 0.0,
            leave: leave + 0.0,
        };
        match self.departed {
            Some((departed, to_positive)) if departed == literal.surface => {
                self.without_departure(stretch, to_positive == literal.is_negative())
            }
            _ => Some(stretch),
        }
    }

    /// The stretch on a side of the surface that the line has just crossed, to leave that side or to
    /// enter it: that crossing is passed, and all before it.
    #[cold]
    fn without_departure(&self, stretch: Stretch, leaving: bool) -> Option<Stretch> {
        let Stretch { enter, leave } = stretch;
        if enter > leave {
            return Some(stretch);
        }
        if leaving && leave < f64::INFINITY {
            return Some(Stretch::NOTHING);
        }
        if leaving || enter == f64::NEG_INFINITY {
            // No crossing of that sense: the parameter decides.
            return Some(stretch);
        }
        // A crossing that is not passed counts from the start on.
        let counts = leave >= self.bound || leave < self.start;
        counts.then_some(Stretch {
            enter: f64::NEG_INFINITY,
            leave,
        })
    }

    /// The first change of the hull less the holes, of which all that matter up to `end` are given.
    #[inline(always)]
    fn first(&self, hull: &Bounded, holes: &[Bounded], end: f64) -> Ahead {
        let Stretch { enter, leave } = hull.stretch;
        // Before this the line is not in the object.
        let passed = enter < self.bound;
        let mut inside_from = if passed { f64::NEG_INFINITY } else { enter };
        let is_in = |hole: &Bounded, s: f64| {
            let Stretch { enter, leave } = hole.stretch;
            leave >= self.bound && (enter <= s || enter < self.bound) && s < leave
        };
        while let Some(hole) = holes.iter().find(|hole| is_in(hole, inside_from)) {
            inside_from = hole.stretch.leave;
        }
        if inside_from >= leave || inside_from > end {
            return Ahead::Outside;
        }
        let mut face = u32::MAX;
        if inside_from > f64::NEG_INFINITY {
            if enter == inside_from {
                face = hull.enter_face;
            }
            for hole in holes.iter().filter(|h| h.stretch.leave == inside_from) {
                face = face.min(hole.leave_face);
            }
            return Ahead::Change(FirstChange {
                s: inside_from,
                face: FaceId(face),
                entering: true,
            });
        }
        let mut s = leave;
        face = hull.leave_face;
        for hole in holes.iter().filter(|h| h.stretch.enter >= self.bound) {
            let Stretch { enter, .. } = hole.stretch;
            if enter < s {
                s = enter;
                face = hole.enter_face;
            } else if enter == s {
                face = face.min(hole.enter_face);
            }
        }
        if s > end {
            return Ahead::Inside;
        }
        Ahead::Change(FirstChange {
            s,
            face: FaceId(face),
            entering: false,
        })
    }
}

/// Leaves out of a hole the sides that all of the object's box is on: without them the hole goes on
/// beyond the box only, where the object is not.
fn cut_short(hole: &mut Vec<Literal>, bounds: &Aabb, surfaces: &[Surface]) {
    if !bounds.is_bounded() {
        return;
    }
    let bounds = super::volumes::grown(&super::volumes::grown(bounds));
    let is_cut = |literal: &Literal| {
        let side = surfaces[literal.surface as usize].classify(&bounds);
        side == if literal.is_negative() {
            Side::Negative
        } else {
            Side::Positive
        }
    };
    let first = hole.first().copied();
    hole.retain(|literal| !is_cut(literal));
    if hole.is_empty() {
        hole.extend(first);
    }
}

/// An object that a line meets, or that holds it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    pub(super) object: LeafObject,
    /// Whether the line is, or may be, inside before the object's first change.
    pub(super) inside: bool,
    /// The first change, infinite for none.
    pub(super) s: f64,
}
