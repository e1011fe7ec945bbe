"""Rings: a pyramid of clusters of six interlocked pentagons, rods with balls at their joints.

After the *rings* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987). Each pentagon
lies across one of the six five-fold axes of an icosahedron; its corners point along half of the
two-fold axes in that plane, so that the thirty corners are those of an icosidodecahedron.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, TextIO

import numpy as np

from scenes import nff

if TYPE_CHECKING:
    from scenes.nff import Floats, Vector

TITLE = "rings"
WHAT = "a pyramid of rings of cylinders and spheres before a wall"
SUFFIX = ".nff"

#: From a cluster's centre to the joints, thickness of the rods, distance of the layers.
REACH, ROD, LAYER = 0.93, 0.075, 2.6
COLORS: list[Vector] = [
    (0.9, 0.2, 0.2),
    (0.3, 0.8, 0.3),
    (0.25, 0.4, 0.95),
    (0.95, 0.85, 0.25),
    (0.3, 0.85, 0.9),
    (0.8, 0.35, 0.9),
]


def count(level: int) -> dict[str, int]:
    """Shapes of a pyramid with ``level + 1`` layers of 1, 4, 9, ... clusters."""
    layers = level + 1
    clusters = layers * (layers + 1) * (2 * layers + 1) // 6
    return {"spheres": 30 * clusters, "cylinders": 30 * clusters, "polygons": 1}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    nff.view(file, (-1.6, -3.6, 1.5), (0, 2.6, 0), angle=48)
    nff.lights(file, [(5, -6, 6), (-6, -5, 3), (2, -4, -6)])
    nff.material(file, (0.85, 0.85, 0.85))
    wall, half = LAYER * (level + 2), 2.5 * (level + 3)
    corners = [(half, wall, half), (-half, wall, half), (-half, wall, -half), (half, wall, -half)]
    nff.polygons(file, np.array([corners]))
    centers = _centers(level + 1)
    for ring, color in zip(pentagons(), COLORS, strict=True):
        nff.material(file, color, diffuse=0.6, mirror=0.2, shine=15)
        joints = centers[:, None] + ring * REACH
        ends = np.roll(joints, -1, axis=1)
        nff.cones(file, joints.reshape(-1, 3), ROD, ends.reshape(-1, 3), ROD)
        nff.spheres(file, joints.reshape(-1, 3), ROD)


def _centers(layers: int) -> Floats:
    """The apex is at the origin; layer k has k x k clusters, farther along y."""
    return np.array(
        [
            (2 * i - k + 1, LAYER * k, 2 * j - k + 1)
            for k in range(1, layers + 1)
            for i, j in itertools.product(range(k), repeat=2)
        ],
        dtype=float,
    )


def pentagons() -> Floats:
    """Corners of the six rings as unit vectors: shape (6, 5, 3); no two of them are equal."""
    golden = (1 + np.sqrt(5)) / 2
    signs = (1, -1)
    axes = np.array([np.roll((0, 1, s * golden), k) for k in range(3) for s in signs])
    two_fold = [np.roll((2.0 * s, 0, 0), k) for k in range(3) for s in signs]
    two_fold += [
        np.roll((a * golden, b, c / golden), k)
        for k in range(3)
        for a, b, c in itertools.product(signs, repeat=3)
    ]
    corners = np.array(two_fold) / 2
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    rings = [_around(axis, corners) for axis in axes]
    for halves in itertools.product((0, 1), repeat=len(rings)):
        chosen = np.array([ring[half::2] for ring, half in zip(rings, halves, strict=True)])
        if len(np.unique(chosen.reshape(-1, 3).round(6) + 0.0, axis=0)) == 30:
            return chosen
    raise AssertionError("six pentagons share thirty corners")


def _around(axis: Floats, corners: Floats) -> Floats:
    """The ten corners across an axis, in order around it."""
    axis = axis / np.linalg.norm(axis)
    found = corners[np.abs(corners @ axis) < 1e-9]
    side = np.cross(axis, found[0])
    return found[np.argsort(np.arctan2(found @ side, found @ found[0]))]
