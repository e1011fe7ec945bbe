"""The lab's figures as a table for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octray.lab import figures
from octray.lab.result import Status

if TYPE_CHECKING:
    from octray.lab.result import Combination, Report

_MIB = 1 << 20
#: What is not known is not 0.
ABSENT = "-"


def number(value: float | None, digits: int = 3) -> str:
    """Write a number with so many significant digits, without an exponent."""
    if value is None:
        return ABSENT
    if value == 0:
        return "0"
    if abs(value) >= 10**digits:
        return f"{value:.0f}"
    text = f"{value:.{digits}g}"
    return f"{value:.6f}" if "e" in text else text


def count(value: int | None) -> str:
    """Write a count, in thousands or millions where it is long."""
    if value is None:
        return ABSENT
    for unit, size in (("M", 1e6), ("k", 1e3)):
        if value >= 10 * size:
            return f"{value / size:.3g}{unit}"
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
    rows = [row(combination) for combination in report.combinations]
    heads = [[name for name, _, _ in COLUMNS], [unit for _, unit, _ in COLUMNS]]
    widths = [max(len(line[i]) for line in heads + rows) for i in range(len(COLUMNS))]

    def line(texts: list[str]) -> str:
        fields = [
            text.ljust(width) if left else text.rjust(width)
            for text, width, (_, _, left) in zip(texts, widths, COLUMNS, strict=True)
        ]
        return "  ".join(fields).rstrip()

    lines = [line(heads[0]), line(heads[1]), *map(line, rows)]
    if report.reference is not None:
        lines += ["", f"Pictures are compared with that of {report.reference}."]
    if report.cut_off:
        names = ", ".join(combination.method for combination in report.cut_off)
        lines.append(f"The budget cut off: {names}.")
    lines += [f"Note: {note}." for note in report.notes]
    return "\n".join(lines)
