//! What a rendering cost, as a dictionary for the user and for `--json`.

use std::time::Duration;

use octray::render::{COST_WEIGHTS, RayCounts, RenderStats, Rendering};
use octray::world::Counters;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::structures;
use crate::world::Prepared;

pub(crate) fn rays<'py>(py: Python<'py>, counts: &RayCounts) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (kind, count) in counts.named() {
        dict.set_item(kind, count)?;
    }
    dict.set_item("total", counts.total())?;
    Ok(dict)
}

/// What one ray cost on average.
fn tests<'py>(py: Python<'py>, cost: &Counters, rays: u64) -> PyResult<Bound<'py, PyDict>> {
    let per_ray = |count: u64| count as f64 / rays.max(1) as f64;
    let dict = PyDict::new(py);
    dict.set_item("surfaces", per_ray(cost.surface_tests))?;
    dict.set_item("triangles", per_ray(cost.triangle_tests))?;
    dict.set_item("mailbox", per_ray(cost.mailbox))?;
    dict.set_item("cells", per_ray(cost.cells))?;
    dict.set_item("lookups", per_ray(cost.lookups))?;
    dict.set_item("nodes", per_ray(cost.nodes))?;
    dict.set_item("instances", per_ray(cost.instances))?;
    Ok(dict)
}

/// The same for each kind of ray, with how many rays there were.
fn tests_by_kind<'py>(py: Python<'py>, stats: &RenderStats) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for ((kind, cost), (_, rays)) in stats.queries.named().into_iter().zip(stats.rays.named()) {
        let kind_tests = tests(py, cost, *rays)?;
        kind_tests.set_item("rays", rays)?;
        dict.set_item(kind, kind_tests)?;
    }
    Ok(dict)
}

/// What the colours of a heat map mean.
pub(crate) fn heat_scale(py: Python<'_>, high: f64) -> PyResult<Bound<'_, PyDict>> {
    let weights = PyDict::new(py);
    let [step, surface, triangle] = COST_WEIGHTS.to_array();
    weights.set_item("step", step)?;
    weights.set_item("surface", surface)?;
    weights.set_item("triangle", triangle)?;
    let scale = PyDict::new(py);
    scale.set_item("weights", weights)?;
    scale.set_item("low", 0.0)?;
    scale.set_item("high", high)?;
    Ok(scale)
}

/// Seconds, rays, tests per ray, trees, memory; of a picture of costs, which cost is the hottest.
pub(crate) fn rendering(
    py: Python<'_>,
    rendering: &Rendering,
    prepared: &Prepared,
    render: Duration,
    threads: usize,
    hottest: Option<f64>,
) -> PyResult<Py<PyDict>> {
    let report = PyDict::new(py);
    let plan = &rendering.plan;
    report.set_item("size", plan.size)?;
    let crop = plan.crop;
    report.set_item(
        "crop",
        (crop.x, crop.y, crop.x + crop.width, crop.y + crop.height),
    )?;
    report.set_item("spp", plan.spp)?;
    report.set_item("max_depth", plan.max_generations)?;
    report.set_item("contribution_threshold", plan.contribution_threshold)?;
    report.set_item("threads", threads)?;
    report.set_item("complete", rendering.is_complete())?;
    report.set_item("finished_pixels", rendering.film.complete_pixels())?;

    let phases = PyDict::new(py);
    phases.set_item("build_s", prepared.duration.as_secs_f64())?;
    phases.set_item("render_s", render.as_secs_f64())?;
    report.set_item("phases", phases)?;

    let stats = &rendering.stats;
    report.set_item("rays", rays(py, &stats.rays)?)?;
    report.set_item("hits", rays(py, &stats.hits)?)?;
    let all = tests(py, &stats.queries.total(), stats.rays.total())?;
    report.set_item("tests_per_ray", all)?;
    report.set_item("tests_by_kind", tests_by_kind(py, stats)?)?;
    report.set_item("replaced_contributions", stats.replaced_contributions)?;
    report.set_item("ended_by_generation", stats.ended_by_generation)?;
    report.set_item("ended_by_contribution", stats.ended_by_contribution)?;

    report.set_item(
        "cost",
        hottest.map(|high| heat_scale(py, high)).transpose()?,
    )?;

    structures::add(py, &report, prepared)?;
    Ok(report.unbind())
}
