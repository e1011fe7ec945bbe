"""Charts of the lab's figures: one row for each method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.ticker import EngFormatter, FuncFormatter

from octray.lab import figures
from octray.lab.figure import COLORS, FAINT, drawn, to_svg
from octray.lab.result import Status

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from octray.lab.result import Combination

_WIDTH = 10.0
_ROW = 0.24
_FRAME = 0.95
#: A range wider than this is drawn on a logarithmic axis.
_WIDE = 30.0
_KINDS = dict(zip(figures.KINDS, ("o", "s", "^", "D"), strict=True))


def _height(rows: int) -> float:
    return _FRAME + _ROW * max(rows, 1)


def _rows(axes: Axes, combinations: Sequence[Combination]) -> None:
    """Name the rows, the first at the top."""
    axes.set_yticks(range(len(combinations)), [c.method for c in combinations])
    axes.tick_params(axis="y", length=0)
    for label in axes.get_yticklabels():
        label.set_fontfamily("monospace")
    axes.set_ylim(len(combinations) - 0.5, -0.5)
    axes.grid(axis="y", visible=False)


def _plain(axes: Axes) -> None:
    """Write the ticks of an axis as plain numbers."""
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _scale(axes: Axes, values: Sequence[float]) -> None:
    """Choose a logarithmic axis where values differ much; none of them may be 0 then."""
    positive = [value for value in values if value > 0]
    if positive and max(positive) > _WIDE * min(positive):
        if len(positive) == len(values):
            axes.set_xscale("log")
        else:
            axes.set_xscale("symlog", linthresh=min(positive), linscale=0.4)
            axes.set_xlim(left=0)
        _plain(axes)
    else:
        axes.set_xlim(0, None if positive else 1)


def _absent(axes: Axes, row: int, combination: Combination) -> None:
    """Say in an empty row why it is empty."""
    why = "-" if combination.status is Status.DONE else combination.status.value
    axes.annotate(
        why,
        (0, row),
        xycoords=("axes fraction", "data"),
        xytext=(4, 0),
        textcoords="offset points",
        va="center",
        color=FAINT,
        style="italic",
    )


def times(combinations: Sequence[Combination]) -> str:
    """Draw seconds of building and rendering: every repetition, and the median."""
    with drawn("times", _WIDTH, _height(len(combinations))) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, title, name in zip(
            panels, ("Build, s", "Render, s"), ("build_s", "render_s"), strict=True
        ):
            everything: list[float] = []
            for row, combination in enumerate(combinations):
                seconds = getattr(combination, name)
                if not seconds:
                    _absent(axes, row, combination)
                    continue
                everything += seconds
                axes.plot(
                    [min(seconds), max(seconds)], [row, row], color=COLORS[0], lw=5, alpha=0.25
                )
                axes.plot(seconds, [row] * len(seconds), "|", color=COLORS[0], ms=8)
                median = combination.build if name == "build_s" else combination.render
                axes.plot([median], [row], "o", color=COLORS[0], ms=6)
            _rows(axes, combinations)
            _scale(axes, everything)
            axes.set_title(title)
        return to_svg(figure)


def stacked(
    name: str,
    title: str,
    combinations: Sequence[Combination],
    values: Sequence[dict[str, int] | None],
    *,
    unit: str = "",
) -> str | None:
    """Draw bars of parts, one bar for each method; ``None`` if there is nothing to draw."""
    parts = list(
        dict.fromkeys(part for value in values for part, size in (value or {}).items() if size)
    )
    if not parts:
        return None
    with drawn(name, _WIDTH, _height(len(combinations)) + 0.3) as figure:
        axes = figure.subplots()
        for number, part in enumerate(parts):
            color = COLORS[number % len(COLORS)]
            lefts, widths = [], []
            for value in values:
                known = value or {}
                lefts.append(sum(known.get(before, 0) for before in parts[:number]))
                widths.append(known.get(part, 0))
            axes.barh(range(len(values)), widths, left=lefts, height=0.68, color=color, label=part)
        for row, (value, combination) in enumerate(zip(values, combinations, strict=True)):
            if value is None:
                _absent(axes, row, combination)
        _rows(axes, combinations)
        axes.set_xlim(left=0)
        axes.xaxis.set_major_formatter(EngFormatter(unit=unit))
        axes.set_title(title)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower left", ncols=6)
        return to_svg(figure)


#: Panels of work per ray: a title and what is summed.
WORK = (
    ("Steps per ray", ("cells", "nodes")),
    ("Look-ups per ray", ("lookups",)),
    ("Surface tests per ray", ("surfaces",)),
    ("Triangle tests per ray", ("triangles",)),
)


def work(combinations: Sequence[Combination]) -> str | None:
    """Draw what a ray of each kind costs; ``None`` where kinds were not counted."""
    found = [figures.of(c.report, c.stats) for c in combinations]
    if not any(f.per_ray_by_kind for f in found):
        return None
    counted = [f.per_ray or {} for f in found]
    panes = [
        (title, names)
        for title, names in WORK
        if any(costs.get(name) for costs in counted for name in names)
    ]
    if not panes:
        return None
    with drawn("work", _WIDTH, _height(len(combinations)) + 0.3) as figure:
        panels = figure.subplots(1, len(panes), sharey=True, squeeze=False)[0]
        for axes, (title, names) in zip(panels, panes, strict=True):
            shown: list[float] = []
            for place, (kind, marker) in enumerate(_KINDS.items()):
                points = [
                    (sum(costs[kind][n] for n in names), row)
                    for row, costs in enumerate(f.per_ray_by_kind for f in found)
                    if costs and costs[kind]["rays"] and all(n in costs[kind] for n in names)
                ]
                if not points:
                    continue
                shown += [value for value, _ in points]
                axes.plot(
                    [value for value, _ in points],
                    # One above the other, so that none hides another.
                    [row + 0.16 * (place - 1.5) for _, row in points],
                    marker,
                    color=COLORS[place],
                    ms=4.5,
                    label=kind,
                    clip_on=False,
                )
            for row, combination in enumerate(combinations):
                if found[row].per_ray_by_kind is None:
                    _absent(axes, row, combination)
            _rows(axes, combinations)
            _scale(axes, shown)
            axes.set_title(title)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower left", ncols=4)
        return to_svg(figure)
