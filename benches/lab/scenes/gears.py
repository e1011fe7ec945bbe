"""Gears: storeys of meshing toothed wheels, each an exact prism, over a mirror.

After the *gears* of Haines' Standard Procedural Databases (IEEE CG&A 7(11), 1987): n x n x n
wheels. There they are polygons; here each wheel is one solid of 144 sides and two ends.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, TextIO

import numpy as np

from scenes import pov

if TYPE_CHECKING:
    from scenes.nff import Floats, Vector

TITLE = "gears"
WHAT = "toothed wheels, prisms of 146 faces each, some of glass, over a mirror"
SUFFIX = ".pov"

TEETH = 36
#: Radii of the teeth's feet and tips, for wheels whose axes are 1 apart; height of a wheel, and
#: of a storey.
FOOT, TIP, THICK, STOREY = 0.47, 0.52, 0.1, 0.5
#: Share of the pitch that a tooth takes at its foot and at its tip: less than half, so that
#: wheels that mesh do not touch.
WIDE, NARROW = 0.46, 0.26
COLORS: list[Vector] = [
    (0.9, 0.55, 0.25),
    (0.85, 0.3, 0.3),
    (0.25, 0.75, 0.6),
    (0.9, 0.85, 0.75),
    (0.35, 0.5, 0.85),
]


def count(level: int) -> dict[str, int]:
    """Faces of (level + 1)^3 wheels, and the floor."""
    wheels = (level + 1) ** 3
    return {"faces of prisms": wheels * (4 * TEETH + 2), "floor": 1}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    side = level + 1
    # As seen over the whole block, whose middle is at the origin.
    away = 0.35 + 0.65 * side
    top = STOREY * side
    pov.view(file, (-1.1 * away, -2.0 * away, top + 1.0 * away), (0, 0, top * 0.4), angle=48)
    pov.lights(file, [(2.0 * side, 4 * side, 4 * side), (-3.0 * side, -1.5 * side, 5 * side)])
    floor = pov.material((0.75, 0.75, 0.8), mirror=0.5)
    file.write(f"plane {{ z, 0 {floor} }}\n")
    corners = outline()
    places = ", ".join(pov.vector(*corner) for corner in [*corners, corners[0]])
    # A prism is swept along y.
    file.write(
        f"#declare Wheel = prism {{ linear_sweep linear_spline {-THICK / 2:.9g}, {THICK / 2:.9g},"
        f" {len(corners) + 1}, {places} rotate x * 90 }}\n"
    )
    for index, color in enumerate(COLORS):
        glass = 0.75 if index == 3 else 0.0
        file.write(f"#declare Paint{index} = {pov.material(color, glass=glass, mirror=0.1)}\n")
    for i, j, k in itertools.product(range(side), repeat=3):
        x, y, z = i - (side - 1) / 2, j - (side - 1) / 2, STOREY * k + STOREY / 2
        # Of two neighbours one turns a tooth, the other a gap towards the other.
        turn = (i + j) % 2 * 180 / TEETH
        paint = (i + 2 * j + 3 * k + i * j) % len(COLORS)
        file.write(
            f"object {{ Wheel rotate z * {turn:.9g} translate {pov.vector(x, y, z)}"
            f" material {{ Paint{paint} }} }}\n"
        )


def outline() -> Floats:
    """Corners of a wheel, four for each tooth; a tooth points along the first axis."""
    pitch = 2 * np.pi / TEETH
    offsets = np.array([-WIDE, -NARROW, NARROW, WIDE]) / 2 * pitch
    angles = (np.arange(TEETH)[:, None] * pitch + offsets).ravel()
    radii = np.tile([FOOT, TIP, TIP, FOOT], TEETH)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
