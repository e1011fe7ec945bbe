"""What is known of a program: how it is found, called and read."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from octray.bench.process import RunError

if TYPE_CHECKING:
    from pathlib import Path

    from octray.bench.process import Cost
    from octray.bench.scene import Scene


@dataclass(frozen=True)
class Figures:
    """What a program says of itself: seconds of tracing, and of other parts by name."""

    trace_s: float
    parts: dict[str, float] = field(default_factory=dict)
    #: How many rays it traced, of all kinds, where it tells.
    rays: int | None = None
    #: Seconds that belong to the measurement and not to the command.
    extra_s: float = 0.0


class Program(Protocol):
    """One contender."""

    name: str

    def find(self) -> str:
        """Give its version; raise ``LookupError`` with what is missing."""
        ...

    def objection(self, scene: Scene) -> str | None:
        """Say why it does not render such a scene; ``None`` if it does."""
        ...

    def write(self, scene: Scene, folder: Path) -> None:
        """Write the scene's files for it, unless they are there."""
        ...

    def command(self, scene: Scene, threads: int) -> list[str]:
        """Give the command that renders the files when it is started beside them."""
        ...

    def environment(self, folder: Path) -> dict[str, str]:
        """Give what its environment has besides ours; the folder is ours to write to."""
        ...

    def read(self, cost: Cost) -> Figures:
        """Read what it said."""
        ...


def number(text: str, pattern: str) -> float:
    """Find the last number that the pattern's group matches."""
    found = re.findall(pattern, text)
    if not found:
        raise RunError("failed", f"it does not tell its times: nothing like {pattern}")
    return float(found[-1])
