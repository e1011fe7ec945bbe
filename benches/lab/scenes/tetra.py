"""Tetra: Sierpinski's tetrahedron, four half as large in the corners of one, again and again.

After the *tetra* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

import numpy as np

from scenes import nff

if TYPE_CHECKING:
    from scenes.nff import Floats

TITLE = "tetra"
WHAT = "Sierpinski's tetrahedron of triangles, much empty space among them"
SUFFIX = ".nff"

#: Corners of a regular tetrahedron: every other corner of a cube.
CORNERS = np.array([(1.0, 1, 1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1)])
#: Faces, counter-clockwise from outside.
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def count(level: int) -> dict[str, int]:
    """Triangles after so many divisions: four of each of 4^level tetrahedra."""
    return {"triangles": 4 ** (level + 1)}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    nff.view(file, (1.1, -4.2, 1.6), (0, 0, -0.02), up=(0.1, 0, 1), angle=38)
    nff.lights(file, [(2, -18, 5), (-6, -8, 14)])
    nff.material(file, (1, 0.42, 0.3))
    nff.polygons(file, triangles(level))


def triangles(level: int) -> Floats:
    """All triangles: shape (n, 3, 3)."""
    centers, scale = np.zeros((1, 3)), 1.0
    for _ in range(level):
        scale /= 2
        centers = (centers[:, None] + CORNERS * scale).reshape(-1, 3)
    return np.asarray(centers[:, None, None] + CORNERS[FACES] * scale).reshape(-1, 3, 3)
