//! The world and its queries.

use std::sync::{Arc, Mutex, PoisonError};

use octray_geometry::FaceId;
use octray_geometry::mesh::{MeshError, TriangleMarks};
use octray_math::Aabb;
use octray_scene::{Scene, Shape};
use octray_tree::{
    Criteria, LvsiTable, PartitionStats, Tally, WideTreeConfig, WideTreeError, WideTreeStats,
};
use thiserror::Error;

use crate::instances::Instances;
use crate::line::{Line, Place};
use crate::sheets::{SheetHit, Sheets};
use crate::solids::{Interface, Scratch, Solids};
use crate::{
    CellList, CellListError, CellsOf, Counters, Departure, Hit, MarkingStats, MemoryStats, Method,
    RayQuery,
};

/// How to prepare a world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldConfig {
    /// How surfaces are found.
    pub method: Method,
    /// When to divide cells.
    pub criteria: Criteria,
    /// How large a hash table of cells is.
    pub table: LvsiTable,
    /// How to build the octrees over triangles.
    pub triangles: WideTreeConfig,
}

/// Why a scene cannot be made ready for rays.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum WorldError {
    /// A mesh operand has no inside.
    #[error("object `{object}`: {error}")]
    Mesh {
        /// The object's name.
        object: String,
        /// What is wrong with the mesh.
        error: MeshError,
    },
    /// The octree over the triangles of sheets would be too large.
    #[error(transparent)]
    Triangles(#[from] WideTreeError),
    /// The octree over the copies would be too large.
    #[error("instances: {0}")]
    Instances(WideTreeError),
    /// The list of cells cannot be used.
    #[error(transparent)]
    Cells(#[from] CellListError),
    /// Faces and triangles together outnumber their ids.
    #[error("the scene has more than 2^30 faces and triangles")]
    TooManyFaces,
}

/// A scene made ready for rays.
#[derive(Debug)]
pub struct World {
    pub(crate) scene: Arc<Scene>,
    pub(crate) solids: Solids,
    pub(crate) sheets: Sheets,
    pub(crate) instances: Instances,
    pub(crate) place: Place,
    /// For each material whether no light passes it.
    opaque: Vec<bool>,
    /// Whether every boundary is seen and stops light.
    all_blocks: bool,
    pub(crate) scratch: ScratchPool,
}

/// What was prepared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldStats {
    /// Objects of the scene.
    pub objects: usize,
    /// Distinct surfaces of solids.
    pub surfaces: usize,
    /// Faces that turned out to lie on another face's surface.
    pub merged_surfaces: usize,
    /// Faces of solids and triangles; of instances, those of one copy.
    pub faces: usize,
    /// Triangles of sheets; of instances, those of one copy.
    pub triangles: usize,
    /// Copies of prototypes.
    pub instances: usize,
    /// What they are copies of.
    pub prototypes: usize,
    /// The octree with wide nodes over the copies.
    pub instance_tree: Option<WideTreeStats>,
    /// The cells over the solids.
    pub cells: Option<PartitionStats>,
    /// How many objects the occupied cells over solids hold.
    pub objects_per_leaf: Tally,
    /// How cells were found to touch operands, where that was asked.
    pub marking: Option<MarkingStats>,
    /// Memory by part.
    pub memory: MemoryStats,
    /// The octree with wide nodes over the triangles of sheets.
    pub triangle_tree: Option<WideTreeStats>,
    /// The cells over the triangles of sheets.
    pub triangle_cells: Option<PartitionStats>,
    /// How many objects the occupied cells over triangles hold.
    pub objects_per_triangle_leaf: Tally,
    /// What decided which triangles those cells list, and how many they do.
    pub triangle_marks: Option<TriangleMarks>,
}

/// Working memory is handed from query to query instead of being made anew.
#[derive(Debug, Default)]
pub(crate) struct ScratchPool(Mutex<Vec<Scratch>>);

impl ScratchPool {
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut Scratch) -> R) -> R {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = lock().pop().unwrap_or_default();
        let result = work(&mut scratch);
        lock().push(scratch);
        result
    }
}

impl World {
    /// Builds the accelerators, inside the current thread pool. The result does not depend on the
    /// pool.
    ///
    /// # Errors
    /// See [`WorldError`].
    pub fn prepare(scene: Arc<Scene>, config: &WorldConfig) -> Result<Self, WorldError> {
        Self::make(scene, config, None)
    }

