"""Tables for terminals."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


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


def aligned(columns: Sequence[tuple[str, str, bool]], rows: Iterable[list[str]]) -> list[str]:
    """Give lines: names, units, then the rows.

    A column is its name, its unit, and whether it is flush left.
    """
    lines = [[name for name, _, _ in columns], [unit for _, unit, _ in columns], *rows]
    widths = [max(map(len, fields)) for fields in zip(*lines, strict=True)]
    return [
        "  ".join(
            text.ljust(width) if left else text.rjust(width)
            for text, width, (_, _, left) in zip(fields, widths, columns, strict=True)
        ).rstrip()
        for fields in lines
    ]
