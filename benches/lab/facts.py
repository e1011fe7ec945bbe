"""Every number and every verdict that the page's sentences may use, by name."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING

import comparison as c
from plan import (
    BEAM,
    BY_BOX,
    BY_SHELLS,
    CONTROL,
    FUJIMOTO_IWATA,
    LVSI,
    LVSI_EMPTY,
    ORDERED,
    SUNG,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from results import Measured, Results

#: Name in the page, method, what it is compared with.
PAIRS = {
    "hash_tree": (LVSI, SUNG),
    "hash_empty_tree": (LVSI_EMPTY, SUNG),
    "hash_ordered": (LVSI, ORDERED),
    "empty_only": (LVSI_EMPTY, LVSI),
    "fujimoto_ordered": (FUJIMOTO_IWATA, ORDERED),
    "beam_ordered": (BEAM, ORDERED),
    "shells_box": (BY_SHELLS, BY_BOX),
    "box_analytic": (BY_BOX, ORDERED),
    "grid_ordered": ("grid", ORDERED),
    "boxes_ordered": ("boxes", ORDERED),
}
QUANTITIES = {
    "time": c.seconds,
    "build": c.built,
    "bytes": c.memory,
    "nodes": c.nodes,
    "steps": c.steps,
    "tests": c.tests,
    "lookups": c.lookups,
    "depth": c.depth,
}


def facts(results: Results) -> dict[str, str]:
    """All facts of a run. What was not measured has no entry: a page that wants it fails."""
    found = _of_the_run(results)
    for name, (method, base) in PAIRS.items():
        for quantity, value in QUANTITIES.items():
            _add(found, f"{name}.{quantity}", _ratios(results, value, method, base))
    for kind in ("primary", "shadow"):
        cells = c.kind_of_ray(kind, "cells")
        _add(found, f"beam_ordered.{kind}_cells", _ratios(results, cells, BEAM, ORDERED))
    found |= _grid(results) | _claims(results) | _reduction(results)
    return found | _sweep(results) | _tables(results)


def _add(found: dict[str, str], name: str, ratios: c.Ratios | None) -> None:
    if ratios is not None:
        found |= ratios.facts(name)


def _ratios(results: Results, quantity: c.Quantity, method: str, base: str) -> c.Ratios | None:
    """Over the scenes of the comparison that both were run on."""
    return c.over_scenes(
        results.of("comparison"), quantity, method, base, lambda name: results.scene(name).title
    )


def _of_the_run(results: Results) -> dict[str, str]:
    rows = [row for run in results.measured for row in run.rows]
    compared = [row for row in rows if row.same is not None]
    return {
        "run.mode": results.mode,
        "run.octray": results.octray,
        "run.processor": str(results.machine["processor"]),
        "run.processors": str(results.machine["processors"]),
        "run.memory": c.in_bytes(results.machine.get("memory_bytes") or 0),
        "run.width": str(results.size[0]),
        "run.height": str(results.size[1]),
        "run.small_width": str(results.small[0]),
        "run.small_height": str(results.small[1]),
        "run.repeat": str(results.repeat),
        "run.minutes": c.short(results.seconds / 60),
        "run.rows": str(len(rows)),
        "run.pictures": str(len(compared)),
        "run.same": str(sum(row.same is True for row in compared)),
        "run.different": str(sum(row.same is False for row in compared)),
        "run.missing": str(sum(not row.done for row in rows) + len(results.skipped)),
        "run.scenes": str(sum(scene.shapes is not None for scene in results.scenes)),
        "run.noise": f"{c.NOISE:.0%}",
    }


def _grid(results: Results) -> dict[str, str]:
    """Where the grid is faster than every octree that was run beside it."""
    wins, of = [], 0
    for run in results.of("comparison"):
        grid = run.row("grid")
        if grid is None or not c.walks(grid):
            continue
        trees = [row.method for row in run.rows if row.method.startswith("octree")]
        ratios = [c.ratio(run, c.seconds, "grid", tree) for tree in trees]
        known = [ratio for ratio in ratios if ratio is not None]
        if known:
            of += 1
            if max(known) < 1 - c.NOISE:
                wins.append(results.scene(run.scene).title)
    if of == 0:
        return {}
    return {"grid.wins": str(len(wins)), "grid.of": str(of), "grid.where": listed(wins)}


def listed(words: list[str]) -> str:
    """Words as a sentence lists them."""
    if not words:
        return "none of them"
    if len(words) == 1:
        return words[0]
    return ", ".join(words[:-1]) + " and " + words[-1]


def _claims(results: Results) -> dict[str, str]:
    """The paper's claims, each a ratio that lies above or below 1 on most scenes."""
    found = {}
    for name, quantity, (method, base), side in (
        ("saves", c.memory, PAIRS["hash_tree"], "below"),
        ("saves_nodes", c.nodes, PAIRS["hash_tree"], "below"),
        ("slower", c.seconds, PAIRS["hash_tree"], "above"),
        ("slower_empty", c.seconds, PAIRS["hash_empty_tree"], "above"),
        ("deeper", c.depth, PAIRS["shells_box"], "above"),
        ("accurate", c.tests, PAIRS["shells_box"], "below"),
        ("longer", c.built, PAIRS["shells_box"], "above"),
        ("larger", c.memory, PAIRS["shells_box"], "above"),
    ):
        ratios = _ratios(results, quantity, method, base)
        if ratios is not None:
            shown = ratios.below if side == "below" else ratios.above
            found[f"claim.{name}"] = c.verdict(shown, ratios.of)
            found[f"claim.{name}.shown"] = str(shown)
            found[f"claim.{name}.of"] = str(ratios.of)
    return found


