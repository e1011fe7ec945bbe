//! The triangles of a world that bound nothing: meshes as sheets.

use std::ops::Range;
use std::sync::Arc;

use octray_geometry::mesh::{
    NearestTriangle, Placement, SearchCost, SearchMemory, TriangleHit, TrianglePoint,
    TriangleQuery, TriangleSearch, TriangleTree,
};
use octray_geometry::{FaceId, MaterialId, SceneFrame, Sheet, TriangleMesh};
use octray_math::{DVec3, Interval};
use octray_scene::{ObjectId, Scene, Shape};
use octray_tree::WideTreeError;

use crate::figures::Held;
use crate::line::Line;
use crate::{Counters, Method, WorldConfig};

/// One mesh object's share of the triangles.
#[derive(Debug)]
struct Part {
    object: ObjectId,
    mesh: Arc<TriangleMesh>,
    placement: Placement,
    first_triangle: u32,
}

/// All triangles in the coordinates of the scene.
#[derive(Debug)]
pub(crate) struct Sheets {
    parts: Vec<Part>,
    triangles: TriangleTree,
    first_face: u32,
}

/// The nearest triangle on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SheetHit {
    pub(crate) s: f64,
    pub(crate) face: FaceId,
    pub(crate) entering: bool,
}

/// How a method finds the triangles of sheets.
fn search(config: &WorldConfig) -> TriangleSearch {
    let method = config.method;
    match (method, method.division()) {
        (Method::Auto, _) => TriangleSearch::Wide(config.triangles),
        (Method::Spheres, _) => TriangleSearch::Spheres,
        (Method::Boxes, _) => TriangleSearch::Boxes,
        (_, Some(division)) => TriangleSearch::Cells {
            division,
            table: config.table,
            membership: method.membership(),
            criteria: config.criteria,
        },
        (_, None) => TriangleSearch::All,
    }
}

impl Sheets {
    /// The mesh sheets of the scene; their triangles' faces are numbered from `first_face`.
    ///
    /// # Errors
    /// The wide octree would be too large.
    pub(crate) fn prepare(
        scene: &Scene,
        frame: &SceneFrame,
        first_face: u32,
        config: &WorldConfig,
    ) -> Result<Self, WideTreeError> {
        let mut parts = Vec::new();
        let mut positions = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        for (index, object) in scene.objects().iter().enumerate() {
            if let Shape::Sheet(Sheet::Mesh {
                mesh,
                world_from_mesh,
            }) = &object.shape
            {
                let placement = Placement::new(&(frame.scene_from_world() * **world_from_mesh));
                let first_vertex = positions.len() as u32;
                positions.extend(placement.positions(mesh));
                let first_triangle = triangles.len() as u32;
                let wound = mesh.triangles().iter().map(|&t| placement.wound(t));
                triangles.extend(wound.map(|t| t.map(|i| i + first_vertex)));
                parts.push(Part {
                    object: ObjectId(index as u32),
                    mesh: Arc::clone(mesh),
                    placement,
                    first_triangle,
                });
            }
        }
        let objects: Vec<u32> = parts.iter().map(|part| part.first_triangle).collect();
        let search = search(config);
        Ok(Self {
            parts,
            triangles: TriangleTree::new(positions, triangles, &objects, &search)?,
            first_face,
        })
    }

    /// The triangles with their octree or cells.
    pub(crate) const fn triangles(&self) -> &TriangleTree {
        &self.triangles
    }

