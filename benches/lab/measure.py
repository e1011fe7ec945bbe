"""Runs one job through ``octray.lab`` and keeps of its report what the conclusions need."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from octray import lab
from octray.lab import machine
from results import Measured, Row

if TYPE_CHECKING:
    from pathlib import Path

    from plan import Job, Mode

#: What one method may take beyond its scene: this share of the free memory, or so much where the
#: system does not tell.
SHARE, UNKNOWN_BYTES = 0.5, 4 << 30


def measure(job: Job, path: Path, shapes: int, mode: Mode, budget: float) -> Measured:
    """Run the job on the scene in ``path``, in at most ``budget`` seconds."""
    free = machine.available_bytes()
    report = lab.run(
        path,
        accel=job.methods,
        repeat=job.repeat or mode.repeat,
        size=job.size or mode.size,
        tree=job.tree,
        memory=UNKNOWN_BYTES if free is None else int(SHARE * free),
        timeout=job.timeout,
        budget=budget,
    )
    if report.interrupted:
        raise KeyboardInterrupt
    rows = [
        row_of(combination.to_dict(), (combination.report or {}).get("trees", {}))
        for combination in report.combinations
    ]
    return Measured(
        job.experiment, job.scene, job.shapes, shapes, job.label, rows, report.reference
    )


def row_of(found: dict[str, Any], trees: dict[str, Any]) -> Row:
    """Take one method out of the lab's JSON object and what was told of its structures."""
    kept = [tree for tree in trees.values() if tree is not None]
    # Over solids; those over triangles are told of where there are no others.
    cells = next((tree for tree in kept if "node_bytes" in tree), {})
    return Row(
        method=found["method"],
        status=found["status"],
        message=found["message"],
        build_s=found["build"]["median_s"],
        render_s=found["render"]["median_s"],
        relative=found["render"]["relative"],
        bytes=found["memory"]["structure_bytes"],
        node_bytes=cells.get("node_bytes"),
        nodes=found["nodes"],
        depth=cells.get("depth"),
        leaf_depth=_mean_level(cells.get("occupied_by_depth") or []),
        objects_per_leaf=(cells.get("objects_per_leaf") or {}).get("mean"),
        marks=found["marks"],
        table=cells.get("lvsi"),
        rays=found["rays"],
        per_ray=found["per_ray"],
        per_ray_by_kind=_without_zeros(found["per_ray_by_kind"]),
        same=found["picture"]["same"],
    )


def _mean_level(counts: list[int]) -> float | None:
    total = sum(counts)
    return sum(level * n for level, n in enumerate(counts)) / total if total else None


def _without_zeros(by_kind: dict[str, dict[str, float]] | None) -> dict[str, dict[str, float]]:
    found = {kind: {k: v for k, v in costs.items() if v} for kind, costs in (by_kind or {}).items()}
    return {kind: costs for kind, costs in found.items() if costs}
