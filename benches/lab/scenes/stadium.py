"""Stadium: a teapot set with beads, and a thousand times larger around it rings of seats.

The case that is told against uniform grids: a small object full of detail in a large one. Half
of the shapes are beads on the teapot, which fits into one voxel of any grid over the stadium.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

import numpy as np

from octray.bench.writers.text import rows
from scenes import pov

if TYPE_CHECKING:
    from scenes.nff import Floats

TITLE = "teapot in a stadium"
WHAT = "a teapot of exact solids set with beads, in a stadium a thousand times its size"
SUFFIX = ".pov"

#: Distance of the first ring of seats, and how far and high the last one is above it.
INNER, OUTER, RISE = 700.0, 1400.0, 420.0
#: Bezier curve of the body: distances from the axis and heights, each piece with four points.
BODY = np.array(
    [
        [(0.0, 0.0), (0.30, 0.0), (0.42, 0.0), (0.46, 0.04)],
        [(0.46, 0.04), (0.74, 0.30), (0.64, 0.66), (0.40, 0.80)],
        [(0.40, 0.80), (0.30, 0.80), (0.15, 0.80), (0.0, 0.80)],
    ]
)
LID = np.array(
    [
        [(0.0, 0.80), (0.15, 0.80), (0.30, 0.80), (0.38, 0.80)],
        [(0.38, 0.80), (0.34, 0.89), (0.14, 0.90), (0.05, 0.95)],
        [(0.05, 0.95), (0.03, 0.95), (0.02, 0.95), (0.0, 0.95)],
    ]
)
#: Shapes of which the teapot is made, without beads.
POT = 10


def count(level: int) -> dict[str, int]:
    """As many beads as seats, 5 x 10^level of each; the teapot; the field."""
    half = 5 * 10**level
    return {"beads": half, "seats": half, "parts of the teapot": POT, "field": 1}


def write(level: int, file: TextIO) -> None:
    """Write the scene."""
    half = 5 * 10**level
    pov.view(file, (-0.5, -2.9, 1.0), (0.06, 0, 0.62), angle=44)
    pov.lights(file, [(900, -2500, 3000), (-3, -4, 5)])
    field = f"cylinder {{ <0, 0, -20>, <0, 0, 0>, {INNER - 20:.9g}"
    file.write(f"{field} {pov.material((0.45, 0.62, 0.35))} }}\n")
    _teapot(file)
    _seats(file, half)
    # Beads are large where there are few, and never hide the teapot.
    size = min(0.03, 0.8 / np.sqrt(half))
    paint = pov.material((0.95, 0.8, 0.4), mirror=0.15)
    file.write(f"#declare Gold = {paint}\n")
    pattern = f"sphere {{ <%.9g, %.9g, %.9g>, {size:.9g} material {{ Gold }} }}\n"
    rows(file, pattern, beads(half))


def beads(number: int) -> Floats:
    """Places on the body's side, turned by the golden angle from one to the next."""
    fine = np.linspace(0, 1, 4096)
    r, z = _bezier(BODY[1], fine).T
    # Even over the surface: the area below every height, by the trapezoidal rule.
    strips = np.hypot(np.diff(r), np.diff(z)) * (r[1:] + r[:-1]) / 2
    area = np.concatenate([[0.0], np.cumsum(strips)])
    wanted = (0.03 + 0.94 * (np.arange(number) + 0.5) / number) * area[-1]
    r, z = _bezier(BODY[1], np.interp(wanted, area, fine)).T
    angle = np.arange(number) * np.pi * (3 - np.sqrt(5))
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def _bezier(points: Floats, t: Floats) -> Floats:
    s = 1 - t
    weights = np.column_stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3])
    return np.asarray(weights @ points)


def _lathe(pieces: Floats) -> str:
    """A body turned about z; POV-Ray turns about y."""
    points = ", ".join(pov.vector(*point) for piece in pieces for point in piece)
    return f"lathe {{ bezier_spline {4 * len(pieces)}, {points} rotate x * 90 }}"


def _teapot(file: TextIO) -> None:
    """One union: body, lid and knob, a spout of two cones and a lip, a handle of half a torus."""
    foot, knee, lip = (0.50, 0.0, 0.26), (0.86, 0.0, 0.50), (1.02, 0.0, 0.76)
    ring = "torus { 0.26, 0.05 translate <-0.53, 0, 0.45> }"
    parts = [
        _lathe(BODY),
        _lathe(LID),
        f"sphere {{ {pov.vector(0, 0, 0.99)}, 0.065 }}",
        f"cone {{ {pov.vector(*foot)}, 0.17, {pov.vector(*knee)}, 0.085 }}",
        f"sphere {{ {pov.vector(*knee)}, 0.087 }}",
        f"cone {{ {pov.vector(*knee)}, 0.085, {pov.vector(*lip)}, 0.055 }}",
        # The half of the ring that is outside; a ring lies about y.
        f"intersection {{ {ring} box {{ <-1, -0.2, 0>, <-0.53, 0.2, 1> }} }}",
        f"torus {{ 0.43, 0.03 rotate x * 90 translate z * {0.03:.9g} }}",
    ]
    paint = pov.material((0.85, 0.9, 0.95), mirror=0.2)
    file.write("union {\n  " + "\n  ".join(parts) + f"\n  {paint}\n}}\n")


def _seats(file: TextIO, number: int) -> None:
    """Boxes in rings; a ring starts where the one before it ends, so that all have seats."""
    rings = max(2, round(np.sqrt(number / 12)))
    ring = np.arange(number) * rings // number
    share = (ring + 0.5) / rings
    angle = np.degrees(2 * np.pi * np.arange(number) * rings / number)
    away, height = INNER + (OUTER - INNER) * share, RISE * share
    deep = (OUTER - INNER) / rings * 0.4
    tall = RISE / rings * 0.6
    wide = np.pi * INNER * rings / number * 0.8
    red, blue = (pov.material(color) for color in ((0.75, 0.25, 0.2), (0.25, 0.35, 0.7)))
    file.write(f"#declare Red = {red}\n#declare Blue = {blue}\n")
    size = pov.vector(deep, wide, tall)
    pattern = (
        f"box {{ -{size}, {size} translate <%.9g, 0, %.9g> rotate z * %.9g material {{ %s }} }}\n"
    )
    for paint, chosen in (("Red", ring % 2 == 0), ("Blue", ring % 2 == 1)):
        table = np.column_stack([away, height, angle])[chosen]
        rows(file, pattern.replace("%s", paint), table)
