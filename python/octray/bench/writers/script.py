"""A Python script that renders the scene with octray and takes its meshes from binary files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octray.bench.scene import GENERATIONS
from octray.bench.writers import ply

if TYPE_CHECKING:
    from typing import TextIO

    from octray.bench.scene import Look, Scene

_BEGIN = '''\
"""{title}; usage: {name}.py PICTURE THREADS."""
import json
import sys
import time
from pathlib import Path

start = time.perf_counter()
import octray

imported = time.perf_counter()
scene = octray.Scene()
scene.background = {background}
scene.camera = octray.Camera.look_at({eye}, {target}, fov={angle!r})
for place in {lights}:
    scene.add_light(octray.PointLight(place, ({brightness!r},) * 3))
'''
_END = """\
read = time.perf_counter()
scene.prepare(threads=int(sys.argv[2]))
built = time.perf_counter()
image = scene.render(
    size={size}, threads=int(sys.argv[2]), max_depth={generations}, threshold=0, view="standard"
)
rendered = time.perf_counter()
image.save(sys.argv[1], view="standard")
written = time.perf_counter()
phases = {{
    "import_s": read - imported,
    "build_s": built - read,
    "render_s": image.report["phases"]["render_s"],
    "write_s": written - rendered,
}}
print(json.dumps({{"phases": phases, "rays": image.report["rays"]}}))
"""


def write(scene: Scene, file: TextIO) -> None:
    """Write the script; its meshes are the files beside it that are written for Mitsuba."""
    if scene.spheres or scene.solids:
        raise ValueError(f"{scene.name} has more than a floor and meshes")
    file.write(
        _BEGIN.format(
            title=scene.title.capitalize(),
            name=scene.name,
            background=list(scene.background),
            eye=scene.eye,
            target=scene.target,
            angle=scene.angle,
            lights=scene.lights,
            brightness=scene.brightness,
        )
    )
    if scene.floor is not None:
        _add(file, repr((scene.floor.corners, [(0, 1, 2), (0, 2, 3)])), scene.floor.look)
    for number, mesh in enumerate(scene.meshes):
        path = f"Path(__file__).with_name({ply.name(scene.name, number)!r})"
        _add(file, path, mesh.look)
    file.write(_END.format(size=scene.size, generations=GENERATIONS))


def _add(file: TextIO, mesh: str, look: Look) -> None:
    """Write the call that adds a mesh, an expression for a path or for arrays."""
    material = (
        f"octray.Material({look.color}, name={look.name!r}, ambient=0, diffuse={look.diffuse!r},"
        f" reflection={look.mirror!r})"
    )
    file.write(f"scene.add_mesh({mesh}, material={material}, solid=False)\n")
