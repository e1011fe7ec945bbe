"""Mitsuba 3."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from octray.bench.programs.files import write_mitsuba
from octray.bench.programs.program import Figures, number

if TYPE_CHECKING:
    from pathlib import Path

    from octray.bench.process import Cost
    from octray.bench.scene import Scene

#: Renders twice: the first picture belongs to the command, the second is what tracing costs.
_MITSUBA = """\
import sys, time
import drjit
drjit.set_thread_count(int(sys.argv[2]))
import mitsuba
mitsuba.set_variant("scalar_rgb")
times = [time.perf_counter()]
scene = mitsuba.load_file(sys.argv[1])
times.append(time.perf_counter())
mitsuba.util.write_bitmap(sys.argv[3], mitsuba.render(scene, spp=1, seed=0), write_async=False)
times.append(time.perf_counter())
mitsuba.render(scene, spp=1, seed=1)
times.append(time.perf_counter())
print("read %.9f first %.9f second %.9f" % tuple(b - a for a, b in zip(times, times[1:])))
"""


@dataclass
class Mitsuba:
    """Mitsuba 3 in its plain variant, which has Embree inside. It follows paths: like our work."""

    #: A Python that has it; this one by default.
    python: str | None = None
    name = "Mitsuba"

    def _python(self) -> str:
        return self.python or os.environ.get("OCTRAY_MITSUBA") or sys.executable

    def find(self) -> str:
        """Ask the Python that has it."""
        python = self._python()
        if python == sys.executable and importlib.util.find_spec("mitsuba") is None:
            raise LookupError("this Python has no mitsuba (pip: mitsuba; see --mitsuba)")
        try:
            said = subprocess.run(  # noqa: S603 - what the user named
                [python, "-c", "import mitsuba; print(mitsuba.__version__)"],
                capture_output=True,
                text=True,
                check=True,
                timeout=120,
            )
        except (OSError, subprocess.SubprocessError) as error:
            raise LookupError(f"{python} does not import mitsuba") from error
        return said.stdout.strip()

    def objection(self, scene: Scene) -> str | None:
        """Refuse solids."""
        return "has no solids" if scene.solids else None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the scene and its meshes."""
        write_mitsuba(scene, folder)

    def command(self, scene: Scene, threads: int) -> list[str]:
        """Give a script's call; Mitsuba's own command does not render twice."""
        files = [f"{scene.name}.xml", str(threads), "mitsuba.png"]
        return [self._python(), "-c", _MITSUBA, *files]

    def environment(self, _folder: Path) -> dict[str, str]:
        """Nothing."""
        return {}

    def read(self, cost: Cost) -> Figures:
        """Read the three times."""
        first, second = (number(cost.text, rf"{word} ([\d.]+)") for word in ("first", "second"))
        parts = {"read": number(cost.text, r"read ([\d.]+)"), "first render": first}
        return Figures(second, parts, extra_s=second)
