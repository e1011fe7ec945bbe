"""The programs that render the scenes."""

from __future__ import annotations

from octray.bench.programs.mitsuba import Mitsuba
from octray.bench.programs.octray import YARDSTICK, Octray, OctrayPython
from octray.bench.programs.povray import PovRay
from octray.bench.programs.program import Figures, Program
from octray.bench.programs.tachyon import Tachyon

__all__ = ["YARDSTICK", "Figures", "Program", "programs"]


def programs(python: str | None = None) -> list[Program]:
    """Give all of them, octray first; ``python`` is one that has Mitsuba."""
    return [Octray(), OctrayPython(), PovRay(), PovRay(bsp=True), Tachyon(), Mitsuba(python)]