    /// What an occupied cell over the triangles holds.
    pub(crate) fn held(&self, leaf: u32) -> Held {
        let listed = self.triangles.listed(leaf);
        let part = |&t: &u32| self.parts.partition_point(|p| p.first_triangle <= t);
        Held {
            objects: listed.chunk_by(|a, b| part(a) == part(b)).count() as u32,
            parts: listed.len() as u32,
        }
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    #[inline(always)]
    fn triangle(&self, face: FaceId) -> Option<u32> {
        let triangle = face.0.checked_sub(self.first_face)?;
        ((triangle as usize) < self.triangles.len()).then_some(triangle)
    }

    fn part(&self, triangle: u32) -> &Part {
        let next = self.parts.partition_point(|p| p.first_triangle <= triangle);
        &self.parts[next - 1]
    }

    /// The ids of an object's triangles.
    pub(crate) fn faces_of(&self, object: ObjectId) -> Range<u32> {
        let triangle = |part: usize| {
            let part = self.parts.get(part);
            let triangle = part.map_or(self.triangles.len() as u32, |p| p.first_triangle);
            self.first_face + triangle
        };
        match self.parts.binary_search_by_key(&object, |p| p.object) {
            Ok(part) => triangle(part)..triangle(part + 1),
            Err(_) => 0..0,
        }
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

    /// The search for the nearest triangle on a line, before `limit` or at it.
    #[inline(always)]
    pub(crate) fn query(&self, line: &Line, limit: f64) -> TriangleQuery {
        TriangleQuery {
            ray: line.ray,
            span: Interval::new(line.origin, limit.min(line.end)),
            departed: self.triangle(line.departure.face),
        }
    }

    /// What was found, as a face.
    pub(crate) const fn hit(&self, found: &NearestTriangle) -> SheetHit {
        SheetHit {
            s: found.t,
            face: FaceId(self.first_face + found.triangle),
            entering: found.entering,
        }
    }

    /// A crossing, as a face.
    pub(crate) const fn crossing(&self, triangle: u32, hit: &TriangleHit) -> SheetHit {
        SheetHit {
            s: hit.t,
            face: FaceId(self.first_face + triangle),
            entering: hit.entering,
        }
    }

    /// The nearest triangle on a line, before `limit` or at it.
    pub(crate) fn nearest(
        &self,
        line: &Line,
        limit: f64,
        memory: &mut SearchMemory,
        counters: &mut Counters,
    ) -> Option<SheetHit> {
        if self.triangles.is_empty() {
            return None;
        }
        let mut nearest = None;
        let query = self.query(line, limit);
        self.triangles
            .nearest(std::slice::from_ref(&query), memory, |_, found, cost| {
                nearest = found.map(|found| self.hit(&found));
                counters.add_search(&cost);
            });
        nearest
    }

    /// Tests the triangles near the line in `within`; `visit` returns the parameter beyond which
    /// nothing matters any more.
    pub(crate) fn visit_line(
        &self,
        line: &Line,
        limit: f64,
        memory: &mut SearchMemory,
        counters: &mut Counters,
        mut visit: impl FnMut(&SheetHit) -> f64,
    ) {
        if self.triangles.is_empty() {
            return;
        }
        let departed = self.triangle(line.departure.face);
        let span = Interval::new(line.origin, limit.min(line.end));
        let mut cost = SearchCost::default();
        self.triangles
            .closest(&line.ray, span, memory, &mut cost, |triangle, hit, end| {
                let left = |from| self.triangles.are_coplanar(from, triangle);
                if hit.t <= line.origin || departed.is_some_and(left) {
                    return end;
                }
                visit(&self.crossing(triangle, hit))
            });
        counters.add_search(&cost);
    }

    /// The unit normal of a triangle, zero if it has no area.
    pub(crate) fn normal(&self, face: FaceId) -> Option<DVec3> {
        let triangle = self.triangle(face)?;
        let part = self.part(triangle);
        part.placement
            .normal(&part.mesh, triangle - part.first_triangle)
    }

    /// Shading data of a triangle that the line crosses.
    pub(crate) fn point(&self, line: &Line, face: FaceId) -> Option<TrianglePoint> {
        let triangle = self.triangle(face)?;
        let part = self.part(triangle);
        part.placement
            .point(&part.mesh, triangle - part.first_triangle, &line.ray)
            .map(|(point, _)| point)
    }
}
