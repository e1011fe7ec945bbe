"""Balls: a sphere with nine spheres of a third of its radius on it, each again with nine.

After the *balls* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987). Six children
stand around the parent's equator and three on its upper half, as spheres are packed most
densely; a child's pole points away from its parent.
"""

from __future__ import annotations

from typing import TextIO

from octray.bench.shapes import BALL, sphere_flake
from scenes import nff

TITLE = "balls"
WHAT = "spheres on spheres, each a third as large, on a floor"
SUFFIX = ".nff"


def count(level: int) -> dict[str, int]:
    """Shapes after so many generations of children."""
    return {"spheres": (9 ** (level + 1) - 1) // 8, "polygons": 1}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    nff.view(file, (2.1, 1.3, 1.7), (0, 0, 0.05), angle=42)
    nff.lights(file, [(4, 3, 2), (1, -4, 4), (-3, 1, 5)])
    nff.material(file, (0.75, 0.8, 0.7))
    nff.square(file, 12, -BALL)
    nff.material(file, (0.95, 0.75, 0.45), diffuse=0.55, mirror=0.4, shine=12)
    for centers, radius in sphere_flake(level):
        nff.spheres(file, centers, radius)
