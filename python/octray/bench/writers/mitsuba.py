"""Mitsuba's XML. Not the same work, only like it: it follows paths, and tosses for the mirror.

A path takes a mirror or a dull surface by chance, and light bounces off dull surfaces. It knows no
solids. Meshes are in PLY files beside it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from octray.bench.scene import GENERATIONS
from octray.bench.writers import ply
from octray.bench.writers.text import rows

if TYPE_CHECKING:
    from pathlib import Path
    from typing import TextIO

    from octray.bench.scene import Look, Scene


def write(scene: Scene, file: TextIO, folder: Path) -> None:
    """Write the scene, and its meshes into the folder."""
    width, height = scene.size
    eye, target = (", ".join(f"{v:.9g}" for v in place) for place in (scene.eye, scene.target))
    file.write(
        '<scene version="3.0.0">\n'
        f'<integrator type="path"><integer name="max_depth" value="{GENERATIONS + 1}"/>'
        '<integer name="rr_depth" value="100"/></integrator>\n'
        f'<sensor type="perspective"><float name="fov" value="{scene.angle:.9g}"/>'
        f'<transform name="to_world"><lookat origin="{eye}" target="{target}" up="0, 0, 1"/>'
        '</transform><sampler type="independent"><integer name="sample_count" value="1"/></sampler>'
        f'<film type="hdrfilm"><integer name="width" value="{width}"/>'
        f'<integer name="height" value="{height}"/><rfilter type="box"/></film></sensor>\n'
    )
    for light in scene.lights:
        # Its lights fade with the distance: as bright as the others' at the scene's middle.
        power = scene.brightness * math.pi * math.dist(light, scene.target) ** 2
        x, y, z = light
        file.write(
            f'<emitter type="point"><point name="position" x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>'
            f'<rgb name="intensity" value="{power:.9g}"/></emitter>\n'
        )
    sky = ", ".join(f"{value:.9g}" for value in scene.background)
    file.write(f'<emitter type="constant"><rgb name="radiance" value="{sky}"/></emitter>\n')
    file.writelines(_material(look) for look in scene.looks)
    if scene.floor is not None:
        file.write(
            '<shape type="rectangle"><transform name="to_world">'
            f'<scale value="{scene.floor.half:.9g}"/><translate z="{scene.floor.height:.9g}"/>'
            f'</transform><ref id="{scene.floor.look.name}"/></shape>\n'
        )
    for spheres in scene.spheres:
        pattern = (
            '<shape type="sphere"><point name="center" x="%.9g" y="%.9g" z="%.9g"/>'
            f'<float name="radius" value="%.9g"/><ref id="{spheres.look.name}"/></shape>\n'
        )
        rows(file, pattern, np.column_stack([spheres.centers, spheres.radii]))
    for number, mesh in enumerate(scene.meshes):
        name = ply.name(scene.name, number)
        with (folder / name).open("wb") as binary:
            ply.write(mesh, binary)
        file.write(
            f'<shape type="ply"><string name="filename" value="{name}"/>'
            f'<boolean name="face_normals" value="true"/><ref id="{mesh.look.name}"/></shape>\n'
        )
    file.write("</scene>\n")


def _material(look: Look) -> str:
    color = ", ".join(f"{value * look.diffuse / (1 - look.mirror):.9g}" for value in look.color)
    return (
        f'<bsdf type="twosided" id="{look.name}"><bsdf type="blendbsdf">'
        f'<float name="weight" value="{look.mirror:.9g}"/>'
        f'<bsdf type="diffuse"><rgb name="reflectance" value="{color}"/></bsdf>'
        '<bsdf type="conductor"><string name="material" value="none"/></bsdf></bsdf></bsdf>\n'
    )
