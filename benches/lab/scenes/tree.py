"""Tree: a trunk that forks, and whose branches fork; cones with a sphere at every fork.

After the *tree* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987), which follows
the two-way branching of Aono and Kunii (IEEE CG&A 4(5), 1984): each branch bears two, shorter and
thinner, at two angles to it and turned about it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

import numpy as np

from scenes import nff

if TYPE_CHECKING:
    from scenes.nff import Floats

TITLE = "tree"
WHAT = "a branching tree of long thin cones and spheres, seven lights"
SUFFIX = ".nff"

#: Radius at the foot, and how much thinner a branch is at its end than at its start.
FOOT, THINNER = 0.15, 0.67
#: Of the two branches: length against the parent's, angle to it, turn about it in degrees.
FORKS = [(0.65, 40.0, 0.0), (0.7, 25.0, 140.0)]


def count(level: int) -> dict[str, int]:
    """Shapes after so many forks: 2^(level + 1) - 1 branches."""
    branches = 2 ** (level + 1) - 1
    return {"cones": branches, "spheres": branches, "polygons": 1}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    nff.view(file, (4.5, 0.4, 2), (0, 0, 1.4), angle=40)
    places = [(-5.0, 5.0, 50.0), (30, -30, 30), (-40, -30, 20), (10, 30, 40)]
    nff.lights(file, [*places, (-30, 40, 10), (50, 25, 20), (-10, -60, 30)])
    nff.material(file, (0.45, 0.7, 0.35))
    nff.square(file, 50, 0)
    nff.material(file, (0.6, 0.42, 0.25))
    for base, tip, thick, thin in branches(level):
        nff.cones(file, base, thick, tip, thin)
        nff.spheres(file, tip, thin)


def branches(level: int) -> list[tuple[Floats, Floats, float, float]]:
    """Of every generation: feet, tips, the radius there and here."""
    turns = np.array([_turn(angle, about) for _, angle, about in FORKS])
    shorter = np.array([ratio for ratio, _, _ in FORKS])
    base, frames, lengths, thick = np.zeros((1, 3)), np.eye(3)[None], np.ones(1), FOOT
    generations = []
    for _ in range(level + 1):
        tip = base + frames[:, :, 2] * lengths[:, None]
        generations.append((base, tip, thick, thick * THINNER))
        base = np.repeat(tip, len(FORKS), axis=0)
        frames = np.einsum("nij,kjl->nkil", frames, turns).reshape(-1, 3, 3)
        lengths = np.outer(lengths, shorter).ravel()
        thick *= THINNER
    return generations


def _turn(angle: float, about: float) -> Floats:
    """Tilt z by one angle towards x, then turn about z by another; degrees."""
    a, b = np.radians([angle, about])
    tilt = [[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]]
    turn = [[np.cos(b), -np.sin(b), 0], [np.sin(b), np.cos(b), 0], [0, 0, 1]]
    return np.asarray(np.array(turn) @ np.array(tilt))
