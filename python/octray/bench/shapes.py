"""The shapes of the scenes, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from octray.bench.scene import Floats, Integers, Vector

#: The radius of the first ball of a sphere flake.
BALL = 0.5
#: Half the side of the drilled plate and half its height.
HALF, THICK = 1.0, 0.04


def sphere_flake(level: int) -> list[tuple[Floats, float]]:
    """Centres (n, 3) and the radius of every generation: nine balls on each ball.

    After the *balls* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987). Children
    have a third of the radius; six stand around the parent's equator and three on its upper half,
    as spheres are packed most densely; a child's pole points away from its parent.
    """
    places, turns = _children()
    centers, frames, radius = np.zeros((1, 3)), np.eye(3)[None], BALL
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
    return places, np.array([_turn_up_to(place) for place in places.tolist()])


def _turn_up_to(direction: Vector) -> Floats:
    """Give the smallest rotation that takes z to ``direction`` (Rodrigues' formula)."""
    x, y, z = direction
    cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1 + z))


def bumpy_ball(rows: int) -> tuple[Floats, Integers]:
    """Vertices and triangles of a ball with bumps: ``rows`` + 1 rings of ``rows`` vertices.

    The first and the last ring lie in the poles; triangles that would have no area there are left
    out, which leaves 2 ``rows`` (``rows`` - 1).
    """
    theta = np.pi * np.arange(rows + 1)[:, None] / rows
    phi = 2 * np.pi * np.arange(rows)[None, :] / rows
    radius = 0.9 + 0.12 * np.sin(7 * theta) * np.cos(5 * phi)
    radius = radius + 0.04 * np.sin(31 * theta + 3 * phi) * np.sin(theta)
    points = np.stack(
        [
            radius * np.sin(theta) * np.cos(phi),
            radius * np.sin(theta) * np.sin(phi),
            radius * np.cos(theta) * np.ones_like(phi),
        ],
        axis=-1,
    )
    # What is written with single precision is what everyone renders.
    vertices = points.reshape(-1, 3).astype(np.float32).astype(np.float64)
    row, column = (grid.ravel() for grid in np.indices((rows, rows)))
    a, b = row * rows + column, row * rows + (column + 1) % rows
    c, d = a + rows, b + rows
    upper = np.stack([a, c, b], axis=1)[row > 0]
    lower = np.stack([b, c, d], axis=1)[row < rows - 1]
    return vertices, np.concatenate([upper, lower]).astype(np.int32)


def holes(side: int) -> Floats:
    """Centres and radii of side^2 holes in the drilled plate, (n, 3): none meets another.

    Nor does one meet the rim. Sizes change along the diagonals, from a quarter to a third of the
    pitch.
    """
    pitch = 2 * HALF / side
    ticks = (np.arange(side) + 0.5) * pitch - HALF
    x, y = (grid.ravel() for grid in np.meshgrid(ticks, ticks))
    step = (np.arange(side)[:, None] * 3 + np.arange(side)) % 7
    radius = (0.25 + step.ravel() / 6 * 0.15) * pitch
    return np.column_stack([x, y, radius])
