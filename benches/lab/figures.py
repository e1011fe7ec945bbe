"""The growth curves: four quantities over the number of shapes, on logarithmic axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure

import comparison as c

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from results import Results

PANELS = (
    ("build, s", c.built),
    ("memory, bytes", c.memory),
    ("cells and tests per ray", lambda row: (c.steps(row) or 0) + (c.tests(row) or 0)),
    ("time per ray, µs", lambda row: (c.per_ray_s(row) or 0) * 1e6),
)
#: Colour-blind safe (after Okabe and Ito), and a mark besides.
STYLES = (
    ("#000000", "o"),
    ("#e69f00", "s"),
    ("#56b4e9", "^"),
    ("#009e73", "v"),
    ("#d0b000", "D"),
    ("#0072b2", "P"),
    ("#d55e00", "X"),
    ("#cc79a7", "<"),
    ("#777777", ">"),
    ("#8b4513", "*"),
    ("#6a3d9a", "h"),
    ("#33a02c", "p"),
    ("#fb5a72", "d"),
)


def draw(results: Results, folder: Path) -> None:
    """Draw a figure for every scene that grows, ``growth-SCENE.svg``."""
    # Text stays text, and ids are the same every time.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "octray", "font.size": 9}):
        for scene in dict.fromkeys(run.scene for run in results.of("growth")):
            _draw(results, scene).savefig(
                folder / f"growth-{scene}.svg", metadata={"Date": None, "Creator": None}
            )


def _draw(results: Results, scene: str) -> Figure:
    figure = Figure(figsize=(9, 7.4), layout="constrained")
    axes = figure.subplots(2, 2)
    runs = list(results.of("growth", scene))
    names = list(dict.fromkeys(row.method for run in runs for row in run.rows))
    for panel, (label, quantity) in zip(axes.flat, PANELS, strict=True):
        for name, (color, mark) in zip(names, STYLES, strict=False):
            points = [
                (run.shapes, value)
                for run in runs
                if (row := run.row(name)) is not None and (value := quantity(row))
            ]
            if points:
                panel.plot(
                    *zip(*points, strict=True), color=color, marker=mark, label=name, lw=1, ms=5
                )
        _dress(panel, label)
    handles, labels = axes.flat[3].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(f"{scene}: {runs[0].shapes:,} to {runs[-1].shapes:,} shapes")
    return figure


def _dress(panel: Axes, label: str) -> None:
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel("shapes")
    panel.set_ylabel(label)
    panel.grid(visible=True, which="major", lw=0.4, alpha=0.5)
