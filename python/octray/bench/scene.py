"""A scene as every program can be told it: shapes, looks, point lights, a pinhole camera.

Right-handed, z up, lengths without a unit. Every program is asked for the same work: one ray for
each pixel, hard shadows, mirrors, five generations of rays; nothing glows, nothing has highlights.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Vector: TypeAlias = tuple[float, float, float]
Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int32]

#: Generations of rays, primary rays included.
GENERATIONS = 5


@dataclass(frozen=True)
class Look:
    """A dull colour under a mirror: shares of the light, each 0 to 1."""

    name: str
    color: Vector
    diffuse: float
    mirror: float


@dataclass(frozen=True)
class Floor:
    """A level square of two triangles about the z axis."""

    height: float
    half: float
    look: Look

    @property
    def corners(self) -> list[Vector]:
        """The four corners, counter-clockwise from above."""
        h, e = self.height, self.half
        return [(-e, -e, h), (e, -e, h), (e, e, h), (-e, e, h)]


@dataclass(frozen=True)
class Spheres:
    """Spheres: centres (n, 3) and radii (n,)."""

    centers: Floats
    radii: Floats
    look: Look


@dataclass(frozen=True)
class Mesh:
    """Flat triangles: vertices (n, 3), and three of their numbers for each triangle (m, 3)."""

    vertices: Floats
    faces: Integers
    look: Look


@dataclass(frozen=True)
class Solids:
    """CSG in POV-Ray's language; ``{look}`` stands where the texture belongs."""

    text: str
    look: Look


@dataclass(frozen=True)
class Scene:
    """A scene, and the size of its picture in pixels."""

    name: str
    #: What there is to see, in words.
    title: str
    eye: Vector
    target: Vector
    lights: tuple[Vector, ...]
    background: Vector
    #: The shapes that the scene is about, by kind; the floor is not counted.
    counts: dict[str, int]
    floor: Floor | None = None
    spheres: tuple[Spheres, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    solids: tuple[Solids, ...] = ()
    size: tuple[int, int] = (512, 512)
    #: The horizontal field of view in degrees.
    angle: float = 45.0
    #: Names of programs that are not asked, and why.
    without: dict[str, str] = field(default_factory=dict)

    @property
    def shapes(self) -> int:
        """How many shapes there are."""
        return sum(self.counts.values())

    @property
    def brightness(self) -> float:
        """The strength of each light."""
        return 1 / math.sqrt(max(len(self.lights), 1))

    @property
    def looks(self) -> list[Look]:
        """All looks, each once."""
        looks = [spheres.look for spheres in self.spheres]
        looks += [mesh.look for mesh in self.meshes]
        looks += [solids.look for solids in self.solids]
        if self.floor is not None:
            looks.append(self.floor.look)
        return list({look.name: look for look in looks}.values())

    def emptied(self) -> Scene:
        """Give the same view of nothing: what a program costs before it meets a shape."""
        width, height = self.size
        return replace(
            self,
            name=f"empty{width}x{height}",
            title="nothing at all, for what a program costs by itself",
            counts={},
            floor=None,
            spheres=(),
            meshes=(),
            solids=(),
            without={},
        )