def _points(runs: Iterator[Measured], method: str, of: c.Quantity) -> list[tuple[float, float]]:
    """Sizes and quantities of a method along a growth curve."""
    points = []
    for run in runs:
        row = run.row(method)
        value = None if row is None else of(row)
        if value:
            points.append((float(run.shapes), value))
    return points


def _reduction(results: Results) -> dict[str, str]:
    """How the cost of a ray grows with the operands of one solid."""
    found: dict[str, str] = {}
    for name, method in {
        "faces": ORDERED,
        "by_box": BY_BOX,
        "by_shells": BY_SHELLS,
        "boxes": "boxes",
        "brute": "brute",
    }.items():
        for word, of in (("time", c.per_ray_s), ("tests", c.tests)):
            points = _points(results.of("growth", "drilled"), method, of)
            if len(points) < 2:
                continue
            (n0, y0), (n1, y1) = points[0], points[-1]
            key = f"drilled.{name}.{word}"
            found |= {
                f"{key}.from": f"{n0:,.0f}",
                f"{key}.to": f"{n1:,.0f}",
                f"{key}.operands": c.times(n1 / n0),
                f"{key}.growth": c.times(y1 / y0),
                f"{key}.exponent": f"{c.exponent(points):.2f}",
                f"{key}.per_decade": c.times((y1 / y0) ** (1 / _decades(n0, n1))),
                # What a cost proportional to the operands would have become.
                f"{key}.below_linear": c.times((n1 / n0) / (y1 / y0)),
            }
    for run in results.of("growth", "drilled"):
        for name, method in (("brute", "brute"), ("boxes", "boxes"), ("by_box", BY_BOX)):
            ratio = c.ratio(run, c.seconds, method, ORDERED)
            if ratio is not None:
                # The largest scene that both were run on comes last.
                found[f"drilled.{name}.slower"] = c.times(ratio)
                found[f"drilled.{name}.slower.at"] = f"{run.shapes:,}"
    return found


def _decades(least: float, most: float) -> float:
    return c.exponent([(1.0, 1.0), (10.0, most / least)])


def _sweep(results: Results) -> dict[str, str]:
    """How far memory and time range while the criteria change."""
    found: dict[str, str] = {}
    more, of = 0, 0
    spreads: dict[str, list[float]] = {"bytes": [], "time": [], "near": []}
    for scene in dict.fromkeys(run.scene for run in results.of("criteria")):
        settings = []
        for run in results.of("criteria", scene):
            row, ratio = run.row(ORDERED), c.ratio(run, c.seconds, ORDERED, CONTROL)
            if row is not None and row.bytes and ratio:
                settings.append((row.bytes, ratio))
        if len(settings) < 2:
            continue
        sizes, times = zip(*settings, strict=True)
        memory, time = max(sizes) / min(sizes), max(times) / min(times)
        spreads["bytes"].append(memory)
        spreads["time"].append(time)
        # Settings that a user would choose: none takes more than twice the least time.
        near = [size for size, ratio in settings if ratio <= 2 * min(times)]
        spreads["near"].append(max(near) / min(near))
        of += 1
        more += memory > time
    if of:
        found["claim.criteria"] = c.verdict(more, of)
        found["claim.criteria.shown"] = str(more)
        found["claim.criteria.of"] = str(of)
        for name, ranges in spreads.items():
            found[f"criteria.{name}.median"] = c.times(statistics.median(ranges))
            found[f"criteria.{name}.most"] = c.times(max(ranges))
    return found


def _tables(results: Results) -> dict[str, str]:
    """A table with as many rows as a power of two, against a prime number of rows."""
    chains: dict[str, float] = {}
    looked: dict[str, float] = {}
    time: dict[str, float] = {}
    used: dict[str, float] = {}
    sizes: dict[str, float] = {}
    for scene in dict.fromkeys(run.scene for run in results.of("table")):
        runs = {run.label: run for run in results.of("table", scene)}
        if {"prime", "power of two"} - runs.keys():
            continue
        prime, power = runs["prime"], runs["power of two"]
        a, b = power.row(LVSI), prime.row(LVSI)
        if a is None or b is None:
            continue
        title = results.scene(scene).title
        if a.table and b.table:
            chains[title] = a.table["longest_chain"] / max(b.table["longest_chain"], 1)
            sizes[title] = a.table["table_size"] / b.table["table_size"]
            share = a.table["heads_used"] / a.table["table_size"]
            used[title] = share / (b.table["heads_used"] / b.table["table_size"])
        mine, other = c.lookups(a), c.lookups(b)
        if mine and other:
            looked[title] = mine / other
        times = [c.ratio(run, c.seconds, LVSI, CONTROL) for run in (power, prime)]
        if times[0] and times[1]:
            time[title] = times[0] / times[1]
    found: dict[str, str] = {}
    for name, ratios in (
        ("rows", sizes),
        ("chain", chains),
        ("lookups", looked),
        ("time", time),
        ("used", used),
    ):
        if ratios:
            found |= c.Ratios(ratios, c.NOISE if name == "time" else 0.0).facts(f"table.{name}")
    return found
