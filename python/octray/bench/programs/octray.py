"""octray itself, by its command line and from Python."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from octray._core import __version__
from octray.bench.process import RunError
from octray.bench.programs.files import write_mitsuba, write_pov
from octray.bench.programs.program import Figures
from octray.bench.writers import script

if TYPE_CHECKING:
    from octray.bench.process import Cost
    from octray.bench.scene import Scene

#: The program that the others are compared with.
YARDSTICK = "octray"


def _phases(cost: Cost) -> Figures:
    """Read the JSON object that octray prints."""
    try:
        report = json.loads(cost.text)
        phases: dict[str, float] = report["phases"]
        rays = int(report["rays"]["total"])
    except (ValueError, KeyError) as error:
        raise RunError("failed", "it did not print its report") from error
    parts = {name.removesuffix("_s"): seconds for name, seconds in phases.items()}
    parts["read"] = parts.pop("import")
    return Figures(phases["render_s"], parts, rays)


class Octray:
    """octray's command line, which reads the file that POV-Ray reads."""

    name = YARDSTICK

    def find(self) -> str:
        """Give the version; it is here."""
        return __version__

    def objection(self, _scene: Scene) -> str | None:
        """Render everything."""
        return None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write one file."""
        write_pov(scene, folder)

    def command(self, scene: Scene, threads: int) -> list[str]:
        """Give what a user types."""
        width, height = scene.size
        options = f"--size {width}x{height} --threads {threads} --json --quiet".split()
        command = [sys.executable, "-m", "octray", "render", f"{scene.name}.pov"]
        return [*command, "-o", "octray.png", *options]

    def environment(self, _folder: Path) -> dict[str, str]:
        """Let it find the octray that is running."""
        here = str(Path(__file__).resolve().parents[3])
        return {"PYTHONPATH": os.pathsep.join(filter(None, [here, os.environ.get("PYTHONPATH")]))}

    def read(self, cost: Cost) -> Figures:
        """Read its report."""
        return _phases(cost)


class OctrayPython(Octray):
    """octray called from Python, which takes meshes from binary files."""

    name = "octray, Python"

    def objection(self, scene: Scene) -> str | None:
        """Only meshes come in binary files. An empty picture tells what it costs by itself."""
        if scene.counts.keys() - {"triangles"}:
            return "is for meshes in binary files"
        return None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the script and the meshes."""
        write_mitsuba(scene, folder)
        with (folder / f"{scene.name}.py").open("w", encoding="utf-8") as file:
            script.write(scene, file)

    def command(self, scene: Scene, threads: int) -> list[str]:
        """Run the script."""
        return [sys.executable, f"{scene.name}.py", "octray-python.png", str(threads)]