    /// Builds the octree over solids along a list of cells. Of the criteria only the limit of memory
    /// counts.
    ///
    /// # Errors
    /// Also where the list is of another scene or the method has no octree for it.
    pub fn prepare_from_cells(
        scene: Arc<Scene>,
        config: &WorldConfig,
        list: &CellList,
    ) -> Result<Self, WorldError> {
        Self::make(scene, config, Some(list))
    }

    /// The occupied cells of the octree over solids with the primitives that they touch; `None`
    /// where the method has no octree or there is nothing to make it over.
    #[must_use]
    pub fn cell_list(&self) -> Option<CellList> {
        self.solids.cell_list(&self.scene, &self.place.frame)
    }

    fn make(
        scene: Arc<Scene>,
        config: &WorldConfig,
        list: Option<&CellList>,
    ) -> Result<Self, WorldError> {
        check_face_count(&scene)?;
        // Of mesh operands; see `Method`.
        let triangles = match config.method {
            Method::Brute => None,
            _ => Some(&config.triangles),
        };
        let place = Place::new(&scene);
        let solids = Solids::prepare(&scene, &place.frame, config, list, triangles)?;
        let sheets = Sheets::prepare(&scene, &place.frame, solids.face_count(), config)?;
        let own_faces = solids.face_count() + sheets.triangle_count() as u32;
        let instances = Instances::prepare(&scene, &place.frame, own_faces, config)?;
        let opaque: Vec<bool> = scene
            .materials()
            .iter()
            .map(|m| !m.pigment.is_transparent())
            .collect();
        let all_blocks = solids.shows_all()
            && instances.is_empty()
            && !opaque.contains(&false)
            && scene.objects().iter().all(|object| object.casts_shadows);
        let scratch = ScratchPool::default();
        Ok(Self {
            scene,
            solids,
            sheets,
            instances,
            place,
            opaque,
            all_blocks,
            scratch,
        })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Whether any material lets light through.
    #[must_use]
    pub fn has_transparency(&self) -> bool {
        self.opaque.contains(&false)
    }

    /// A box around all bounded objects.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.scene.bounds()
    }

    /// Figures about what was built.
    #[must_use]
    pub fn stats(&self) -> WorldStats {
        let triangles = self.sheets.triangles();
        let with_prototypes = |figure: &dyn Fn(&Self) -> usize| -> usize {
            figure(self)
                + self
                    .instances
                    .prototypes()
                    .iter()
                    .map(figure)
                    .sum::<usize>()
        };
        WorldStats {
            objects: self.scene.objects().len(),
            surfaces: with_prototypes(&|world| world.solids.surface_count()),
            merged_surfaces: with_prototypes(&|world| world.solids.merged_surfaces()),
            faces: with_prototypes(&|world| world.own_face_count() as usize),
            triangles: with_prototypes(&|world| world.sheets.triangle_count()),
            instances: self.instances.len() as usize,
            prototypes: self.instances.prototypes().len(),
            instance_tree: self.instances.tree().map(|tree| *tree.stats()),
            cells: self.solids.partition().map(|cells| cells.stats().clone()),
            objects_per_leaf: self.objects_per_leaf(CellsOf::Solids),
            marking: self.solids.marking().copied(),
            memory: self.memory(),
            triangle_tree: self.sheets.triangles().tree_stats().copied(),
            triangle_cells: triangles.partition().map(|cells| cells.stats().clone()),
            objects_per_triangle_leaf: self.objects_per_leaf(CellsOf::Triangles),
            triangle_marks: triangles.marks().copied(),
        }
    }

