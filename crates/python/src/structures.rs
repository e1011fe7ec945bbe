//! Figures about what was built, as dictionaries.
//!
//! `trees.cells`, `trees.triangles` and `trees.wide` are about the cells over solids, those over the
//! triangles of sheets, where each triangle is a part, and the wide tree over these, and
//! `trees.instances` about the wide tree over copies of prototypes; `None` where the method has none. Of a grid, cells are voxels, at depth 0. `triangle_cube` says of cells over
//! triangles how many `questions` were asked while they were divided, which of the `steps` of the
//! triangle-cube test decided how many, how many `references` to triangles the cells keep, and how
//! many the fullest (`most`).
//!
//! | `trees.cells`, `trees.triangles` | |
//! |---|---|
//! | `empty`, `occupied`, `divided` | how many cells there are of each kind |
//! | `depth`, `empty_by_depth`, `occupied_by_depth` | of the deepest cell; leaves of each depth |
//! | `objects_per_leaf`, `parts_per_leaf` | of occupied cells, the number of objects and of surfaces (or triangles): `mean`, `max`, and `counts`, a list of `[number, cells]` |
//! | `bytes`, `node_bytes`, `peak_bytes` | of cells with their contents, of cells alone as they are kept, and the most while building |
//! | `stopped_by_depth`, `stopped_by_size`, `stopped_by_memory` | cells left undivided because of a limit, and whether it was the memory limit; of a grid, whether its voxels are larger than asked for |
//! | `resolution` | of a grid, voxels on each axis |
//! | `lvsi` | of a hash table, `leaves` stored, `rows` used, `table_size`, `heads_used`, `longest_chain`, `bytes`, `bytes_per_leaf` |
//!
//! `trees.membership` is of the test by which octrees of solids were built: how many `operands` it had,
//! the `pieces` made for them, `peak_bytes` of these and the `bytes` left after the build, the
//! `chord_error` of shells, the `steps` that decided, and `marks`, pairs of a cell and an operand.
//!
//! `memory` is bytes by part (see `octray::world::MemoryStats`), their `total`, and `peak_bytes` of the
//! process, where the system tells.

use octray::world::{
    LvsiStats, MarkerStats, MarkingStats, MemoryStats, PartitionStats, Tally, TriangleMarks,
    WideTreeStats, WorldStats,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::world::Prepared;

fn tally<'py>(py: Python<'py>, numbers: &Tally) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("mean", numbers.mean())?;
    dict.set_item("max", numbers.max())?;
    let counts: Vec<[u64; 2]> = numbers.counts().map(Into::into).collect();
    dict.set_item("counts", counts)?;
    Ok(dict)
}

fn lvsi<'py>(py: Python<'py>, stats: &LvsiStats) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("leaves", stats.leaves)?;
    dict.set_item("rows", stats.rows)?;
    dict.set_item("table_size", stats.table_size)?;
    dict.set_item("heads_used", stats.heads_used)?;
    dict.set_item("longest_chain", stats.longest_chain)?;
    dict.set_item("bytes", stats.bytes)?;
    let per_leaf = stats.bytes as f64 / stats.leaves.max(1) as f64;
    dict.set_item("bytes_per_leaf", per_leaf)?;
    Ok(dict)
}

fn cells<'py>(
    py: Python<'py>,
    stats: &PartitionStats,
    objects: &Tally,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let cells = &stats.cells;
    dict.set_item("empty", cells.empty)?;
    dict.set_item("occupied", cells.occupied)?;
    dict.set_item("divided", cells.divided)?;
    dict.set_item("depth", cells.depth)?;
    dict.set_item("empty_by_depth", &cells.empty_by_depth)?;
    dict.set_item("occupied_by_depth", &cells.occupied_by_depth)?;
    dict.set_item("objects_per_leaf", tally(py, objects)?)?;
    dict.set_item("parts_per_leaf", tally(py, &cells.parts)?)?;
    dict.set_item("bytes", cells.bytes)?;
    dict.set_item("node_bytes", cells.node_bytes)?;
    dict.set_item("peak_bytes", cells.peak_bytes)?;
    dict.set_item("stopped_by_depth", cells.stopped_by_depth)?;
    dict.set_item("stopped_by_size", cells.stopped_by_size)?;
    dict.set_item("stopped_by_memory", cells.stopped_by_memory)?;
    dict.set_item("resolution", stats.resolution)?;
    dict.set_item(
        "lvsi",
        stats.lvsi.as_ref().map(|s| lvsi(py, s)).transpose()?,
    )?;
    Ok(dict)
}

fn wide<'py>(py: Python<'py>, stats: &WideTreeStats) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("items", stats.items)?;
    dict.set_item("references", stats.references)?;
    dict.set_item("nodes", stats.nodes)?;
    dict.set_item("leaves", stats.leaves)?;
    dict.set_item("depth", stats.depth)?;
    dict.set_item("bytes", stats.bytes)?;
    Ok(dict)
}

