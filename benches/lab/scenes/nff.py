"""Writes scenes in the Neutral File Format: a view, lights, then materials and shapes in order."""

from __future__ import annotations

from typing import TYPE_CHECKING, TextIO

import numpy as np

from octray.bench.writers.text import rows

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    Floats = npt.NDArray[np.float64]

Vector = tuple[float, float, float]


def words(*values: float) -> str:
    """Numbers with nine digits, which is enough for a place in a scene."""
    return " ".join(f"{value:.9g}" for value in values)


def view(
    file: TextIO, eye: Vector, target: Vector, *, up: Vector = (0, 0, 1), angle: float = 45
) -> None:
    """Begin a file with its background and camera; the picture is four by three."""
    file.write("b 0.62 0.74 0.88\nv\n")
    file.write(f"from {words(*eye)}\nat {words(*target)}\nup {words(*up)}\n")
    file.write(f"angle {words(angle)}\nhither 0.01\nresolution 320 240\n")


def lights(file: TextIO, places: Sequence[Vector]) -> None:
    """Point lights; all share one strength."""
    file.writelines(f"l {words(*place)}\n" for place in places)


def material(
    file: TextIO,
    color: Vector,
    *,
    diffuse: float = 0.8,
    mirror: float = 0.0,
    shine: float = 20.0,
    glass: float = 0.0,
    ior: float = 1.0,
) -> None:
    """What the shapes after it are made of; all shares between 0 and 1."""
    file.write(f"f {words(*color, diffuse, mirror, shine, glass, ior)}\n")


def spheres(file: TextIO, centers: Floats, radii: Floats | float) -> None:
    """Spheres: centres of shape (n, 3)."""
    rows(file, "s %.9g %.9g %.9g %.9g\n", _beside(centers, radii))


def cones(
    file: TextIO, base: Floats, base_radii: Floats | float, tip: Floats, tip_radii: Floats | float
) -> None:
    """Open cones, cylinders where both radii are equal."""
    table = np.hstack([_beside(base, base_radii), _beside(tip, tip_radii)])
    rows(file, "c %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", table)


def polygons(file: TextIO, corners: Floats) -> None:
    """Polygons with equally many corners: shape (n, corners, 3)."""
    count = corners.shape[1]
    pattern = f"p {count}\n" + "%.9g %.9g %.9g\n" * count
    rows(file, pattern, corners.reshape(len(corners), -1))


def square(file: TextIO, half: float, z: float) -> None:
    """A level square about the z axis, to stand on."""
    corners = [(half, half, z), (-half, half, z), (-half, -half, z), (half, -half, z)]
    polygons(file, np.array([corners]))


def _beside(points: Floats, radii: Floats | float) -> Floats:
    return np.hstack([points, np.broadcast_to(radii, len(points))[:, None]])
