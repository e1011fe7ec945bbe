"""Tachyon."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from octray.bench.programs.program import Figures, number
from octray.bench.writers import tachyon

if TYPE_CHECKING:
    from octray.bench.process import Cost
    from octray.bench.scene import Scene


class Tachyon:
    """Tachyon 0.99; it knows no solids."""

    name = "Tachyon"

    def find(self) -> str:
        """Look on the path."""
        path = shutil.which("tachyon")
        if path is None:
            raise LookupError("tachyon is not on the path (apt: tachyon)")
        said = subprocess.run(  # noqa: S603 - what the user installed
            [path, os.devnull], capture_output=True, text=True, check=False, timeout=60
        )
        found = re.search(r"Version (\d[\w.]*)", said.stdout + said.stderr)
        return found[1] if found else "of unknown version"

    def objection(self, scene: Scene) -> str | None:
        """Refuse solids."""
        return "has no solids" if scene.solids else None

    def write(self, scene: Scene, folder: Path) -> None:
        """Write one file."""
        path = folder / f"{scene.name}.dat"
        if not path.exists():
            with path.open("w", encoding="ascii") as file:
                tachyon.write(scene, file)

    def command(self, scene: Scene, threads: int) -> list[str]:
        """Give the command, at best quality."""
        options = f"+V -fullshade -numthreads {threads} -format PPM".split()
        return [
            *("tachyon", f"{scene.name}.dat", *options),
            *("-o", "tachyon.ppm"),
        ]

    def environment(self, folder: Path) -> dict[str, str]:
        """Choose its library with threads: Debian's package of the MPI variant switches it off."""
        for threaded in Path("/usr/lib").glob("*/libtachyon-mt-thr.so.0"):
            link = folder / "tachyon-with-threads" / "libtachyon.so.0"
            link.parent.mkdir(exist_ok=True)
            if not link.is_symlink():
                link.symlink_to(threaded)
            return {"LD_LIBRARY_PATH": str(link.parent)}
        return {}

    def read(self, cost: Cost) -> Figures:
        """Read its statistics. It ends with status 0 whatever happens."""
        trace = number(cost.text, r"Ray Tracing Time:\s*([\d.]+)")
        parts = {
            "read": number(cost.text, r"Scene Parsing Time:\s*([\d.]+)"),
            "build": number(cost.text, r"Preprocessing Time:\s*([\d.]+)"),
        }
        return Figures(trace, parts)
