"""Charts of how many leaves have which depth, or hold how many objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from matplotlib.ticker import EngFormatter, MaxNLocator

from octray.lab.figure import COLORS, drawn, to_svg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from octray.lab.result import Combination

#: A number, and how many leaves of each series have it.
Row: TypeAlias = tuple[int, ...]

#: Histograms up to this number have a bar for each, others for ranges.
_SINGLE = 40
#: More leaves than this are counted on a logarithmic axis.
_WIDE = 30
#: Methods named above one panel.
_NAMED = 7


def _doubling(rows: Sequence[Row]) -> dict[str, tuple[int, ...]]:
    """Sum the counts of 0, 1, 2, 3 to 4, 5 to 8 and so on."""
    bins = {}
    low, high = 0, 0
    most = max(row[0] for row in rows)
    while low <= most:
        name = str(low) if low == high else f"{low}\N{EN DASH}{high}"
        inside = [row[1:] for row in rows if low <= row[0] <= high]
        bins[name] = tuple(map(sum, zip(*inside, strict=True))) or (0,) * (len(rows[0]) - 1)
        low, high = high + 1, max(2 * high, 1)
    return bins


def _bars(axes: Axes, rows: Sequence[Row], series: Sequence[str], *, binned: bool) -> None:
    """Draw the bars of one panel, those of several series side by side."""
    bins = _doubling(rows) if binned else {str(row[0]): row[1:] for row in rows}
    places = list(range(len(bins))) if binned else [row[0] for row in rows]
    width = 0.8 / len(series)
    for number, label in enumerate(series):
        shift = (number - (len(series) - 1) / 2) * width
        heights = [counts[number] for counts in bins.values()]
        at = [place + shift for place in places]
        axes.bar(at, heights, color=COLORS[number], width=width, label=label)
    if binned:
        axes.set_xticks(places, list(bins), fontsize=7, rotation=60)
    else:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.tick_params(axis="x", labelbottom=True)
    if max(count for row in rows for count in row[1:]) > _WIDE:
        axes.set_yscale("symlog", linthresh=1, linscale=0.4)
        axes.yaxis.set_major_formatter(EngFormatter())
    axes.set_ylim(bottom=0)
    axes.set_ylabel("leaves")
    axes.grid(axis="x", visible=False)


def histograms(
    name: str,
    what: str,
    combinations: Sequence[Combination],
    values: Sequence[list[list[int]] | None],
    series: Sequence[str] = ("leaves",),
) -> str | None:
    """Draw how many leaves have which ``what``; methods with the same numbers share a panel.

    A value is a list of rows: a number, and how many leaves of each series have it.
    """
    groups: dict[tuple[Row, ...], list[str]] = {}
    for combination, value in zip(combinations, values, strict=True):
        if value:
            groups.setdefault(tuple(map(tuple, value)), []).append(combination.method)
    if not groups:
        return None
    columns = min(len(groups), 3)
    lines = -(-len(groups) // columns)
    tallest = max(len(methods) for methods in groups.values())
    height = lines * (1.9 + 0.16 * min(tallest, _NAMED))
    binned = max(row[0] for rows in groups for row in rows) > _SINGLE
    with drawn(name, 10.0, height) as figure:
        panels: Any = figure.subplots(lines, columns, squeeze=False, sharex=not binned)
        for axes in panels.flat[len(groups) :]:
            axes.set_visible(False)
        for axes, (rows, methods) in zip(panels.flat, groups.items(), strict=False):
            _bars(axes, rows, series, binned=binned)
            axes.set_xlabel(what)
            shown = methods[:_NAMED]
            if len(methods) > _NAMED:
                shown[-1] = f"and {len(methods) - _NAMED + 1} more"
            axes.set_title("\n".join(shown), fontsize=7.5, fontweight="normal", family="monospace")
        if len(series) > 1:
            handles, labels = panels[0, 0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside lower left", ncols=len(series))
        return to_svg(figure)
