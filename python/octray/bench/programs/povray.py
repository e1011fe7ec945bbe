"""POV-Ray."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from typing import TYPE_CHECKING

from octray.bench.programs.files import write_pov
from octray.bench.programs.program import Figures, number

if TYPE_CHECKING:
    from pathlib import Path

    from octray.bench.process import Cost
    from octray.bench.scene import Scene


@dataclass
class PovRay:
    """POV-Ray 3.7, by its own choice of structure or with its BSP tree (``+BM2``)."""

    bsp: bool = False

    def __post_init__(self) -> None:
        """Name it."""
        self.name = "POV-Ray +BM2" if self.bsp else "POV-Ray"

    def find(self) -> str:
        """Look on the path."""
        path = shutil.which("povray")
        if path is None:
            raise LookupError("povray is not on the path (apt: povray)")
        said = subprocess.run(  # noqa: S603 - what the user installed
            [path, "--version"], capture_output=True, text=True, check=False, timeout=60
        )
        found = re.search(r"POV-Ray (\d[\w.]*)", said.stdout + said.stderr)
        return found[1] if found else "of unknown version"

    def objection(self, _scene: Scene) -> str | None:
        """Render everything."""
        return None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write one file."""
        write_pov(scene, folder)

    def command(self, scene: Scene, threads: int) -> list[str]:
        """Give the command for the same picture, without display and pauses."""
        width, height = scene.size
        options = f"+FN +W{width} +H{height} +WT{threads} -A -D -P".split()
        files = [f"+I{scene.name}.pov", "+Opovray.png"]
        return ["povray", *files, *options, *(["+BM2"] if self.bsp else [])]

    def environment(self, _folder: Path) -> dict[str, str]:
        """Nothing."""
        return {}

    def read(self, cost: Cost) -> Figures:
        """Read its statistics."""
        trace = number(cost.text, r"Trace Time:.*?\(([\d.]+) sec")
        parts = {"read": number(cost.text, r"Parse Time:.*?\(([\d.]+) sec")}
        counts = re.findall(r"^(?:Rays|Shadow Ray Tests):\s+(\d+)", cost.text, re.MULTILINE)
        return Figures(trace, parts, sum(map(int, counts)) or None)
