"""The page's tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import comparison as c
from plan import CONTROL, LVSI, LVSI_EMPTY, ORDERED

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from results import Measured, Results, Row

    Show = Callable[[Measured, Row], str | None]


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """A table whose first columns are text and whose others are numbers."""
    lines = ["| " + " | ".join(head) + " |"]
    lines.append("|" + "---|" * left + "--:|" * (len(head) - left))
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def scenes(results: Results) -> str:
    """Every scene with its picture."""
    rows = []
    for scene in results.scenes:
        if scene.shapes is None:
            rows.append([scene.title, f"{scene.what}; {scene.absent}", c.ABSENT, ""])
            continue
        picture = f'<img src="{scene.name}.png" alt="{scene.title}" width="160">'
        rows.append([scene.title, scene.what, f"{scene.shapes:,}", picture])
    return markdown(["scene", "what it is", "shapes", "picture"], rows, left=2)


def _by_scene(results: Results, show: Show) -> str:
    """Methods by scenes, for the comparison; those that have nothing to show are left out."""
    runs = list(results.of("comparison"))
    names: dict[str, None] = {}
    for run in runs:
        names.update(dict.fromkeys(row.method for row in run.rows))
    rows = []
    for name in names:
        cells = []
        for run in runs:
            row = run.row(name)
            value = None if row is None else show(run, row)
            cells.append(value or c.ABSENT)
        if any(cell not in ("0", c.ABSENT) for cell in cells):
            rows.append([f"`{name}`", *cells])
    return markdown(["method", *(run.scene for run in runs)], rows)


def time(results: Results) -> str:
    """Time of a picture against the fastest on the scene."""

    def show(run: Measured, row: Row) -> str | None:
        all_of_them = [_time(r) for r in run.rows if r.done]
        known = [t for t in all_of_them if t is not None]
        mine = _time(row)
        if mine is None:
            return None
        text = c.times(mine / min(known))
        return f"**{text}**" if mine == min(known) else text

    return _by_scene(results, show)


def _time(row: Row) -> float | None:
    return row.render_s if row.relative is None else row.relative


def quantity(results: Results, of: c.Quantity, text: Callable[[float], str] = c.short) -> str:
    """One number for every method and scene."""

    def show(_run: Measured, row: Row) -> str | None:
        value = of(row)
        return None if value is None else text(value)

    return _by_scene(results, show)


def growth(results: Results, scene: str, of: c.Quantity, text: Callable[[float], str]) -> str:
    """Methods by sizes, for one scene."""
    runs = list(results.of("growth", scene))
    names = dict.fromkeys(row.method for run in runs for row in run.rows)
    rows = []
    for name in names:
        values = [run.row(name) for run in runs]
        numbers = [None if row is None else of(row) for row in values]
        rows.append([f"`{name}`", *(c.written(number, text) for number in numbers)])
    return markdown(["method", *(f"{run.shapes:,}" for run in runs)], rows)


def table_sizes(results: Results) -> str:
    """Sizes of the hash table."""
    rows = []
    for run in results.of("table"):
        for method in (LVSI, LVSI_EMPTY):
            row = run.row(method)
            if row is None:
                rows.append([run.scene, run.label, f"`{method}`", *[c.ABSENT] * 6])
                continue
            table = row.table or {}
            time = c.ratio(run, c.seconds, method, CONTROL)
            rows.append(
                [
                    run.scene,
                    run.label,
                    f"`{method}`",
                    *(
                        f"{table[key]:,.0f}" if key in table else c.ABSENT
                        for key in ("table_size", "heads_used", "longest_chain")
                    ),
                    c.written(c.memory(row), c.in_bytes),
                    c.written(c.lookups(row)),
                    c.written(time, c.times),
                ]
            )
    head = ["scene", "table size", "method", "rows", "used", "longest chain"]
    head += ["memory", "look-ups per ray", f"time / {CONTROL}"]
    return markdown(head, rows, left=3)


def criteria(results: Results) -> str:
    """What each criterion does to the octree, scene by scene."""
    rows = []
    for run in results.of("criteria"):
        row = run.row(ORDERED)
        time = c.ratio(run, c.seconds, ORDERED, CONTROL)
        if row is None:
            rows.append([run.scene, run.label, *[c.ABSENT] * 5])
            continue
        cells = [
            c.written(c.memory(row), c.in_bytes),
            c.written(row.depth, lambda level: f"{level:.0f}"),
            c.written(c.steps(row)),
            c.written(c.tests(row)),
            c.written(time, c.times),
        ]
        rows.append([run.scene, run.label, *cells])
    head = ["scene", "criterion", "memory", "depth", "cells per ray", "tests per ray"]
    return markdown([*head, f"time / {CONTROL}"], rows, left=2)


def missing(results: Results) -> str:
    """Everything that was asked for and is not there, with the reason."""
    lines = []
    for run in results.measured:
        for row in run.rows:
            if not row.done:
                why = f": {row.message}" if row.message else ""
                name = f"{run.experiment}, {run.scene} with {run.shapes:,} shapes"
                label = f", {run.label}" if run.label else ""
                lines.append(f"* {name}{label}: `{row.method}` {row.status}{why}")
    lines += [f"* {name}: no time was left" for name in results.skipped]
    lines += [f"* {scene.title}: {scene.absent}" for scene in results.scenes if scene.absent]
    return "\n".join(lines) if lines else "Nothing is missing."
