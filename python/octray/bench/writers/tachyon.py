"""Tachyon's scene language. It knows no solids, so scenes of solids have none of it.

Its space is left-handed: everything is written with y turned round, which gives the same picture.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from octray.bench.scene import GENERATIONS
from octray.bench.writers.text import rows

if TYPE_CHECKING:
    from typing import TextIO

    from octray.bench.scene import Floats, Scene, Vector

_TURN = np.array([1.0, -1.0, 1.0])


def _words(vector: Vector | Floats) -> str:
    return " ".join(f"{value:.9g}" for value in (np.asarray(vector) * _TURN + 0.0).tolist())


def write(scene: Scene, file: TextIO) -> None:
    """Write the scene."""
    width, height = scene.size
    across = np.subtract(scene.target, scene.eye)
    # Its zoom is about the vertical field of view of a picture whose pixels are square.
    zoom = 0.5 / math.tan(math.radians(scene.angle / 2)) * width / height
    file.write(
        f"BEGIN_SCENE\nRESOLUTION {width} {height}\nCAMERA\n ZOOM {zoom:.9g}\n ASPECTRATIO 1.0\n"
        f" ANTIALIASING 0\n RAYDEPTH {GENERATIONS}\n CENTER {_words(scene.eye)}\n"
        f" VIEWDIR {_words(across / np.linalg.norm(across))}\n UPDIR 0 0 1\nEND_CAMERA\n"
        "BACKGROUND {:.9g} {:.9g} {:.9g}\n".format(*scene.background)
    )
    for light in scene.lights:
        color = " ".join([f"{scene.brightness:.9g}"] * 3)
        file.write(f"LIGHT CENTER {_words(light)} RAD 0.0001 COLOR {color}\n")
    for look in scene.looks:
        color = " ".join(f"{value:.9g}" for value in look.color)
        file.write(
            f"TEXDEF {look.name} AMBIENT 0 DIFFUSE {look.diffuse:.9g} SPECULAR {look.mirror:.9g}"
            f" OPACITY 1\n COLOR {color} TEXFUNC 0\n"
        )
    if scene.floor is not None:
        corners = np.array(scene.floor.corners)
        _triangles(corners[[[0, 1, 2], [0, 2, 3]]], scene.floor.look.name, file)
    for spheres in scene.spheres:
        pattern = f"SPHERE CENTER %.9g %.9g %.9g RAD %.9g {spheres.look.name}\n"
        rows(file, pattern, np.column_stack([spheres.centers * _TURN, spheres.radii]))
    for mesh in scene.meshes:
        _triangles(mesh.vertices[mesh.faces], mesh.look.name, file)
    file.write("END_SCENE\n")


def _triangles(corners: Floats, look: str, file: TextIO) -> None:
    """Write triangles of shape (n, 3, 3)."""
    pattern = f"TRI V0 %.9g %.9g %.9g V1 %.9g %.9g %.9g V2 %.9g %.9g %.9g {look}\n"
    rows(file, pattern, (corners * _TURN).reshape(-1, 9))
