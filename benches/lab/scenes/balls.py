"""Balls: a sphere with nine spheres of a third of its radius on it, each again with nine.

After the *balls* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987). Six children
stand around the parent's equator and three on its upper half, as spheres are packed most
densely; a child's pole points away from its parent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

import numpy as np

from scenes import nff

if TYPE_CHECKING:
    from scenes.nff import Floats

TITLE = "balls"
WHAT = "spheres on spheres, each a third as large, on a floor"
SUFFIX = ".nff"

RADIUS = 0.5


def count(level: int) -> dict[str, int]:
    """Shapes after so many generations of children."""
    return {"spheres": (9 ** (level + 1) - 1) // 8, "polygons": 1}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    nff.view(file, (2.1, 1.3, 1.7), (0, 0, 0.05), angle=42)
    nff.lights(file, [(4, 3, 2), (1, -4, 4), (-3, 1, 5)])
    nff.material(file, (0.75, 0.8, 0.7))
    nff.square(file, 12, -RADIUS)
    nff.material(file, (0.95, 0.75, 0.45), diffuse=0.55, mirror=0.4, shine=12)
    for centers, radius in flake(level):
        nff.spheres(file, centers, radius)


def flake(level: int) -> list[tuple[Floats, float]]:
    """Centres and radius of every generation."""
    places, turns = _children()
    centers, frames, radius = np.zeros((1, 3)), np.eye(3)[None], RADIUS
    generations = [(centers, radius)]
    for _ in range(level):
        # Columns of a frame are its axes in space.
        offsets = np.einsum("nij,kj->nki", frames, places) * (radius + radius / 3)
        centers = (centers[:, None] + offsets).reshape(-1, 3)
        frames = np.einsum("nij,kjl->nkil", frames, turns).reshape(-1, 3, 3)
        radius /= 3
        generations.append((centers, radius))
    return generations


def _children() -> tuple[Floats, Floats]:
    """Directions of the nine children and the frames in which their own children stand."""
    raised = np.arcsin(np.sqrt(2 / 3))
    angles = [(np.radians(45 + 120 * k), raised) for k in range(3)]
    angles += [(np.radians(15 + 60 * k), 0.0) for k in range(6)]
    places = np.array(
        [(np.cos(h) * np.cos(a), np.cos(h) * np.sin(a), np.sin(h)) for a, h in angles]
    )
    return places, np.array([_turn_up_to(place) for place in places])


def _turn_up_to(direction: Floats) -> Floats:
    """The smallest rotation that takes z to ``direction`` (Rodrigues' formula)."""
    x, y, z = direction
    cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 + z))
