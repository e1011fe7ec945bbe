"""Tables of numbers as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import TextIO

    from octray.bench.scene import Floats, Integers

#: How many rows are put into words at once.
_CHUNK = 20_000


def table(pattern: str, rows: Floats) -> str:
    """Give a line, or several, for each row of numbers; ``pattern`` holds a %.9g for each."""
    # Adding 0 turns -0 into 0.
    return (pattern * len(rows)) % tuple((rows + 0.0).ravel().tolist())


def rows(file: TextIO, pattern: str, numbers: Floats | Integers) -> None:
    """Write a line, or several, for each row; ``pattern`` holds a %.9g or %d for each number."""
    for start in range(0, len(numbers), _CHUNK):
        part = numbers[start : start + _CHUNK]
        file.write((pattern * len(part)) % tuple((part + 0).ravel().tolist()))
