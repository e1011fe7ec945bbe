"""POV-Ray's scene language, which octray reads too."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from octray.bench.scene import GENERATIONS
from octray.bench.writers.text import rows

if TYPE_CHECKING:
    from typing import TextIO

    from octray.bench.scene import Floor, Look, Mesh, Scene


def vector(*values: float) -> str:
    """Give a vector with nine digits."""
    return "<" + ", ".join(f"{value:.9g}" for value in values) + ">"


def write(scene: Scene, file: TextIO) -> None:
    """Write the scene."""
    width, height = scene.size
    file.write(
        f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level {GENERATIONS}"
        " adc_bailout 0 }\n"
        f"camera {{\n  location {vector(*scene.eye)}\n  sky z up z right -x * {width} / {height}\n"
        f"  angle {scene.angle:.9g} look_at {vector(*scene.target)}\n}}\n"
        f"background {{ rgb {vector(*scene.background)} }}\n"
    )
    file.writelines(
        f"light_source {{ {vector(*light)} rgb {scene.brightness:.9g} }}\n"
        for light in scene.lights
    )
    file.writelines(f"#declare {look.name} = {_texture(look)}\n" for look in scene.looks)
    if scene.floor is not None:
        _floor(scene.floor, file)
    for spheres in scene.spheres:
        pattern = f"sphere {{ <%.9g, %.9g, %.9g>, %.9g texture {{ {spheres.look.name} }} }}\n"
        rows(file, pattern, np.column_stack([spheres.centers, spheres.radii]))
    for mesh in scene.meshes:
        _mesh(mesh, file)
    file.writelines(
        solids.text.replace("{look}", f"texture {{ {solids.look.name} }}")
        for solids in scene.solids
    )


def _texture(look: Look) -> str:
    finish = f"ambient 0 diffuse {look.diffuse:.9g} specular 0 phong 0 reflection {look.mirror:.9g}"
    return f"texture {{ pigment {{ rgb {vector(*look.color)} }} finish {{ {finish} }} }}"


def _floor(floor: Floor, file: TextIO) -> None:
    a, b, c, d = (vector(*corner) for corner in floor.corners)
    file.writelines(
        f"triangle {{ {', '.join(triangle)} texture {{ {floor.look.name} }} }}\n"
        for triangle in ((a, b, c), (a, c, d))
    )


def _mesh(mesh: Mesh, file: TextIO) -> None:
    file.write(f"mesh2 {{\nvertex_vectors {{ {len(mesh.vertices)}")
    rows(file, ",\n<%.9g, %.9g, %.9g>", mesh.vertices)
    file.write(f" }}\nface_indices {{ {len(mesh.faces)}")
    rows(file, ",\n<%d, %d, %d>", mesh.faces)
    file.write(f" }}\ntexture {{ {mesh.look.name} }}\n}}\n")