fn memory<'py>(py: Python<'py>, stats: &MemoryStats) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("peak_bytes", peak_bytes())?;
    dict.set_item("cells", stats.cells)?;
    dict.set_item("contents", stats.contents)?;
    dict.set_item("expressions", stats.expressions)?;
    dict.set_item("surfaces", stats.surfaces)?;
    dict.set_item("faces", stats.faces)?;
    dict.set_item("triangles", stats.triangles)?;
    dict.set_item("triangle_cells", stats.triangle_cells)?;
    dict.set_item("wide_trees", stats.wide_trees)?;
    dict.set_item("instances", stats.instances)?;
    dict.set_item("total", stats.total())?;
    dict.set_item("building", stats.building)?;
    Ok(dict)
}

/// The most memory this process has had so far, where the system tells.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

fn world<'py>(py: Python<'py>, stats: &WorldStats) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("objects", stats.objects)?;
    dict.set_item("surfaces", stats.surfaces)?;
    dict.set_item("merged_surfaces", stats.merged_surfaces)?;
    dict.set_item("faces", stats.faces)?;
    dict.set_item("triangles", stats.triangles)?;
    dict.set_item("instances", stats.instances)?;
    dict.set_item("prototypes", stats.prototypes)?;
    Ok(dict)
}

fn triangle_cube<'py>(py: Python<'py>, marks: &TriangleMarks) -> PyResult<Bound<'py, PyDict>> {
    let steps = PyDict::new(py);
    for (name, count) in ["vertex", "face", "edge", "diagonal"]
        .into_iter()
        .zip(marks.steps)
    {
        steps.set_item(name, count)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("questions", marks.questions)?;
    dict.set_item("steps", steps)?;
    dict.set_item("references", marks.references)?;
    dict.set_item("most", marks.most)?;
    Ok(dict)
}

fn membership<'py>(py: Python<'py>, marking: &MarkingStats) -> PyResult<Bound<'py, PyDict>> {
    let MarkerStats {
        operands,
        pieces,
        piece_bytes,
        chord_error,
        steps: decided,
    } = marking.marker;
    let steps = PyDict::new(py);
    steps.set_item("vertex", decided.vertex)?;
    steps.set_item("face", decided.face)?;
    steps.set_item("edge", decided.edge)?;
    steps.set_item("diagonal", decided.diagonal)?;
    steps.set_item("between", decided.between)?;
    let dict = PyDict::new(py);
    dict.set_item("operands", operands)?;
    dict.set_item("pieces", pieces)?;
    dict.set_item("peak_bytes", piece_bytes)?;
    dict.set_item("bytes", marking.pieces_left)?;
    dict.set_item("chord_error", chord_error)?;
    dict.set_item("steps", steps)?;
    dict.set_item("marks", marking.marks)?;
    Ok(dict)
}

/// Adds `trees`, `memory` and `world` to a report.
pub(crate) fn add(py: Python<'_>, report: &Bound<'_, PyDict>, prepared: &Prepared) -> PyResult<()> {
    let stats = prepared.world.stats();
    let trees = PyDict::new(py);
    let over_solids = stats.cells.as_ref();
    let over_solids = over_solids.map(|s| cells(py, s, &stats.objects_per_leaf));
    trees.set_item("cells", over_solids.transpose()?)?;
    let over_triangles = stats.triangle_cells.as_ref();
    let over_triangles = over_triangles.map(|s| cells(py, s, &stats.objects_per_triangle_leaf));
    trees.set_item("triangles", over_triangles.transpose()?)?;
    let over_triangles = stats.triangle_tree.as_ref();
    trees.set_item("wide", over_triangles.map(|s| wide(py, s)).transpose()?)?;
    let over_copies = stats.instance_tree.as_ref();
    trees.set_item("instances", over_copies.map(|s| wide(py, s)).transpose()?)?;
    let marking = stats.marking.as_ref();
    trees.set_item(
        "membership",
        marking.map(|m| membership(py, m)).transpose()?,
    )?;
    report.set_item("trees", trees)?;
    let marks = stats.triangle_marks.as_ref();
    let marks = marks.map(|m| triangle_cube(py, m)).transpose()?;
    report.set_item("triangle_cube", marks)?;
    report.set_item("memory", memory(py, &stats.memory)?)?;
    report.set_item("world", world(py, &stats)?)
}

/// The figures alone, with the method's full name and the seconds that building took.
pub(crate) fn stats<'py>(py: Python<'py>, prepared: &Prepared) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("method", prepared.method.to_string())?;
    dict.set_item("build_s", prepared.duration.as_secs_f64())?;
    add(py, &dict, prepared)?;
    Ok(dict)
}
