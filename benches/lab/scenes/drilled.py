"""Drilled: one part, a plate from which n x n holes are cut; a difference of that many solids."""

from __future__ import annotations

from typing import TextIO

import numpy as np

from octray.bench.shapes import HALF, THICK, holes
from octray.bench.writers.text import rows
from scenes import pov

TITLE = "drilled"
WHAT = "one CSG part: a plate minus as many cylinders as there are holes"
SUFFIX = ".pov"

#: On a side, at every level: about a factor of ten in holes from one to the next.
SIDES = (1, 3, 10, 32, 100, 316, 1000)


def count(level: int) -> dict[str, int]:
    """The plate and its holes."""
    return {"box": 1, "cylinders": SIDES[level] ** 2}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    pov.view(file, (-1.7, -2.5, 1.95), (0, -0.05, -0.12), angle=48)
    pov.lights(file, [(4, -2, 6), (-5, 1, 3)])
    file.write(f"plane {{ z, {-0.35:.9g} {pov.material((0.75, 0.72, 0.66))} }}\n")
    corner = pov.vector(HALF, HALF, THICK)
    file.write(f"difference {{\n  box {{ -{corner}, {corner} }}\n")
    reach = 2 * THICK
    pattern = f"  cylinder {{ <%.9g, %.9g, {-reach:.9g}>, <%.9g, %.9g, {reach:.9g}>, %.9g }}\n"
    x, y, radius = holes(SIDES[level]).T
    rows(file, pattern, np.column_stack([x, y, x, y, radius]))
    file.write(f"  {pov.material((0.55, 0.62, 0.72), mirror=0.15)}\n}}\n")
