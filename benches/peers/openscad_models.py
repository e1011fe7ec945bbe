"""OpenSCAD: the preview that its users look at, and the mesh that it exports."""

from __future__ import annotations

import re
import shutil
import subprocess
from typing import TYPE_CHECKING

import numpy as np
from report import Row, share

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SIZE = 400
CAMERA = "--camera=14,-22,24,0,0,0"


def bored(height: float) -> str:
    """A cube minus a cylinder."""
    cutter = f"cylinder(r = 3, h = {height}, center = true);"
    return f"$fn = 64; difference() {{ cube(10, center = true); {cutter} }}\n"


def run(model: Path, target: Path, *arguments: str) -> None:
    """One run of OpenSCAD; pictures need a display, if need be one that nobody sees."""
    command = ["openscad", str(model), "-o", str(target), *arguments]
    if target.suffix == ".png" and shutil.which("xvfb-run"):
        command = ["xvfb-run", "-a", "-s", "-screen 0 800x800x24", *command]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900, check=False)
    if done.returncode != 0 or not target.exists():
        raise RuntimeError(f"OpenSCAD could not make {target.name}:\n{done.stderr[-1000:]}")


def volume(path: Path) -> float:
    """Of a closed mesh in a text STL file."""
    numbers = re.findall(r"vertex\s+(\S+)\s+(\S+)\s+(\S+)", path.read_text(encoding="utf-8"))
    triangles = np.array(numbers, dtype=np.float64).reshape(-1, 3, 3)
    return float(np.linalg.det(triangles).sum() / 6)


def compare(folder: Path) -> Iterator[Row]:
    """Rows for OpenSCAD."""
    import octray

    flush, longer = folder / "flush.scad", folder / "longer.scad"
    flush.write_text(bored(10), encoding="utf-8")
    longer.write_text(bored(11), encoding="utf-8")

    mine = []
    for height in (10, 11):
        scene = octray.Scene(units="mm", up=(0, 0, 1))
        scene.add(octray.box(10) - octray.cylinder(r=3, h=height))
        scene.camera = octray.Camera.look_at(eye=(14, -22, 24), target=(0, 0, 0), fov=22.5)
        mine.append(scene.render(size=(SIZE, SIZE)).to_numpy())
    ours = int(np.count_nonzero((np.abs(mine[0] - mine[1]) > 1 / 255).any(axis=2)))
    try:
        from PIL import Image

        pictures = []
        for model in (flush, longer):
            target = model.with_suffix(".png")
            run(model, target, f"--imgsize={SIZE},{SIZE}", CAMERA)
            pictures.append(np.asarray(Image.open(target).convert("RGB"), dtype=np.float64))
        wrong = int(np.count_nonzero((np.abs(pictures[0] - pictures[1]) > 1).any(axis=2)))
        theirs = share(wrong, SIZE * SIZE)
    except (ImportError, RuntimeError) as error:
        theirs = f"not measured ({str(error).splitlines()[0]})"
    yield Row(
        "cube minus cylinder of equal height",
        "wrong pixels of the preview",
        "OpenSCAD",
        theirs,
        share(ours, SIZE * SIZE),
    )

    target = folder / "flush.stl"
    run(flush, target)
    exact = 1000 - 90 * np.pi
    prism = 1000 - 10 * 32 * 9 * np.sin(2 * np.pi / 64)
    got = volume(target)
    yield Row(
        "cube minus cylinder of equal height",
        "error of the exported mesh's volume, against the polygon that stands for the circle",
        "OpenSCAD",
        f"{abs(got - prism) / prism:.1g}",
        "no mesh",
    )
    yield Row(
        "cube minus cylinder of equal height",
        "the same, against the cylinder",
        "OpenSCAD",
        f"{abs(got - exact) / exact:.1g}",
        "no mesh",
    )
