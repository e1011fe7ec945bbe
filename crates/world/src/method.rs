//! The methods by which rays find surfaces: one value, its name, and the table of what can be
//! combined.

use std::fmt;
use std::str::FromStr;

use octray_geometry::Membership;
use octray_tree::{Division, Encoding, LvsiStore, Traversal};
use thiserror::Error;

/// How the surfaces on a ray are found. The answers are the same bits.
///
/// Written `auto | brute | spheres | boxes | grid[:N] | octree[:ENCODING[:TRAVERSAL[:MEMBERSHIP]]]`
/// with the encodings `tree`, `lvsi`, `lvsi-empty`, the traversals `ordered`, `sung`,
/// `fujimoto-iwata`, `beam` and the membership tests `analytic`, `bounding-box`,
/// `bounding-sphere`, `bounding-cover`, `shells`.
///
/// A method acts on the solids and on the triangles of meshes that bound nothing. A mesh that is an
/// operand of a set operation counts as one surface among the solids'; the triangles of that surface
/// are found by an octree with wide nodes of their own, except by brute force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The fastest: an octree over the solids, one with wide nodes over the triangles.
    #[default]
    Auto,
    /// Every surface is tested with every ray: the oracle.
    Brute,
    /// A sphere around every object is tested first.
    Spheres,
    /// A box around every object is tested first.
    Boxes,
    /// A uniform grid: so many voxels on each axis, or as many as suit the scene.
    Grid(Option<u32>),
    /// An octree.
    Octree {
        /// How it is kept.
        encoding: Encoding,
        /// How it is walked.
        traversal: Traversal,
        /// How its builder decides which objects a cell touches.
        membership: Membership,
    },
}

/// Why a name is not that of a method.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MethodError {
    /// A word that no method has.
    #[error("`{0}` is no method: use {grammar}", grammar = GRAMMAR)]
    Unknown(String),
    /// A combination that cannot work.
    #[error("`{0}`: {1}")]
    Senseless(String, &'static str),
}

const GRAMMAR: &str = "auto, brute, spheres, boxes, grid[:N] or octree[:ENCODING[:TRAVERSAL[:MEMBERSHIP]]] \
     with the encodings tree, lvsi, lvsi-empty, the traversals ordered, sung, fujimoto-iwata, beam \
     and the membership tests analytic, bounding-box, bounding-sphere, bounding-cover, shells";

const ENCODINGS: [(&str, Encoding); 3] = [
    ("tree", Encoding::Tree),
    ("lvsi", Encoding::Lvsi(LvsiStore::Occupied)),
    ("lvsi-empty", Encoding::Lvsi(LvsiStore::All)),
];

const TRAVERSALS: [(&str, Traversal); 4] = [
    ("ordered", Traversal::Ordered),
    ("sung", Traversal::Sung),
    ("fujimoto-iwata", Traversal::FujimotoIwata),
    ("beam", Traversal::Beam),
];

const MEMBERSHIPS: [(&str, Membership); 5] = [
    ("analytic", Membership::Analytic),
    ("bounding-box", Membership::BoundingBox),
    ("bounding-sphere", Membership::BoundingSphere),
    ("bounding-cover", Membership::BoundingCover),
    ("shells", Membership::Shells),
];

/// The value that has this name.
fn named<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    let entry = table.iter().find(|(n, _)| *n == name);
    entry.map(|(_, value)| *value)
}

