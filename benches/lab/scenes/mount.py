"""Mount: a mountain of random midpoint displacement under four balls of glass.

After the *mount* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987), with the
displacement of Fournier, Fussell and Carpenter (CACM 25(6), 1982) on a square lattice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

import numpy as np

from scenes import nff

if TYPE_CHECKING:
    from scenes.nff import Floats

TITLE = "mount"
WHAT = "a fractal mountain of triangles under four balls of glass"
SUFFIX = ".nff"

#: How far the first midpoints are moved, and how much less those of each halving.
HEIGHT, ROUGHNESS = 0.42, 0.47
BALL = 0.17


def count(level: int) -> dict[str, int]:
    """Shapes of a lattice with 2^level squares on a side, two triangles each."""
    return {"triangles": 2 * 4**level, "spheres": 4}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    nff.view(file, (-1.7, 1.7, 1.75), (0.05, -0.05, 0.05), angle=45)
    nff.lights(file, [(-100, -60, 100)])
    nff.material(file, (1, 1, 1), diffuse=0.1, mirror=0.1, shine=100, glass=0.85, ior=1.5)
    nff.spheres(file, balls(), BALL)
    nff.material(file, (0.6, 0.55, 0.42))
    nff.polygons(file, triangles(level))


def balls() -> Floats:
    """A small pyramid of four, the highest towards the camera."""
    around = np.radians([135, 255, 15])
    low = np.column_stack([np.cos(around), np.sin(around), np.zeros(3)]) * 2 * BALL / np.sqrt(3)
    top = [(0.0, 0.0, 2 * BALL * np.sqrt(2 / 3))]
    return np.vstack([low, top]) * 1.15 + (-0.75, 0.75, 0.85)


def triangles(level: int) -> Floats:
    """The ground between -1 and 1: shape (n, 3, 3)."""
    z = heights(level)
    ticks = np.linspace(-1, 1, len(z))
    x, y = np.meshgrid(ticks, ticks, indexing="ij")
    points = np.stack([x, y, z], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    pairs = np.stack([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)], axis=2)
    return pairs.reshape(-1, 3, 3)


def heights(level: int) -> Floats:
    """Heights over the lattice; a finer one keeps the points of a coarser one."""
    z, spread = np.zeros((2, 2)), HEIGHT
    for step in range(level):
        n = 2 * len(z) - 1
        finer = np.zeros((n, n))
        finer[::2, ::2] = z
        moved = _random((n, n), step) * spread
        finer[1::2, ::2] = (z[1:] + z[:-1]) / 2 + moved[1::2, ::2]
        finer[::2, 1::2] = (z[:, 1:] + z[:, :-1]) / 2 + moved[::2, 1::2]
        corners = z[1:, 1:] + z[:-1, 1:] + z[1:, :-1] + z[:-1, :-1]
        finer[1::2, 1::2] = corners / 4 + moved[1::2, 1::2]
        z, spread = finer, spread * ROUGHNESS
    return z


def _random(shape: tuple[int, int], seed: int) -> Floats:
    """Uniform between -1 and 1, the same in every version of NumPy: SplitMix64 of the index."""
    value = np.arange(shape[0] * shape[1], dtype=np.uint64)
    value = (value + np.uint64(1 + (seed << 32))) * np.uint64(0x9E3779B97F4A7C15)
    value = (value ^ (value >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    value = (value ^ (value >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    value ^= value >> np.uint64(31)
    return (value >> np.uint64(11)).astype(np.float64).reshape(shape) * 2.0**-52 - 1
