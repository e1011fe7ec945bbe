"""The lab's figures as a table for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octray._table import ABSENT, aligned, number
from octray.lab import figures
from octray.lab.result import Status

if TYPE_CHECKING:
    from octray.lab.result import Combination, Report

_MIB = 1 << 20


def count(value: int | None) -> str:
    """Write a count, in thousands or millions where it is long."""
    if value is None:
        return ABSENT
    for unit, size, least in (("M", 1e6, 1e6), ("k", 1e3, 1e4)):
        # What rounds up to a million is one.
        if value >= 0.9995 * least:
            text = f"{value / size:.3g}"
            return (text if "e" not in text else f"{value / size:.0f}") + unit
    return str(value)


#: Columns: a heading, its unit, and whether text stands at the left.
COLUMNS = (
    ("method", "", True),
    ("build", "s", False),
    ("memory", "MiB", False),
    ("cells", "", False),
    ("steps", "/ray", False),
    ("look-ups", "/ray", False),
    ("tests", "/ray", False),
    ("render", "s", False),
    ("±", "s", False),
    ("× auto", "", False),  # noqa: RUF001 - the sign for times
    ("picture", "", True),
)


def verdict(combination: Combination) -> str:
    """Give what the last column says: the picture, or why there is none."""
    words = []
    if combination.same is not None:
        words.append("same" if combination.same else f"DIFFERS in {combination.different_pixels}")
    if combination.status is not Status.DONE:
        words.append(combination.status.value)
        if combination.message:
            words[-1] += f": {combination.message}"
    return "; ".join(words) or ABSENT


def row(combination: Combination) -> list[str]:
    """Give the cells of one method."""
    found = figures.of(combination.report, combination.stats)
    return [
        combination.method,
        number(combination.build),
        number(None if found.memory is None else found.memory / _MIB),
        count(found.cells),
        number(found.each_ray("cells", "nodes")),
        number(found.each_ray("lookups")),
        number(found.each_ray("surfaces", "triangles")),
        number(combination.render),
        number(combination.spread, 2),
        number(combination.relative),
        verdict(combination),
    ]


def table(report: Report) -> str:
    """Give the table, and below it what a reader has to know besides."""
    lines = aligned(COLUMNS, map(row, report.combinations))
    if report.reference is not None:
        lines += ["", f"Pictures are compared with that of {report.reference}."]
    if report.cut_off:
        names = ", ".join(combination.method for combination in report.cut_off)
        lines.append(f"The budget cut off: {names}.")
    lines += [f"Note: {note}." for note in report.notes]
    return "\n".join(lines)
