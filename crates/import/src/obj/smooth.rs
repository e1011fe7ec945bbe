//! Smoothing groups: normals for faces that have none of their own.

use std::collections::BTreeMap;

use octray_math::DVec3;

use super::syntax::{Face, Model, NONE};

/// Gives the corners of faces in a smoothing group, if they have no normals, the mean of the
/// normals of all faces of the group that meet in the vertex, weighted by area.
pub(super) fn apply(model: &mut Model) {
    let smooth = |face: &Face, corners: &[[u32; 3]]| {
        face.smoothing != 0 && corners.iter().any(|c| c[2] == NONE)
    };
    let mut index: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for face in &model.faces {
        let corners = &model.corners[face.corners.clone()];
        if !smooth(face, corners) {
            continue;
        }
        let outline: Vec<DVec3> = corners
            .iter()
            .map(|c| model.positions[c[0] as usize])
            .collect();
        let normal = vector_area(&outline);
        for corner in corners {
            let next = model.normals.len() as u32;
            let place = *index.entry((corner[0], face.smoothing)).or_insert(next);
            if place == next {
                model.normals.push(DVec3::ZERO);
            }
            model.normals[place as usize] += normal;
        }
    }
    for face in &model.faces {
        let corners = &mut model.corners[face.corners.clone()];
        if smooth(face, corners) {
            for corner in corners {
                corner[2] = index
                    .get(&(corner[0], face.smoothing))
                    .copied()
                    .unwrap_or(NONE);
            }
        }
    }
}

/// The normal of a polygon, twice its area long (Newell).
fn vector_area(outline: &[DVec3]) -> DVec3 {
    let Some(&origin) = outline.first() else {
        return DVec3::ZERO;
    };
    let next = outline.iter().cycle().skip(1);
    outline
        .iter()
        .zip(next)
        .map(|(a, b)| (*a - origin).cross(*b - origin))
        .sum()
}
