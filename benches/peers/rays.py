"""Rays, and what they must meet: oracles that know nothing of any ray tracer."""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

#: Chords shorter than this are left out of the count: whether they exist is a matter of rounding.
CLEAR = 1e-9

HALF = 1.0
BORE = 0.6


def through_a_cube(count: int, seed: int) -> Floats:
    """``count`` rays from a sphere of radius 4 to points of the cube [-1, 1]^3."""
    rng = np.random.default_rng(seed)
    origins = rng.normal(size=(count, 3))
    origins *= 4 / np.linalg.norm(origins, axis=1, keepdims=True)
    return np.hstack([origins, rng.uniform(-1, 1, (count, 3)) - origins])


def along_the_bore(count: int, seed: int) -> Floats:
    """``count`` rays downwards, parallel to the z axis."""
    rays = np.zeros((count, 6))
    rays[:, :2] = np.random.default_rng(seed).uniform(-1, 1, (count, 2))
    rays[:, 2], rays[:, 5] = 4, -1
    return rays


def rotated(rays: Floats, matrix: Floats) -> Floats:
    """The rays turned by a 3x3 matrix."""
    return np.hstack([rays[:, :3] @ matrix.T, rays[:, 3:] @ matrix.T])


def _in_cube(rays: Floats) -> tuple[Floats, Floats]:
    """Where lines enter and leave [-1, 1]^3; entry after exit is a miss."""
    origin, direction = rays[:, :3], rays[:, 3:]
    with np.errstate(divide="ignore"):
        a, b = (-HALF - origin) / direction, (HALF - origin) / direction
    return np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)


def _in_bore(rays: Floats) -> tuple[Floats, Floats]:
    """Where lines enter and leave the infinite cylinder about z."""
    (ox, oy), (dx, dy) = rays[:, :2].T, rays[:, 3:5].T
    a, b, c = dx * dx + dy * dy, ox * dx + oy * dy, ox * ox + oy * oy - BORE * BORE
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - a * c)
        enter, leave = (-b - root) / a, (-b + root) / a
    parallel = a == 0
    enter = np.where(parallel, np.where(c < 0, -np.inf, np.inf), enter)
    leave = np.where(parallel, np.where(c < 0, np.inf, -np.inf), leave)
    missed = np.isnan(enter)
    return np.where(missed, np.inf, enter), np.where(missed, -np.inf, leave)


def expect_cube(rays: Floats) -> tuple[Integers, npt.NDArray[np.bool_]]:
    """Boundary crossings of the cube, and on which rays they are beyond doubt."""
    enter, leave = _in_cube(rays)
    length = leave - enter
    return np.where(length > 0, 2, 0), np.abs(length) > CLEAR


def expect_bored_cube(rays: Floats) -> tuple[Integers, npt.NDArray[np.bool_]]:
    """Boundary crossings of the cube without the bore, and on which rays they are beyond doubt."""
    enter, leave = _in_cube(rays)
    bore_in, bore_out = _in_bore(rays)
    crossed = bore_in < bore_out
    bore_in, bore_out = np.where(crossed, bore_in, leave), np.where(crossed, bore_out, leave)
    before = np.minimum(bore_in, leave) - enter
    after = leave - np.maximum(bore_out, enter)
    hit = leave > enter
    parts = (hit & (before > 0)).astype(np.int64) + (hit & (after > 0))
    sure = (np.abs(leave - enter) > CLEAR) & (np.abs(before) > CLEAR)
    return 2 * parts, sure & ((np.abs(after) > CLEAR) | ~crossed)


def menger_cells(level: int) -> npt.NDArray[np.bool_]:
    """Which cells of a grid of 3^level belong to the sponge: no two middle digits at one place."""
    size = 3**level
    digits = np.arange(size)
    solid = np.ones((size, size, size), dtype=bool)
    for _ in range(level):
        middle = digits % 3 == 1
        x, y, z = middle[:, None, None], middle[None, :, None], middle[None, None, :]
        solid &= ~((x & y) | (y & z) | (z & x))
        digits = digits // 3
    return solid


def menger_cutters(level: int) -> list[tuple[tuple[int, int, int], tuple[int, int, int]]]:
    """Boxes (from, to) whose ends lie in the faces of the cube of side 3^level."""
    size = 3**level
    boxes = []
    for k in range(level):
        hole = 3**k
        starts = range(hole, size, 3 * hole)
        for a, b in product(starts, starts):
            boxes.append(((0, a, b), (size, a + hole, b + hole)))
            boxes.append(((a, 0, b), (a + hole, size, b + hole)))
            boxes.append(((a, b, 0), (a + hole, b + hole, size)))
    return boxes


def through_a_grid(size: int, count: int, seed: int) -> Floats:
    """``count`` rays through the cube from 0 to ``size``, askew to its faces."""
    rays = through_a_cube(count, seed)
    rays[:, :3] = (rays[:, :3] + 1) * (size / 2)
    rays[:, 3:] *= size / 2
    return rays


def between_grid_points(size: int, count: int, seed: int) -> Floats:
    """Rays between integer points of a grid: they meet its edges and corners all the time.

    Parameters at grid planes are quotients of integers below 15, so unequal ones are 1/225 apart.
    """
    rng = np.random.default_rng(seed)
    direction = rng.integers(1, 15, (count, 3)) * rng.choice([-1, 1], (count, 3))
    target = rng.integers(0, size + 1, (count, 3))
    steps = 3 + size // np.abs(direction).max(axis=1, keepdims=True)
    return np.hstack([target - direction * steps, direction]).astype(np.float64)


def without_slivers(distances: list[float]) -> int:
    """How many crossings are left when those at one place cancel in pairs."""
    left: list[float] = []
    for distance in distances:
        if left and distance - left[-1] <= CLEAR * max(1.0, abs(distance)):
            left.pop()
        else:
            left.append(distance)
    return len(left)


def expect_cells(
    rays: Floats, solid: npt.NDArray[np.bool_]
) -> tuple[Integers, npt.NDArray[np.bool_]]:
    """Boundary crossings of a union of grid cells, and which rays are clear of all edges.

    A ray through an edge counts as exact arithmetic would: what has no length is not there.
    """
    size = solid.shape[0]
    counts = np.zeros(len(rays), dtype=np.int64)
    sure = np.zeros(len(rays), dtype=bool)
    planes = np.arange(size + 1)
    for i, (origin, direction) in enumerate(zip(rays[:, :3], rays[:, 3:], strict=True)):
        t = np.sort(((planes[:, None] - origin) / direction).ravel())
        t = t[t > 0]
        gaps = np.diff(t)
        sure[i] = (gaps > CLEAR).all()
        middle = ((t[:-1] + t[1:]) / 2)[gaps > CLEAR]
        cell = np.floor(origin + middle[:, None] * direction).astype(np.int64)
        within = ((cell >= 0) & (cell < size)).all(axis=1)
        inside = np.zeros(len(cell) + 2, dtype=bool)
        inside[1:-1][within] = solid[tuple(cell[within].T)]
        counts[i] = np.count_nonzero(inside[1:] != inside[:-1])
    return counts, sure
