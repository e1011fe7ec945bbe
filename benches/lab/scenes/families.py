"""The families of scenes by name: how large one is at a level, and its file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TextIO

from scenes import balls, drilled, gears, mount, rings, stadium, tetra, tree

if TYPE_CHECKING:
    from pathlib import Path


class Family(Protocol):
    """What a module of a family offers."""

    TITLE: str
    WHAT: str
    SUFFIX: str

    def count(self, level: int) -> dict[str, int]:
        """Shapes of each kind at a level, 0 and above."""
        ...

    def write(self, level: int, file: TextIO) -> None:
        """Write the scene at a level."""
        ...


FAMILIES: dict[str, Family] = {
    "balls": balls,
    "gears": gears,
    "mount": mount,
    "rings": rings,
    "tetra": tetra,
    "tree": tree,
    "drilled": drilled,
    "stadium": stadium,
}
#: The largest scenes that are made.
LARGEST = 2_000_000


@dataclass(frozen=True)
class Generated:
    """A scene file and how many shapes are in it."""

    family: str
    path: Path
    level: int
    shapes: int


def level_near(name: str, shapes: int) -> int:
    """The level whose count of shapes is nearest to ``shapes``, as a ratio."""
    if not 1 <= shapes <= LARGEST:
        raise ValueError(f"{shapes} shapes: at least 1 and at most {LARGEST:,} can be asked for")

    def distance(level: int) -> float:
        return abs(math.log(size(name, level) / shapes))

    level = 0
    try:
        while distance(level + 1) < distance(level):
            level += 1
    except IndexError:  # a family with so many levels and no more
        pass
    return level


def size(name: str, level: int) -> int:
    """Shapes of all kinds at a level."""
    return sum(FAMILIES[name].count(level).values())


def generate(name: str, shapes: int, folder: Path) -> Generated:
    """Write the scene of a family that has about so many shapes into a folder."""
    level = level_near(name, shapes)
    family = FAMILIES[name]
    path = folder / f"{name}-{level}{family.SUFFIX}"
    with path.open("w", encoding="ascii") as file:
        family.write(level, file)
    return Generated(name, path, level, size(name, level))
