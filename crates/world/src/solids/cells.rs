//! What matters in a cell: every object's expression, reduced to the faces that pass through.

use octray_geometry::FaceId;
use octray_geometry::csg::{Code, Constant, Face, faces, truth_on};
use octray_geometry::mesh::MeshSolid;
use octray_geometry::surface::{Quadric, Side, Surface};
use octray_math::Aabb;
use octray_tree::{Cell, Subdivide};

use super::{MeshSurface, Ranked};

/// The contents of a cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Content {
    /// Objects whose boundary may pass through, by rank.
    pub(super) objects: Vec<Active>,
    /// 1 + the lowest rank among the solids that fill the cell, 0 for none.
    pub(super) base: u32,
}

/// An object with what is left of its expressions.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Active {
    pub(super) rank: u32,
    pub(super) expression: Code,
    /// The part of the boundary that counts; `None`: all of it.
    pub(super) clip: Option<Code>,
}

/// Restricts contents to cells.
pub(super) struct Cells<'a> {
    pub(super) faces: &'a [Face],
    pub(super) surfaces: &'a [Surface],
    pub(super) meshes: &'a [MeshSurface],
    pub(super) ranked: &'a [Ranked],
}

impl Cells<'_> {
    fn classify(&self, surface: u32, cell: &Aabb) -> Side {
        match self.surfaces.get(surface as usize) {
            Some(surface) => surface.classify(cell),
            None => self.mesh(surface).classify(cell),
        }
    }

    fn mesh(&self, surface: u32) -> &MeshSolid {
        &self.meshes[surface as usize - self.surfaces.len()].solid
    }

    /// The faces' surfaces, each once.
    fn surfaces_of(&self, content: &Content) -> Vec<u32> {
        let mut all: Vec<u32> = content
            .objects
            .iter()
            .flat_map(|o| {
                let clip = o.clip.iter().flat_map(|clip| faces(clip.words()));
                faces(o.expression.words()).chain(clip)
            })
            .map(|face| self.faces[face.0 as usize].surface.0)
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The work of crossing a surface, in planes.
    fn cost(&self, surface: u32) -> f64 {
        match self.surfaces.get(surface as usize) {
            Some(Surface::Plane { .. }) => 1.0,
            Some(Surface::Quadric {
                kind: Quadric::Sphere | Quadric::Cylinder,
                ..
            }) => 2.0,
            Some(Surface::Quadric {
                kind: Quadric::Cone,
                ..
            }) => 3.0,
            Some(Surface::Torus { .. }) => 15.0,
            None => 40.0,
        }
    }
}

impl Subdivide for Cells<'_> {
    type Content = Content;

    fn restrict(&self, parent: &Content, cell: &Aabb) -> Content {
        let surfaces = self.surfaces_of(parent);
        let sides: Vec<Side> = surfaces.iter().map(|&s| self.classify(s, cell)).collect();
        let mut truth = |face: FaceId| {
            let face = &self.faces[face.0 as usize];
            let at = surfaces.binary_search(&face.surface.0).ok()?;
            truth_on(sides[at], face.inside_is_positive)
        };
        let mut content = Content {
            objects: Vec::new(),
            base: parent.base,
        };
        for active in &parent.objects {
            let shell = self.ranked[active.rank as usize].shell;
            let expression = match active.expression.reduced(&mut truth) {
                Ok(expression) => expression,
                Err(Constant::True) if !shell => {
                    if content.base == 0 || active.rank + 1 < content.base {
                        content.base = active.rank + 1;
                    }
                    continue;
                }
                Err(_) => continue,
            };
            let clip = match active.clip.as_ref().map(|clip| clip.reduced(&mut truth)) {
                None | Some(Err(Constant::True)) => None,
                Some(Err(Constant::False)) => continue,
                Some(Ok(clip)) => Some(clip),
            };
            content.objects.push(Active {
                rank: active.rank,
                expression,
                clip,
            });
        }
        // What a higher priority fills hides the boundaries of all that have a lower one.
        if let Some(base) = content.base.checked_sub(1) {
            let hides = |rank: u32| {
                let object = &self.ranked[rank as usize];
                !object.shell && object.priority < self.ranked[base as usize].priority
            };
            content.objects.retain(|active| !hides(active.rank));
        }
        content
    }

    fn describe(&self, content: &Content) -> Cell {
        if content.objects.is_empty() {
            return Cell::Empty(content.base);
        }
        let cost = self
            .surfaces_of(content)
            .into_iter()
            .map(|s| self.cost(s))
            .sum();
        Cell::Occupied { cost }
    }

    fn bytes(&self, content: &Content) -> u64 {
        let words = |code: &Code| 4 * code.words().len() as u64;
        let object = |o: &Active| 20 + words(&o.expression) + o.clip.as_ref().map_or(0, words);
        20 + content.objects.iter().map(object).sum::<u64>()
            + 4 * self.surfaces_of(content).len() as u64
    }
}