fn name_of<T: Copy + PartialEq>(table: &[(&'static str, T)], value: T) -> &'static str {
    let entry = table.iter().find(|(_, v)| *v == value);
    entry.map_or("", |(name, _)| name)
}

/// The traversal that suits an encoding best.
const fn usual_traversal(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Tree => "ordered",
        Encoding::Lvsi(_) => "sung",
    }
}

impl Method {
    /// Every valid method, a grid of its own choice among them.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::Auto,
            Self::Brute,
            Self::Spheres,
            Self::Boxes,
            Self::Grid(None),
        ];
        for (_, encoding) in ENCODINGS {
            for (_, traversal) in TRAVERSALS {
                all.extend(MEMBERSHIPS.map(|(_, membership)| Self::Octree {
                    encoding,
                    traversal,
                    membership,
                }));
            }
        }
        all.retain(|method| method.objection().is_none());
        all
    }

    /// How space is divided; `None` where it is not.
    #[must_use]
    pub fn division(self) -> Option<Division> {
        match self {
            Self::Auto => Some(Division::default()),
            Self::Brute | Self::Spheres | Self::Boxes => None,
            Self::Grid(resolution) => Some(Division::Grid(resolution)),
            Self::Octree {
                encoding,
                traversal,
                ..
            } => Some(Division::Octree(encoding, traversal)),
        }
    }

    /// How it is decided which objects a cell touches.
    #[must_use]
    pub const fn membership(self) -> Membership {
        match self {
            Self::Octree { membership, .. } => membership,
            _ => Membership::Analytic,
        }
    }

    /// Why this combination makes no sense, if it does not. Any membership test goes with any
    /// octree.
    #[must_use]
    pub fn objection(self) -> Option<&'static str> {
        self.division().and_then(Division::objection)
    }
}

impl FromStr for Method {
    type Err = MethodError;

    fn from_str(text: &str) -> Result<Self, MethodError> {
        let unknown = || MethodError::Unknown(text.to_owned());
        let words: Vec<&str> = text.split(':').collect();
        let method = match words[..] {
            ["auto"] => Self::Auto,
            ["brute"] => Self::Brute,
            ["spheres"] => Self::Spheres,
            ["boxes"] => Self::Boxes,
            ["grid"] => Self::Grid(None),
            ["grid", resolution] => Self::Grid(Some(resolution.parse().map_err(|_| unknown())?)),
            ["octree", ref parts @ ..] if parts.len() <= 3 => {
                let word = |index: usize, usual| parts.get(index).copied().unwrap_or(usual);
                let encoding = named(&ENCODINGS, word(0, "tree")).ok_or_else(unknown)?;
                let traversal = word(1, usual_traversal(encoding));
                let membership = word(2, "analytic");
                Self::Octree {
                    encoding,
                    traversal: named(&TRAVERSALS, traversal).ok_or_else(unknown)?,
                    membership: named(&MEMBERSHIPS, membership).ok_or_else(unknown)?,
                }
            }
            _ => return Err(unknown()),
        };
        match method.objection() {
            Some(objection) => Err(MethodError::Senseless(text.to_owned(), objection)),
            None => Ok(method),
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Brute => f.write_str("brute"),
            Self::Spheres => f.write_str("spheres"),
            Self::Boxes => f.write_str("boxes"),
            Self::Grid(None) => f.write_str("grid"),
            Self::Grid(Some(n)) => write!(f, "grid:{n}"),
            Self::Octree {
                encoding,
                traversal,
                membership,
            } => {
                let encoding = name_of(&ENCODINGS, *encoding);
                let traversal = name_of(&TRAVERSALS, *traversal);
                let membership = name_of(&MEMBERSHIPS, *membership);
                write!(f, "octree:{encoding}:{traversal}:{membership}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_read_as_it_is_written() {
        let all = Method::all();
        assert_eq!(all.len(), 5 + (4 + 1 + 1) * 5);
        for method in all {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        let same = [
            ("octree", "octree:tree:ordered:analytic"),
            ("octree:lvsi", "octree:lvsi:sung:analytic"),
            ("octree:tree:beam", "octree:tree:beam:analytic"),
        ];
        for (short, long) in same {
            assert_eq!(short.parse(), long.parse::<Method>());
        }
        assert_eq!("grid:7".parse(), Ok(Method::Grid(Some(7))));
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_a_reason() {
        for name in [
            "octree:lvsi:ordered",
            "octree:lvsi:beam:shells",
            "octree:lvsi-empty:fujimoto-iwata",
            "grid:0",
            "grid:5000",
        ] {
            let error = name.parse::<Method>().expect_err(name);
            assert!(matches!(error, MethodError::Senseless(..)), "{error}");
            assert!(error.to_string().contains(name));
        }
        for name in [
            "",
            "bvh",
            "grid:x",
            "grid:-1",
            "octree:tree:ordered:more",
            "octree:tree:ordered:shells:5",
            "octree:hash",
            "brute:1",
            "Auto",
        ] {
            let error = name.parse::<Method>().expect_err(name);
            assert!(matches!(error, MethodError::Unknown(..)), "{name}");
        }
    }
}
