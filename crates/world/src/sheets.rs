//! The triangles of a world that bound nothing: meshes as sheets.

use std::sync::Arc;

use octray_geometry::mesh::{Placement, TrianglePoint, TriangleRay};
use octray_geometry::{FaceId, MaterialId, Sheet, TriangleMesh};
use octray_math::{Aabb, DVec3, Interval};
use octray_scene::{ObjectId, Scene, Shape};
use octray_tree::{WalkCost, WideTree, WideTreeConfig, WideTreeError, WideTreeStats};
use rayon::prelude::*;

use crate::Counters;
use crate::line::Line;

/// One mesh object's share of the triangles.
#[derive(Debug)]
struct Part {
    object: ObjectId,
    mesh: Arc<TriangleMesh>,
    placement: Placement,
    first_triangle: u32,
}

/// All triangles in world coordinates.
#[derive(Debug)]
pub(crate) struct Sheets {
    parts: Vec<Part>,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// `None` for brute force.
    tree: Option<WideTree>,
    first_face: u32,
}

/// The nearest triangle on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SheetHit {
    pub(crate) s: f64,
    pub(crate) face: FaceId,
    pub(crate) entering: bool,
}

impl Sheets {
    /// The mesh sheets of the scene; their triangles' faces are numbered from `first_face`. With
    /// `config` in an octree, else for brute force.
    ///
    /// # Errors
    /// The tree would not fit the memory limit.
    pub(crate) fn prepare(
        scene: &Scene,
        first_face: u32,
        config: Option<&WideTreeConfig>,
    ) -> Result<Self, WideTreeError> {
        let mut sheets = Self {
            parts: Vec::new(),
            positions: Vec::new(),
            triangles: Vec::new(),
            tree: None,
            first_face,
        };
        for (index, object) in scene.objects().iter().enumerate() {
            if let Shape::Sheet(Sheet::Mesh {
                mesh,
                world_from_mesh,
            }) = &object.shape
            {
                let placement = Placement::new(world_from_mesh);
                sheets.add(ObjectId(index as u32), mesh, placement);
            }
        }
        if let Some(config) = config {
            let box_of = |t: u32| Aabb::from_points(sheets.corners(t));
            let bounds: Vec<Aabb> = (0..sheets.triangles.len() as u32)
                .into_par_iter()
                .map(box_of)
                .collect();
            sheets.tree = Some(WideTree::build(&bounds, config)?);
        }
        Ok(sheets)
    }

    fn add(&mut self, object: ObjectId, mesh: &Arc<TriangleMesh>, placement: Placement) {
        let first_vertex = self.positions.len() as u32;
        self.positions.extend(placement.positions(mesh));
        let first_triangle = self.triangles.len() as u32;
        let wound = mesh.triangles().iter().map(|&t| placement.wound(t));
        self.triangles
            .extend(wound.map(|t| t.map(|i| i + first_vertex)));
        self.parts.push(Part {
            object,
            mesh: Arc::clone(mesh),
            placement,
            first_triangle,
        });
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    pub(crate) fn tree_stats(&self) -> Option<&WideTreeStats> {
        self.tree.as_ref().map(WideTree::stats)
    }

    /// The bytes of the tree, for hashing.
    pub(crate) fn bytes(&self) -> impl Iterator<Item = u8> + '_ {
        self.tree
            .iter()
            .flat_map(|tree| tree.bytes().into_iter().flatten().copied())
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    fn triangle(&self, face: FaceId) -> Option<u32> {
        let triangle = face.0.checked_sub(self.first_face)?;
        ((triangle as usize) < self.triangles.len()).then_some(triangle)
    }

    fn part(&self, triangle: u32) -> &Part {
        let next = self.parts.partition_point(|p| p.first_triangle <= triangle);
        &self.parts[next - 1]
    }

    /// Object and material of a triangle's face.
    pub(crate) fn owner(&self, face: FaceId, scene: &Scene) -> Option<(ObjectId, MaterialId)> {
        let triangle = self.triangle(face)?;
        let part = self.part(triangle);
        let own = part.mesh.materials();
        let own = own.map(|all| all[(triangle - part.first_triangle) as usize]);
        let object = &scene.objects()[part.object.0 as usize];
        Some((part.object, own.unwrap_or(object.material)))
    }

    /// Tests the triangles near the line in `within`; `visit` returns the parameter beyond which
    /// nothing matters any more.
    pub(crate) fn visit_line(
        &self,
        line: &Line,
        limit: f64,
        counters: &mut Counters,
        mut visit: impl FnMut(&SheetHit) -> f64,
    ) {
        if self.triangles.is_empty() {
            return;
        }
        let ray = TriangleRay::new(&line.ray);
        let departed = self.triangle(line.departure.face);
        let limit_before = limit.min(line.end);
        let mut limit = limit_before;
        let mut tests = 0;
        let mut test = |triangle: u32| {
            tests += 1;
            if departed == Some(triangle) {
                return limit;
            }
            if let Some(hit) = ray.intersect(self.corners(triangle))
                && hit.t > line.origin
                && hit.t <= limit
            {
                let face = FaceId(self.first_face + triangle);
                limit = limit.min(visit(&SheetHit {
                    s: hit.t,
                    face,
                    entering: hit.entering,
                }));
            }
            limit
        };
        match &self.tree {
            Some(tree) => {
                let mut cost = WalkCost::default();
                let span = Interval::new(line.origin, limit_before);
                tree.closest(&line.ray, span, &mut cost, |triangle, end| {
                    test(triangle).min(end)
                });
                counters.nodes += cost.nodes;
            }
            None => {
                for triangle in 0..self.triangles.len() as u32 {
                    test(triangle);
                }
            }
        }
        counters.triangle_tests += tests;
    }

    /// Shading data of a triangle that the line crosses.
    pub(crate) fn point(&self, line: &Line, face: FaceId) -> Option<TrianglePoint> {
        let triangle = self.triangle(face)?;
        let part = self.part(triangle);
        part.placement
            .point(&part.mesh, triangle - part.first_triangle, &line.ray)
    }
}
