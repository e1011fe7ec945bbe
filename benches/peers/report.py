"""Rows of the comparison, the peers' versions, and how both are printed."""

from __future__ import annotations

import importlib.metadata
import shutil
import subprocess
from dataclasses import dataclass

#: What a peer is called, how it is found, and the package that usually brings it.
PROGRAMS = {"POV-Ray": ("povray", "apt: povray"), "OpenSCAD": ("openscad", "apt: openscad")}
MODULES = {
    "raysect": "raysect",
    "Embree (embreex)": "embreex",
    "trimesh": "trimesh",
    "Open3D": "open3d",
    "Manifold": "manifold3d",
}


@dataclass(frozen=True)
class Row:
    """One scene, one thing counted, a peer beside octray."""

    scene: str
    counted: str
    peer: str
    theirs: str
    ours: str


def share(wrong: int, total: int) -> str:
    """``wrong`` of ``total``, readable."""
    if wrong == 0:
        return f"0 of {total:,}"
    percent = 100.0 * wrong / total
    digits = f"{percent:.1f}" if percent >= 0.1 else f"{percent:.1g}"
    return f"**{wrong:,}** of {total:,} ({digits}%)"


def versions() -> dict[str, str]:
    """The peers that are installed here, with their versions; others are absent."""
    found = {}
    for name, (program, _) in PROGRAMS.items():
        path = shutil.which(program)
        if path:
            done = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
            words = [w for w in (done.stdout + done.stderr).split() if w[0].isdigit()]
            found[name] = next((w for w in words if "." in w), "unknown")
    for name, package in MODULES.items():
        try:
            found[name] = importlib.metadata.version(package)
            __import__(package)
        except importlib.metadata.PackageNotFoundError:
            continue
        except ImportError:
            found.pop(name)
    return found


def absent(found: dict[str, str]) -> list[str]:
    """What is not installed here, and the package that usually brings it."""
    packages = {name: package for name, (_, package) in PROGRAMS.items()}
    packages |= {name: f"pip: {package}" for name, package in MODULES.items()}
    return [f"{name} ({package})" for name, package in packages.items() if name not in found]


def markdown(rows: list[Row]) -> str:
    """The rows as a table."""
    lines = ["| scene | counted | peer | its result | octray's |", "|---|---|---|--:|--:|"]
    previous = ("", "")
    for row in rows:
        scene = "" if row.scene == previous[0] else row.scene
        counted = "" if (row.scene, row.counted) == previous else row.counted
        lines.append(f"| {scene} | {counted} | {row.peer} | {row.theirs} | {row.ours} |")
        previous = (row.scene, row.counted)
    return "\n".join(lines)
