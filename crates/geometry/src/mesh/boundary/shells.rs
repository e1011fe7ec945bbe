//! Which way do shells face, and do any pass through each other along their edges?
//!
//! A shell that passes through nothing has the same winding number all along its front: 0 where it
//! faces outwards. Where an edge or a corner lies on another triangle the surfaces may touch or pass
//! through one another; if they do, the winding numbers in front of a shell differ from place to
//! place. So they are found, exactly, in front of triangles near such contacts.

use octray_math::DVec3;

use super::edges::Neighbours;
use super::exact_mesh::ExactMesh;
use super::pairs::Contacts;
use super::report::{Flaw, FlawKind, MeshReport};

/// Contacts looked at for each triangle.
const CONTACTS_PER_TRIANGLE: u8 = 2;
/// Triangles tried until one tells which way a shell faces.
const TRIALS: usize = 16;

/// A part of the mesh that hangs together by edges of two triangles.
#[derive(Clone, Default)]
struct Shell {
    first: Vec<u32>,
    triangles: usize,
    /// Whether it was found to cross something already.
    is_crossed: bool,
    /// The least and the greatest winding number in front of it, as far as is known.
    front: Option<(i64, i64)>,
}

impl Shell {
    fn see(&mut self, front: i64) {
        let (low, high) = self.front.unwrap_or((front, front));
        self.front = Some((low.min(front), high.max(front)));
    }

    /// Whether the winding number in front of it changes, so that it passes through something.
    fn passes_through(&self) -> bool {
        self.front.is_some_and(|(low, high)| low != high)
    }
}

/// Reports shells that face the wrong way and surfaces that cross along edges.
pub(super) fn check(
    mesh: &ExactMesh,
    edges: &Neighbours,
    contacts: &Contacts,
    report: &mut MeshReport,
) {
    let shell_of = shells(mesh, edges);
    let count = shell_of.iter().max().map_or(0, |&last| last as usize + 1);
    let mut shells = vec![Shell::default(); count];
    for (triangle, &shell) in shell_of.iter().enumerate() {
        let shell = &mut shells[shell as usize];
        shell.triangles += 1;
        if shell.first.len() < TRIALS {
            shell.first.push(triangle as u32);
        }
    }
    report.shells = count;
    for &triangle in &contacts.crossed {
        shells[shell_of[triangle as usize] as usize].is_crossed = true;
    }
    for shell in shells.iter_mut().filter(|shell| !shell.is_crossed) {
        let mut fronts = shell
            .first
            .iter()
            .map(|&t| front(mesh, t, centroid(mesh, t)));
        if let Some(front) = fronts.find_map(|front| front) {
            shell.see(front);
        }
    }
    let seen = look_at_contacts(mesh, contacts, &shell_of, &mut shells);
    for (index, front) in seen {
        let ([a, b], place) = contacts.touching[index];
        let [of_a, of_b] = [a, b].map(|t| &shells[shell_of[t as usize] as usize]);
        if front != 0 && (of_a.passes_through() || of_b.passes_through()) {
            report.add(Flaw {
                kind: FlawKind::Crossing,
                places: vec![mesh.unscaled(place)],
                triangles: vec![mesh.source(a), mesh.source(b)],
                extent: 2,
            });
        }
    }
    for shell in shells
        .iter()
        .filter(|s| !s.is_crossed && !s.passes_through())
    {
        let kind = match shell.front {
            Some((front, _)) if front < 0 => FlawKind::InsideOut,
            Some((front, _)) if front > 0 => FlawKind::Nested,
            _ => continue,
        };
        report.add(Flaw {
            kind,
            places: vec![mesh.unscaled(mesh.corners(shell.first[0])[0])],
            triangles: vec![mesh.source(shell.first[0])],
            extent: shell.triangles,
        });
    }
}

/// For every contact of shells that cross nothing so far the winding number in front of one of the
/// two triangles near it; 0 if that of both is.
fn look_at_contacts(
    mesh: &ExactMesh,
    contacts: &Contacts,
    shell_of: &[u32],
    shells: &mut [Shell],
) -> Vec<(usize, i64)> {
    let mut looked_at = vec![0_u8; shell_of.len()];
    let mut seen = Vec::new();
    for (index, &(pair, place)) in contacts.touching.iter().enumerate() {
        let crossed = |t: u32| shells[shell_of[t as usize] as usize].is_crossed;
        if pair.into_iter().any(crossed) {
            continue;
        }
        let mut here = 0;
        for triangle in pair {
            let times = &mut looked_at[triangle as usize];
            if *times == CONTACTS_PER_TRIANGLE {
                continue;
            }
            *times += 1;
            let middle = centroid(mesh, triangle);
            // A little way in from the contact.
            let beside = place + (middle - place) * 0.0625;
            if let Some(front) = front(mesh, triangle, beside) {
                shells[shell_of[triangle as usize] as usize].see(front);
                here = if here == 0 { front } else { here };
            }
        }
        seen.push((index, here));
    }
    seen
}

/// The number of each triangle's shell.
fn shells(mesh: &ExactMesh, edges: &Neighbours) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..mesh.len()).collect();
    let root = |parent: &mut [u32], mut t: u32| {
        while parent[t as usize] != t {
            parent[t as usize] = parent[parent[t as usize] as usize];
            t = parent[t as usize];
        }
        t
    };
    for &[a, b] in &edges.0 {
        // A triangle without area connects those beside it, but has no sides: it is left out. What
        // hung together by it alone counts as two shells, each of which is right or wrong.
        let (Some(a), Some(b)) = (mesh.of_source(a), mesh.of_source(b)) else {
            continue;
        };
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b) as usize] = a.min(b);
    }
    let mut numbers = vec![0; parent.len()];
    let mut next = 0;
    for triangle in 0..mesh.len() {
        let first = root(&mut parent, triangle);
        numbers[triangle as usize] = if first == triangle {
            next += 1;
            next - 1
        } else {
            numbers[first as usize]
        };
    }
    numbers
}

fn centroid(mesh: &ExactMesh, triangle: u32) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    a / 3.0 + b / 3.0 + c / 3.0
}

/// The winding number in front of a triangle near a point of it, if it is one more behind (which it
/// is not where another triangle lies upon it).
fn front(mesh: &ExactMesh, triangle: u32, at: DVec3) -> Option<i64> {
    if mesh.is_exhausted() {
        return None;
    }
    let [back, front] = mesh
        .beside(triangle, at)
        .map(|point| mesh.winding_number(point?));
    let (back, front) = (back?, front?);
    (back == front + 1).then_some(front)
}
