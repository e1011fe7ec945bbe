"""The scenes by name: families of any size, and the sets that are run together."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from octray.bench import shapes
from octray.bench.scene import Floor, Look, Mesh, Scene, Solids, Spheres
from octray.bench.writers.text import table

if TYPE_CHECKING:
    from collections.abc import Callable

#: What is run by default, in about a minute, and with ``--all``.
USUAL = ("balls4", "mesh70k", "csg10", "plate10")
ALL = (
    *("sphere", "balls4", "balls5", "balls6", "mesh70k", "mesh1m", "csg10", "csg20"),
    *("plate10", "plate32", "drilled10", "drilled20", "drilled40", "drilled80"),
)
#: Rings of vertices of the meshes.
MESHES = {"mesh70k": 187, "mesh1m": 707}

_BLUE, _GRAY = (0.078, 0.361, 0.753), (0.3, 0.4, 0.6)
_GROUND = Look("Ground", (0.9, 0.8, 0.6), 0.8, 0.2)
_METAL = Look("Metal", (0.9, 0.5, 0.3), 0.7, 0.3)
_STEEL = Look("Steel", (0.6, 0.7, 0.9), 0.7, 0.3)


def sphere() -> Scene:
    """Make one sphere on a stamp: what a command costs at least."""
    look = Look("Ball", (1, 0.9, 0.7), 0.7, 0.3)
    return Scene(
        "sphere",
        "one sphere on a picture of 32x24 pixels",
        eye=(2.1, 1.3, 1.7),
        target=(0, 0, 0),
        lights=((4, 3, 2),),
        background=_BLUE,
        counts={"spheres": 1},
        spheres=(Spheres(np.zeros((1, 3)), np.array([0.8]), look),),
        size=(32, 24),
    )


def balls(level: int) -> Scene:
    """Make a sphere flake on a floor."""
    generations = shapes.sphere_flake(level)
    centers = np.concatenate([places for places, _ in generations])
    radii = np.concatenate([np.full(len(places), radius) for places, radius in generations])
    look = Look("Ball", (1, 0.9, 0.7), 0.5, 0.5)
    return Scene(
        f"balls{level}",
        f"a flake of {len(radii):,} mirroring spheres on a floor, three lights",
        eye=(2.1, 1.3, 1.7),
        target=(0, 0, 0),
        lights=((4, 3, 2), (1, -4, 4), (-3, 1, 5)),
        background=_BLUE,
        counts={"spheres": len(radii)},
        floor=Floor(-0.5, 12, Look("Ground", (1, 0.75, 0.33), 1, 0)),
        spheres=(Spheres(centers, radii, look),),
        without={"Mitsuba": "needs gigabytes for so many spheres"} if level > 5 else {},  # noqa: PLR2004
    )


def mesh(name: str) -> Scene:
    """Make a ball with bumps, of triangles."""
    vertices, faces = shapes.bumpy_ball(MESHES[name])
    return Scene(
        name,
        f"a bumpy ball of {len(faces):,} flat triangles on a floor, two lights",
        eye=(2.6, 1.8, 1.9),
        target=(0, 0, 0),
        lights=((4, 3, 3), (1, -4, 4)),
        background=_GRAY,
        counts={"triangles": len(faces)},
        floor=Floor(-1.25, 8, _GROUND),
        meshes=(Mesh(vertices, faces, Look("Glaze", (0.8, 0.85, 0.9), 0.7, 0.3)),),
    )


def csg(side: int) -> Scene:
    """Make a lattice of cubes, each with three bores."""
    ticks = np.arange(side) * 1.5 - (side - 1) * 0.75
    places = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    cube = (
        "#declare Bored = difference {\n  box { <-.5, -.5, -.5>, <.5, .5, .5> }\n"
        "  cylinder { <-.6, 0, 0>, <.6, 0, 0>, .35 }\n"
        "  cylinder { <0, -.6, 0>, <0, .6, 0>, .35 }\n"
        "  cylinder { <0, 0, -.6>, <0, 0, .6>, .35 }\n  {look}\n}\n"
    )
    reach = side * 0.75
    return Scene(
        f"csg{side}",
        f"{side**3:,} cubes with three bores each on a floor, two lights",
        eye=(1.9 * reach + 4, 1.4 * reach + 3, 1.5 * reach + 2),
        target=(0, 0, 0),
        lights=((60, 30, 50), (10, -60, 70)),
        background=_GRAY,
        counts={"operands": 4 * side**3},
        floor=Floor(-reach - 0.5, 80, _GROUND),
        solids=(
            Solids(cube + table("object { Bored translate <%.9g, %.9g, %.9g> }\n", places), _METAL),
        ),
    )


def plate(side: int) -> Scene:
    """Make one difference: a slab minus slanting cylinders and as many spheres."""
    pitch = 10.0 / side
    ticks = -5 + pitch * (np.arange(side) + 0.5)
    x, y = (grid.ravel() for grid in np.meshgrid(ticks, ticks, indexing="ij"))
    slant, bore = np.full_like(x, pitch * 0.1), np.full_like(x, pitch * 0.25)
    aside, ball = pitch * 0.3, np.full_like(x, pitch * 0.3)
    cutters = np.column_stack([x - slant, y, x + slant, y, bore, x + aside, y + aside, ball])
    text = "difference {\n  box { <-5, -5, -.5>, <5, 5, .5> }\n" + table(
        "  cylinder { <%.9g, %.9g, -1>, <%.9g, %.9g, 1>, %.9g }\n"
        "  sphere { <%.9g, %.9g, .5>, %.9g }\n",
        cutters,
    )
    return Scene(
        f"plate{side}",
        f"a slab with {2 * side * side:,} cutters in one difference on a floor, two lights",
        eye=(9, 7, 9),
        target=(0, 0, 0),
        lights=((20, 10, 30), (5, -20, 25)),
        background=_GRAY,
        counts={"operands": 1 + 2 * side * side},
        floor=Floor(-2, 40, _GROUND),
        solids=(Solids(text + "  {look}\n}\n", _STEEL),),
    )


def drilled(side: int) -> Scene:
    """Make one difference: a plate minus upright cylinders that go through it."""
    x, y, radius = shapes.holes(side).T
    corner = ", ".join(f"{value:.9g}" for value in (shapes.HALF, shapes.HALF, shapes.THICK))
    reach = 2 * shapes.THICK
    text = f"difference {{\n  box {{ -<{corner}>, <{corner}> }}\n" + table(
        f"  cylinder {{ <%.9g, %.9g, {-reach:.9g}>, <%.9g, %.9g, {reach:.9g}>, %.9g }}\n",
        np.column_stack([x, y, x, y, radius]),
    )
    return Scene(
        f"drilled{side}",
        f"a plate with {side * side:,} holes, one difference, two lights",
        eye=(-1.7, -2.5, 1.95),
        target=(0, -0.05, -0.12),
        lights=((4, -2, 6), (-5, 1, 3)),
        background=(0.35, 0.52, 0.75),
        counts={"operands": 1 + side * side},
        floor=Floor(-0.35, 12, Look("Ground", (0.75, 0.72, 0.66), 0.8, 0)),
        solids=(Solids(text + "  {look}\n}\n", _STEEL),),
        size=(320, 240),
        angle=48,
    )


#: Families whose names end in a number, the largest number, and what it says.
FAMILIES: dict[str, tuple[Callable[[int], Scene], int, str]] = {
    "balls": (balls, 7, "generations of spheres, nine on each"),
    "csg": (csg, 100, "bored cubes along an edge of a lattice"),
    "plate": (plate, 1000, "cutters of each kind along a side of one difference"),
    "drilled": (drilled, 1000, "holes along a side of one difference"),
}


def check(name: str) -> None:
    """Raise ``ValueError`` with what there is if no scene has this name; cheap."""
    if name == "sphere" or name in MESHES:
        return
    found = re.fullmatch(r"([a-z]+)([0-9]{1,9})", name, re.ASCII)
    if found is not None and found[1] in FAMILIES:
        _, largest, what = FAMILIES[found[1]]
        least = 0 if found[1] == "balls" else 1
        if least <= int(found[2]) <= largest:
            return
        raise ValueError(f"{name}: the number, {what}, is {least} to {largest}")
    families = ", ".join(f"{family}N" for family in FAMILIES)
    known = ", ".join(["sphere", *MESHES])
    raise ValueError(f"there is no scene {name!r}; there are {known}, {families}")


def make(name: str) -> Scene:
    """Make a scene. Raises ``ValueError`` where ``check`` does."""
    check(name)
    if name == "sphere":
        return sphere()
    if name in MESHES:
        return mesh(name)
    family = name.rstrip("0123456789")
    return FAMILIES[family][0](int(name.removeprefix(family)))