    /// The built structures as words: equal for equal scenes, whatever built them.
    pub fn words(&self) -> Box<dyn Iterator<Item = u32> + '_> {
        let own = self.solids.words();
        let sheets = self.sheets.triangles().tree_words();
        // Prototypes are worlds, so that this is found within itself.
        Box::new(own.chain(sheets).chain(self.instances.words()))
    }

    pub(crate) fn closest_one(
        &self,
        query: &RayQuery,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Hit {
        match self.line(query, false) {
            Some(line) => self.closest_on_line(line, scratch, counters),
            None => Hit::MISS,
        }
    }

    /// The nearest surface on a half-line.
    #[inline]
    pub(crate) fn closest_on_line(
        &self,
        mut line: Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Hit {
        loop {
            match self.nearest(&line, scratch, counters) {
                None => return Hit::MISS,
                Some(found) if self.starts_on(&line, &found) => {
                    line = line.beyond(found.s);
                }
                Some(found) => return found.into_hit(&line),
            }
        }
    }

    fn nearest(
        &self,
        line: &Line,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let own = self.nearest_own(line, f64::INFINITY, scratch, counters);
        if !self.instances.is_empty() {
            return self.nearest_with_copies(line, own, scratch, counters);
        }
        self.with_regions(line, own?, scratch, counters)
    }

    /// The nearer of the nearest triangle of a sheet and the nearest boundary of a solid.
    pub(crate) fn with_solids(
        &self,
        line: &Line,
        sheet: Option<&SheetHit>,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let limit = sheet.map_or(f64::INFINITY, |hit| hit.s);
        // Their faces come first.
        let solid = self.nearest_solid(line, limit, scratch, counters);
        let found = solid.or_else(|| sheet.map(Interface::of_sheet))?;
        self.with_regions(line, found, scratch, counters)
    }

    /// The boundary with the regions on both sides.
    fn with_regions(
        &self,
        line: &Line,
        found: Interface,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        // Which space a sheet stands in matters only where light bends or fades.
        if self.has_transparency() && !self.solids.has(found.face) {
            let region = self.solids.region_at(line, found.s, scratch, counters);
            return Some(Interface {
                from: region,
                to: region,
                ..found
            });
        }
        Some(found)
    }

    /// The nearest boundary up to `limit`, copies aside; for a triangle of a sheet without regions.
    pub(crate) fn nearest_own(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        let best = self.nearest_solid(line, limit, scratch, counters);
        let limit = best.map_or(limit, |b| b.s);
        let sheet = self
            .sheets
            .nearest(line, limit, &mut scratch.triangles, counters)
            // Of equals the lower face.
            .filter(|hit| hit.s < line.end && best.is_none_or(|b| hit.s < b.s));
        sheet.map_or(best, |hit| Some(Interface::of_sheet(&hit)))
    }

    /// The nearest boundary of a solid before `limit` or at it.
    fn nearest_solid(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> Option<Interface> {
        if self.solids.face_count() == 0 {
            return None;
        }
        let mut best: Option<Interface> = None;
        self.solids
            .sweep_forward(line, limit, scratch, counters, |found| {
                let is_nearer = |found: &Interface| {
                    let (s, face) = (found.s, found.face);
                    s < line.end
                        && s <= limit
                        && best.is_none_or(|b| s < b.s || (s == b.s && face < b.face))
                };
                if let Some(found) = found.filter(is_nearer) {
                    best = Some(found);
                }
                best.map_or(limit, |b| b.s)
            });
        best
    }

    /// Visits all boundaries but those of copies, sheets first, in no order. `visit` returns the
    /// parameter beyond which nothing matters any more. Near the faces of cells some come twice.
    pub(crate) fn visit_own(
        &self,
        line: &Line,
        limit: f64,
        scratch: &mut Scratch,
        counters: &mut Counters,
        mut visit: impl FnMut(&Interface) -> f64,
    ) {
        let mut limit = limit;
        let memory = &mut scratch.triangles;
        self.sheets
            .visit_line(line, limit, memory, counters, |hit| {
                limit = visit(&Interface::of_sheet(hit));
                limit
            });
        if limit == f64::NEG_INFINITY || self.solids.face_count() == 0 {
            return;
        }
        self.solids
            .sweep_forward(line, limit, scratch, counters, |found| {
                if let Some(found) = found {
                    limit = visit(&found);
                }
                limit
            });
    }

    /// Whether any of the faces that count lies on the ray.
    pub(crate) fn meets_any(
        &self,
        query: &RayQuery,
        counts: &impl Fn(FaceId) -> bool,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        let line = self.line(query, false);
        line.is_some_and(|line| self.line_meets_any(&line, counts, scratch, counters))
    }

    /// Whether any of the faces that count lies on the half-line.
    #[inline]
    pub(crate) fn line_meets_any(
        &self,
        line: &Line,
        counts: &impl Fn(FaceId) -> bool,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        if self.instances.hide() {
            let mut hits = Vec::new();
            self.add_crossings(line, scratch, &mut hits, counters);
            return hits.iter().any(|hit| counts(hit.face));
        }
        let mut met = false;
        // Where a departure says what lies behind, every change ahead counts.
        if self.all_blocks && line.departure != Departure::NONE {
            let memory = &mut scratch.triangles;
            self.sheets
                .visit_line(line, f64::INFINITY, memory, counters, |hit| {
                    met |= hit.s < line.end;
                    if met {
                        f64::NEG_INFINITY
                    } else {
                        f64::INFINITY
                    }
                });
            return met || self.solids.changes(line, scratch, counters);
        }
        self.visit_own(line, f64::INFINITY, scratch, counters, |found| {
            met |= found.s < line.end && counts(found.face) && !self.starts_on(line, found);
            if met {
                f64::NEG_INFINITY
            } else {
                f64::INFINITY
            }
        });
        met || (!self.instances.is_empty() && self.line_meets_copy(line, counts, scratch, counters))
    }

    /// Whether any of the faces of solids that count lies on the half-line.
    pub(crate) fn line_meets_solid(
        &self,
        line: &Line,
        counts: &impl Fn(FaceId) -> bool,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) -> bool {
        if self.solids.face_count() == 0 {
            return false;
        }
        // Where a departure says what lies behind, every change ahead counts.
        if self.all_blocks && line.departure != Departure::NONE {
            return self.solids.changes(line, scratch, counters);
        }
        let mut met = false;
        self.solids
            .sweep_line(line, f64::INFINITY, scratch, counters, |change| {
                let counts = |found: &Interface| {
                    found.s < line.end && counts(found.face) && !self.starts_on(line, found)
                };
                met |= change.interface().as_ref().is_some_and(counts);
                if met {
                    f64::NEG_INFINITY
                } else {
                    f64::INFINITY
                }
            });
        met
    }

    /// Whether a face stops light.
    pub(crate) fn blocks(&self, face: FaceId) -> bool {
        self.owner(face).is_some_and(|(object, material)| {
            self.opaque[material.0 as usize]
                && self.scene.objects()[object.0 as usize].casts_shadows
        })
    }

    /// All boundaries that are seen on the ray, in order, where two solids touch one; with `whole_line` also those at `t <= 0`.
    ///
    /// `hits` is cleared first.
    pub fn crossings(
        &self,
        query: &RayQuery,
        whole_line: bool,
        hits: &mut Vec<Hit>,
        counters: &mut Counters,
    ) {
        hits.clear();
        counters.rays += 1;
        if let Some(line) = self.line(query, whole_line) {
            self.scratch
                .with(|scratch| self.add_crossings(&line, scratch, hits, counters));
        }
    }

    /// Adds the boundaries that are seen on a line to what is there.
    pub(crate) fn add_crossings(
        &self,
        line: &Line,
        scratch: &mut Scratch,
        hits: &mut Vec<Hit>,
        counters: &mut Counters,
    ) {
        let mut found: Vec<Interface> = Vec::new();
        self.solids
            .sweep_line(line, f64::INFINITY, scratch, counters, |change| {
                found.extend(change.interface());
                f64::INFINITY
            });
        let first_sheet = found.len();
        self.sheets.visit_line(
            line,
            f64::INFINITY,
            &mut scratch.triangles,
            counters,
            |hit| {
                found.push(Interface::of_sheet(hit));
                f64::INFINITY
            },
        );
        if self.instances.is_empty() {
            for sheet in &mut found[first_sheet..] {
                let region = self.solids.region_at(line, sheet.s, scratch, counters);
                (sheet.from, sheet.to) = (region, region);
            }
        } else {
            self.add_copies(line, &mut found, scratch, counters);
        }
        found.retain(|f| f.s < line.end);
        found.sort_by(|a, b| {
            let copies = (a.instance, a.face).cmp(&(b.instance, b.face));
            a.s.total_cmp(&b.s).then(copies)
        });
        // Cells overlap a little: what lies there was found twice.
        found.dedup_by_key(|f| (f.s, f.instance, f.face));
        let behind = found.iter().take_while(|f| self.starts_on(line, f)).count();
        hits.extend(found.drain(behind..).map(|f| f.into_hit(line)));
    }

    /// The query's line in the coordinates of the scene, `None` for a ray that meets nothing because
    /// it is none.
    #[inline(always)]
    pub(crate) fn line(&self, query: &RayQuery, whole: bool) -> Option<Line> {
        let line = Line::new(query, &self.place)?;
        Some(if whole { line.whole() } else { line })
    }

    /// Whether the ray is one: finite, with a direction. Others meet nothing.
    #[must_use]
    pub fn is_ray(&self, query: &RayQuery) -> bool {
        self.line(query, false).is_some()
    }
}

/// Whether the faces have ids enough, by an upper bound of their number.
pub(crate) fn check_face_count(scene: &Scene) -> Result<(), WorldError> {
    if faces(scene) > 1 << 30 {
        return Err(WorldError::TooManyFaces);
    }
    Ok(())
}

fn faces(scene: &Scene) -> u64 {
    scene.objects().iter().fold(0, |sum: u64, object| {
        sum.saturating_add(match &object.shape {
            Shape::Solid(solid) => solid.faces(),
            Shape::Sheet(sheet) => sheet.faces(),
            Shape::Instances(instances) => faces(instances.prototype().parts()),
        })
    })
}
