//! What is wrong with a mesh, and where.

use std::fmt;

use octray_math::DVec3;

/// One kind of fault. The order is that of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FlawKind {
    /// An edge of one triangle only: the rim of a hole.
    OpenEdge,
    /// An edge that its two triangles run along in the same direction: one is wound the wrong way.
    MisorientedEdge,
    /// An edge of three or more triangles, not as many in one direction as in the other.
    UnbalancedEdge,
    /// An edge of four or more triangles whose directions cancel.
    CrowdedEdge,
    /// Two triangles that cross.
    Crossing,
    /// Two triangles in one plane that overlap and face the same way.
    Overlap,
    /// Neighbours that lie upon one another with nothing between them.
    Fold,
    /// A shell whose inside is outside.
    InsideOut,
    /// A shell within another that faces the same way.
    Nested,
    /// So many triangles lie together that not all of them were looked at.
    Unchecked,
}

/// How many kinds there are.
const KINDS: usize = 10;
/// So many places are kept of each kind.
const KEPT: usize = 5;

impl FlawKind {
    const ALL: [Self; KINDS] = [
        Self::OpenEdge,
        Self::MisorientedEdge,
        Self::UnbalancedEdge,
        Self::CrowdedEdge,
        Self::Crossing,
        Self::Overlap,
        Self::Fold,
        Self::InsideOut,
        Self::Nested,
        Self::Unchecked,
    ];

    /// A short name, for programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OpenEdge => "open edge",
            Self::MisorientedEdge => "misoriented edge",
            Self::UnbalancedEdge => "unbalanced edge",
            Self::CrowdedEdge => "crowded edge",
            Self::Crossing => "crossing",
            Self::Overlap => "overlap",
            Self::Fold => "fold",
            Self::InsideOut => "inside out",
            Self::Nested => "nested",
            Self::Unchecked => "unchecked",
        }
    }

    /// `count` of them in words.
    fn counted(self, count: usize) -> String {
        let (one, many) = match self {
            Self::OpenEdge => ("open edge", "open edges"),
            Self::MisorientedEdge => (
                "edge whose two triangles are wound in opposite ways",
                "edges whose two triangles are wound in opposite ways",
            ),
            Self::UnbalancedEdge => (
                "edge of more than two triangles that do not cancel",
                "edges of more than two triangles that do not cancel",
            ),
            Self::CrowdedEdge => (
                "edge of more than two triangles",
                "edges of more than two triangles",
            ),
            Self::Crossing => ("crossing of triangles", "crossings of triangles"),
            Self::Overlap => (
                "pair of overlapping triangles",
                "pairs of overlapping triangles",
            ),
            Self::Fold => (
                "pair of triangles folded together",
                "pairs of triangles folded together",
            ),
            Self::InsideOut => ("shell inside out", "shells inside out"),
            Self::Nested => (
                "shell within another that faces the same way",
                "shells within others that face the same way",
            ),
            Self::Unchecked => ("crowd of triangles", "crowds of triangles"),
        };
        format!("{count} {}", if count == 1 { one } else { many })
    }
}

