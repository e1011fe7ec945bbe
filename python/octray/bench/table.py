"""The benchmark's figures as a table for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octray._table import aligned, number
from octray.bench.programs import YARDSTICK
from octray.bench.result import Status

if TYPE_CHECKING:
    from octray.bench.result import Report, Series

_MIB = 1 << 20
#: Of fewer shapes than this the memory of each is lost in what differs from run to run.
_ENOUGH = 1000
#: Columns: a heading, its unit, and whether text stands at the left.
COLUMNS = (
    ("scene", "", True),
    ("threads", "", False),
    ("program", "", True),
    ("trace", "s", False),
    ("/ octray", "", False),
    ("command", "s", False),
    ("/ octray", "", False),
    ("peak", "MiB", False),
    ("each shape", "B", False),
    ("", "", True),
)


def row(report: Report, series: Series) -> list[str]:
    """Give the cells of one series."""
    peak = series.median("peak_bytes")
    other = series.program != YARDSTICK
    said = [series.status.value] if series.status is not Status.DONE else []
    if said and series.message:
        said.append(series.message)
    return [
        series.scene,
        str(series.threads),
        series.program,
        number(series.median("trace_s")),
        number(report.ratio(series, "trace_s")) if other else "",
        number(series.median("whole_s")),
        number(report.ratio(series, "whole_s")) if other else "",
        number(None if peak is None else peak / _MIB),
        number(_each(report, series)),
        ": ".join(said),
    ]


def _each(report: Report, series: Series) -> float | None:
    """Give the memory of each shape, where there are enough of them to tell."""
    shapes = sum(report.scenes[series.scene].counts.values())
    return report.bytes_per_shape(series) if shapes >= _ENOUGH else None


def table(report: Report) -> str:
    """Give the table, and below it what a reader has to know besides."""
    # Empty pictures are what others are net of; there is nothing to see in them but a failure.
    shown = [
        series
        for series in report.series
        if report.scenes[series.scene].empty != series.scene or series.status is not Status.DONE
    ]
    names, units, *texts = aligned(COLUMNS, [row(report, series) for series in shown])
    lines = [names, units]
    before: Series | None = None
    for series, line in zip(shown, texts, strict=True):
        if before is not None and (before.scene, before.threads) != (series.scene, series.threads):
            lines.append("")
        lines.append(line)
        before = series
    return "\n".join([*lines, "", *_notes(report)])


def _notes(report: Report) -> list[str]:
    here = ", ".join(f"{name} {version}" for name, version in report.programs.items())
    lines = [f"Ran: {here}.", "A ratio is the median over the rounds; above 1 octray is faster."]
    lines += [f"Not run: {name}: {reason}." for name, reason in report.absent.items()]
    unfit: dict[str, list[str]] = {}
    for name, facts in report.scenes.items():
        for program, reason in facts.unfit.items():
            if name != facts.empty:
                unfit.setdefault(f"{program} {reason}", []).append(name)
    lines += [f"Not run: {reason}: {', '.join(names)}." for reason, names in unfit.items()]
    if report.not_begun:
        lines.append(f"Not begun: {', '.join(report.not_begun)}.")
    load, processors = report.machine["load"], report.machine["processors"]
    if load is not None and processors and load > 0.5:  # noqa: PLR2004 - half a processor
        lines.append(
            f"The machine was not idle: {number(load, 2)} processes wanted to run on its"
            f" {processors} processors. Ratios suffer less than times."
        )
    return lines
