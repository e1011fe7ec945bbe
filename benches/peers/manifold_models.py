"""Manifold: booleans of meshes that coincide, aligned and turned.

Turned operands are turned each by itself, once in one step and once in two, as parts of an assembly
are; the pieces then coincide but for rounding.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from rays import expect_cells, expect_cube, menger_cells, menger_cutters, rotated, through_a_cube
from raysect_solids import octray_sponge, through_a_grid
from report import Row, share

import octray

if TYPE_CHECKING:
    from collections.abc import Iterator

RAYS = 100_000


def shape(body: Any) -> str:
    """What is to be known of a mesh."""
    pieces = len(body.decompose())
    return f"{pieces} piece{'s' if pieces != 1 else ''}, {body.num_tri()} triangles"


def compare() -> Iterator[Row]:
    """Rows for Manifold."""
    from manifold3d import Manifold

    def cube(low: float, high: float) -> Any:
        return Manifold.cube([high - low, 2, 2]).translate([low, -1, -1])

    def mine(low: float, high: float) -> octray.Solid:
        return octray.box((high - low, 2, 2)).translate(x=(low + high) / 2)

    rays = through_a_cube(RAYS, 6)
    expected, sure = expect_cube(rays)
    turn = np.array(
        [[np.cos(a := np.radians(37)), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    )
    for name, first, second in (
        ("aligned", (0.0,), (0.0,)),
        ("turned by 37 degrees, and by 20 and 17", (37.0,), (20.0, 17.0)),
    ):
        a, b = cube(-1, 0.3), cube(0.3, 1)
        p, q = mine(-1, 0.3), mine(0.3, 1)
        for angle in first:
            a, p = a.rotate([0, 0, angle]), p.rotate(z=angle)
        for angle in second:
            b, q = b.rotate([0, 0, angle]), q.rotate(z=angle)
        scene = octray.Scene()
        scene.add(p + q)
        shot = rotated(rays, turn) if first != (0.0,) else rays
        wrong = np.count_nonzero(scene.count_intersections(shot)[sure] != expected[sure])
        yield Row(
            f"two abutting boxes, {name}",
            "their union; octray: rays with a wrong number of crossings",
            "Manifold",
            shape(a + b),
            share(wrong, int(sure.sum())),
        )
        whole = cube(-1, 1)
        for angle in second:
            whole = whole.rotate([0, 0, angle])
        one = mine(-1, 1)
        for angle in second:
            one = one.rotate(z=angle)
        rest = whole - a - b
        scene = octray.Scene()
        scene.add(one - p - q)
        yield Row(
            f"two abutting boxes, {name}",
            "the whole less both, which is empty; octray: rays that meet something",
            "Manifold",
            shape(rest),
            share(np.count_nonzero(scene.count_intersections(shot)), RAYS),
        )
    yield from sponge(3)


def sponge(level: int) -> Iterator[Row]:
    """A Menger sponge cut by coincident boxes."""
    from manifold3d import Manifold

    size = 3**level
    cutters = [
        Manifold.cube([b - a for a, b in zip(low, high, strict=True)]).translate(low)
        for low, high in menger_cutters(level)
    ]
    body = Manifold.cube([size] * 3) - Manifold.batch_boolean(cutters, _add())
    volume = 20**level
    rays = through_a_grid(size, RAYS // 10, 7)
    expected, sure = expect_cells(rays, menger_cells(level))
    rays, expected = rays[sure], expected[sure]
    wrong = np.count_nonzero(octray_sponge(level).count_intersections(rays) != expected)
    yield Row(
        f"Menger sponge of level {level} cut by {len(cutters)} boxes",
        "error of the volume; octray: rays with a wrong number of crossings",
        "Manifold",
        f"{abs(body.volume() - volume) / volume:.1g}, {shape(body)}",
        share(wrong, len(rays)),
    )


def _add() -> Any:
    from manifold3d import OpType

    return OpType.Add
