//! The methods by which rays find surfaces, by name.

use std::fmt;
use std::str::FromStr;

use octray_tree::{Division, Encoding, LvsiStore, Traversal};
use thiserror::Error;

/// How the surfaces on a ray are found. The answers are the same bits.
///
/// Written `auto | brute | spheres | boxes | grid[:N] | octree[:ENCODING[:TRAVERSAL]]` with the
/// encodings `tree`, `lvsi`, `lvsi-empty` and the traversals `ordered`, `sung`, `fujimoto-iwata`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accel {
    /// The fastest: an octree over the solids, one with wide nodes over the triangles.
    #[default]
    Auto,
    /// Every surface is tested with every ray: the oracle.
    Brute,
    /// A sphere around every object is tested first.
    Spheres,
    /// A box around every object is tested first.
    Boxes,
    /// Space is divided.
    Cells(Division),
}

/// Why a name is not that of a method.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum AccelError {
    /// A word that no method has.
    #[error(
        "`{0}` is no method: use auto, brute, spheres, boxes, grid[:N] or octree[:ENCODING[:TRAVERSAL]] with the encodings tree, lvsi, lvsi-empty and the traversals ordered, sung, fujimoto-iwata"
    )]
    Unknown(String),
    /// A combination that cannot work.
    #[error("`{0}`: {1}")]
    Senseless(String, &'static str),
}

const ENCODINGS: [(&str, Encoding); 3] = [
    ("tree", Encoding::Tree),
    ("lvsi", Encoding::Lvsi(LvsiStore::Occupied)),
    ("lvsi-empty", Encoding::Lvsi(LvsiStore::All)),
];

const TRAVERSALS: [(&str, Traversal); 3] = [
    ("ordered", Traversal::Ordered),
    ("sung", Traversal::Sung),
    ("fujimoto-iwata", Traversal::FujimotoIwata),
];

fn named<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    table
        .iter()
        .find(|(n, _)| *n == name)
        .map(|(_, value)| *value)
}

fn name_of<T: Copy + PartialEq>(table: &[(&'static str, T)], value: T) -> &'static str {
    table
        .iter()
        .find(|(_, v)| *v == value)
        .map_or("", |(name, _)| name)
}

impl Accel {
    /// Every valid method, a grid of its own choice among them.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let octrees = ENCODINGS.iter().flat_map(|(_, encoding)| {
            TRAVERSALS.map(|(_, traversal)| Division::Octree(*encoding, traversal))
        });
        let divisions = octrees.chain([Division::Grid(None)]);
        let valid = divisions.filter(|division| division.objection().is_none());
        [Self::Auto, Self::Brute, Self::Spheres, Self::Boxes]
            .into_iter()
            .chain(valid.map(Self::Cells))
            .collect()
    }
}

impl FromStr for Accel {
    type Err = AccelError;

    fn from_str(text: &str) -> Result<Self, AccelError> {
        let unknown = || AccelError::Unknown(text.to_owned());
        let mut words = text.split(':');
        let method = match (words.next(), words.next(), words.next()) {
            (Some("auto"), None, None) => Self::Auto,
            (Some("brute"), None, None) => Self::Brute,
            (Some("spheres"), None, None) => Self::Spheres,
            (Some("boxes"), None, None) => Self::Boxes,
            (Some("grid"), resolution, None) => {
                let resolution = resolution.map(str::parse).transpose();
                Self::Cells(Division::Grid(resolution.map_err(|_| unknown())?))
            }
            (Some("octree"), encoding, traversal) => {
                let encoding = named(&ENCODINGS, encoding.unwrap_or("tree")).ok_or_else(unknown)?;
                // What each encoding is best walked by.
                let usual = match encoding {
                    Encoding::Tree => "ordered",
                    Encoding::Lvsi(_) => "sung",
                };
                let traversal =
                    named(&TRAVERSALS, traversal.unwrap_or(usual)).ok_or_else(unknown)?;
                Self::Cells(Division::Octree(encoding, traversal))
            }
            _ => return Err(unknown()),
        };
        if words.next().is_some() {
            return Err(unknown());
        }
        match method {
            Self::Cells(division) => match division.objection() {
                Some(objection) => Err(AccelError::Senseless(text.to_owned(), objection)),
                None => Ok(method),
            },
            _ => Ok(method),
        }
    }
}

impl fmt::Display for Accel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Brute => f.write_str("brute"),
            Self::Spheres => f.write_str("spheres"),
            Self::Boxes => f.write_str("boxes"),
            Self::Cells(Division::Grid(None)) => f.write_str("grid"),
            Self::Cells(Division::Grid(Some(n))) => write!(f, "grid:{n}"),
            Self::Cells(Division::Octree(encoding, traversal)) => {
                let encoding = name_of(&ENCODINGS, *encoding);
                write!(f, "octree:{encoding}:{}", name_of(&TRAVERSALS, *traversal))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_read_as_it_is_written() {
        let all = Accel::all();
        assert_eq!(all.len(), 4 + 5 + 1);
        for method in all {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        assert_eq!("octree".parse(), "octree:tree:ordered".parse::<Accel>());
        assert_eq!("octree:lvsi".parse(), "octree:lvsi:sung".parse::<Accel>());
        assert_eq!("grid:7".parse(), Ok(Accel::Cells(Division::Grid(Some(7)))));
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_a_reason() {
        for name in [
            "octree:lvsi:ordered",
            "octree:lvsi-empty:fujimoto-iwata",
            "grid:0",
            "grid:5000",
        ] {
            let error = name.parse::<Accel>().expect_err(name);
            assert!(matches!(error, AccelError::Senseless(..)), "{error}");
            assert!(error.to_string().contains(name));
        }
        for name in [
            "",
            "bvh",
            "grid:x",
            "grid:-1",
            "octree:tree:ordered:more:5",
            "octree:hash",
            "brute:1",
            "Auto",
        ] {
            let error = name.parse::<Accel>().expect_err(name);
            assert!(matches!(error, AccelError::Unknown(..)), "{name}");
        }
    }
}
