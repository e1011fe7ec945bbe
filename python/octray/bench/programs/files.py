"""Scene files that several programs read: each is written once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from octray.bench.writers import mitsuba, pov

if TYPE_CHECKING:
    from pathlib import Path

    from octray.bench.scene import Scene

#: Of all files that hold a scene; the names of meshes begin like that of their scene.
SUFFIXES = (".pov", ".dat", ".xml", ".py")


def write_pov(scene: Scene, folder: Path) -> None:
    """Write the scene in POV-Ray's language, unless it is there."""
    path = folder / f"{scene.name}.pov"
    if not path.exists():
        with path.open("w", encoding="ascii") as file:
            pov.write(scene, file)


def write_mitsuba(scene: Scene, folder: Path) -> None:
    """Write the scene for Mitsuba, and its meshes, unless it is there."""
    path = folder / f"{scene.name}.xml"
    if not path.exists():
        with path.open("w", encoding="ascii") as file:
            mitsuba.write(scene, file, folder)
