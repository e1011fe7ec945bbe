//! Faces that all look out, or all look in.

/// What [`orient`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Orientation {
    /// Every edge runs as often one way as the other.
    Consistent,
    /// Some faces had to be turned round for that.
    Repaired,
    /// An edge has not two faces, or the surface has one side only; nothing was changed.
    Impossible,
}

/// One use of an edge by a face: its ends in ascending order, the face, and whether the face runs
/// from the lower to the higher.
type Use = (u32, u32, usize, bool);

/// Turns faces round until neighbours agree.
///
/// Of each connected part the majority of faces keeps its direction. Faces list corner indices.
pub(super) fn orient(faces: &mut [Vec<u32>]) -> Orientation {
    let mut uses: Vec<Use> = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        for (&a, &b) in face.iter().zip(face.iter().cycle().skip(1)) {
            uses.push((a.min(b), a.max(b), index, a < b));
        }
    }
    uses.sort_unstable();
    let edges = || uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    let balanced = |edge: &[Use]| 2 * edge.iter().filter(|u| u.3).count() == edge.len();
    if edges().all(balanced) {
        return Orientation::Consistent;
    }
    if edges().any(|edge| edge.len() != 2) {
        return Orientation::Impossible;
    }
    // For each face its neighbours, and whether they run against each other as they should.
    let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); faces.len()];
    for edge in edges() {
        let (one, other) = (edge[0], edge[1]);
        neighbours[one.2].push((other.2, one.3 != other.3));
        neighbours[other.2].push((one.2, one.3 != other.3));
    }
    let Some(turned) = two_colouring(&neighbours) else {
        return Orientation::Impossible;
    };
    for (face, turn) in faces.iter_mut().zip(turned) {
        if turn {
            face.reverse();
        }
    }
    Orientation::Repaired
}

/// Which faces to turn, at most half of each connected part; `None` if that cannot be decided.
fn two_colouring(neighbours: &[Vec<(usize, bool)>]) -> Option<Vec<bool>> {
    let mut turned: Vec<Option<bool>> = vec![None; neighbours.len()];
    for start in 0..neighbours.len() {
        if turned[start].is_some() {
            continue;
        }
        turned[start] = Some(false);
        let mut part = vec![(start, false)];
        let mut done = 0;
        while done < part.len() {
            let (face, turn) = part[done];
            done += 1;
            for &(other, agree) in &neighbours[face] {
                let wanted = turn == agree;
                match turned[other] {
                    None => {
                        turned[other] = Some(wanted);
                        part.push((other, wanted));
                    }
                    Some(found) if found != wanted => return None,
                    Some(_) => {}
                }
            }
        }
        if 2 * part.iter().filter(|(_, turn)| *turn).count() > part.len() {
            for (face, turn) in part {
                turned[face] = Some(!turn);
            }
        }
    }
    turned.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Vec<Vec<u32>> {
        vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]]
    }

    #[test]
    fn a_consistent_surface_stays() {
        let mut faces = tetrahedron();
        assert_eq!(orient(&mut faces), Orientation::Consistent);
        assert_eq!(faces, tetrahedron());
    }

    #[test]
    fn the_minority_is_turned() {
        for wrong in 0..4 {
            let mut faces = tetrahedron();
            faces[wrong].reverse();
            assert_eq!(orient(&mut faces), Orientation::Repaired);
            assert_eq!(faces, tetrahedron());
        }
    }

    #[test]
    fn open_and_one_sided_surfaces_are_impossible() {
        assert_eq!(orient(&mut tetrahedron()[..3]), Orientation::Impossible);
        // The projective plane of 6 corners and 10 triangles: closed, but with one side.
        let mut plane: Vec<Vec<u32>> = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ]
        .map(|f| f.to_vec())
        .to_vec();
        let before = plane.clone();
        assert_eq!(orient(&mut plane), Orientation::Impossible);
        assert_eq!(plane, before);
    }
}