/// One fault and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Flaw {
    /// What is wrong.
    pub kind: FlawKind,
    /// Both ends of an edge; else one point where it is (up to rounding).
    pub places: Vec<DVec3>,
    /// The triangles that are involved, from 0, at most five; of a shell its first.
    pub triangles: Vec<u32>,
    /// Triangles in the shell, else how many are involved.
    pub extent: usize,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |i: usize| {
            let p = self.places.get(i).copied().unwrap_or_default();
            format!("({}, {}, {})", p.x, p.y, p.z)
        };
        let list: Vec<String> = self.triangles.iter().map(ToString::to_string).collect();
        let mut list = list.join(", ");
        if self.extent > self.triangles.len() {
            list += ", ...";
        }
        let (from, to) = (at(0), at(1));
        match self.kind {
            FlawKind::OpenEdge => write!(f, "only triangle {list} has the edge {from} to {to}"),
            FlawKind::MisorientedEdge => {
                write!(f, "triangles {list} both run from {from} to {to}")
            }
            FlawKind::UnbalancedEdge | FlawKind::CrowdedEdge => {
                write!(f, "triangles {list} share the edge {from} to {to}")
            }
            FlawKind::Crossing => write!(f, "triangles {list} cross at {from}"),
            FlawKind::Overlap => write!(f, "triangles {list} overlap at {from}"),
            FlawKind::Fold => write!(f, "triangles {list} are folded together at {from}"),
            FlawKind::InsideOut => write!(
                f,
                "the shell of {} triangles with {from} on triangle {} is inside out",
                self.extent, self.triangles[0]
            ),
            FlawKind::Nested => write!(
                f,
                "the shell of {} triangles with {from} on triangle {} lies within another that \
                 faces the same way (a cavity faces inwards)",
                self.extent, self.triangles[0]
            ),
            FlawKind::Unchecked => write!(
                f,
                "so many triangles lie together, at {from} for one, that not all were checked"
            ),
        }
    }
}

/// What [`TriangleMesh::check`](super::TriangleMesh::check) found.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Parts that hang together by edges of two triangles; 0 if the mesh is not closed.
    pub shells: usize,
    flaws: Vec<Flaw>,
    counts: [usize; KINDS],
}

impl MeshReport {
    pub(super) const fn new(triangles: usize) -> Self {
        Self {
            triangles,
            shells: 0,
            flaws: Vec::new(),
            counts: [0; KINDS],
        }
    }

    pub(super) fn add(&mut self, flaw: Flaw) {
        let count = &mut self.counts[flaw.kind as usize];
        *count += 1;
        if *count <= KEPT {
            self.flaws.push(flaw);
        }
    }

    /// How many faults of a kind there are.
    #[must_use]
    pub const fn count(&self, kind: FlawKind) -> usize {
        self.counts[kind as usize]
    }

    /// The kinds of faults there are, with their numbers.
    pub fn counts(&self) -> impl Iterator<Item = (FlawKind, usize)> + '_ {
        FlawKind::ALL
            .into_iter()
            .map(|kind| (kind, self.count(kind)))
            .filter(|(_, count)| *count > 0)
    }

    /// The first places of each kind.
    #[must_use]
    pub fn flaws(&self) -> &[Flaw] {
        &self.flaws
    }

    /// Whether every directed edge has its reverse, so that there is a winding number.
    #[must_use]
    pub const fn is_closed(&self) -> bool {
        self.count(FlawKind::OpenEdge) == 0
            && self.count(FlawKind::MisorientedEdge) == 0
            && self.count(FlawKind::UnbalancedEdge) == 0
            && self.triangles > 0
    }

    /// Whether nothing is wrong: the mesh is the boundary of a solid.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.triangles > 0 && self.counts().next().is_none()
    }

    /// Whether every rule gives the mesh the same inside if the direction of whole shells does not
    /// count: it is closed, and nothing crosses or overlaps.
    #[must_use]
    pub const fn is_unambiguous(&self) -> bool {
        self.is_closed()
            && self.count(FlawKind::Crossing) == 0
            && self.count(FlawKind::Overlap) == 0
            && self.count(FlawKind::Nested) == 0
            && self.count(FlawKind::Unchecked) == 0
    }
}

impl fmt::Display for MeshReport {
    /// Everything that was found, in one line: numbers, then about five places, of every kind at
    /// least one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<String> = self.counts().map(|(k, count)| k.counted(count)).collect();
        let each = (KEPT / numbers.len().max(1)).max(1);
        write!(f, "{}", numbers.join(", "))?;
        let mut separator = ": ";
        for (kind, _) in self.counts() {
            for flaw in self.flaws.iter().filter(|w| w.kind == kind).take(each) {
                write!(f, "{separator}{flaw}")?;
                separator = "; ";
            }
        }
        Ok(())
    }
}
