"""Runs the same scenes through octray and every peer that is installed; prints a table."""

from __future__ import annotations

import argparse
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import report

import octray


def compare(name: str, folder: Path, rays: int) -> list[report.Row]:
    """The rows of one peer."""
    if name == "raysect":
        import raysect_solids

        return list(raysect_solids.compare(rays))
    if name == "POV-Ray":
        import povray_pictures

        return list(povray_pictures.compare(folder, rays))
    if name == "OpenSCAD":
        import openscad_models

        return list(openscad_models.compare(folder))
    if name == "Manifold":
        import manifold_models

        return list(manifold_models.compare())
    if name in {"Embree (embreex)", "Open3D"}:
        import mesh_parity

        return list(mesh_parity.compare(name, rays))
    return []  # trimesh is the way to Embree


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rays", type=int, default=100_000, help="rays per scene")
    parser.add_argument("--only", help="only the peer whose name contains this")
    parser.add_argument("--keep", type=Path, help="keep scenes and pictures in this folder")
    options = parser.parse_args()

    found = report.versions()
    print(f"octray {octray.__version__}, Python {platform.python_version()}, {platform.machine()}")
    print("; ".join(f"{name} {version}" for name, version in found.items()))
    for missing in report.absent(found):
        print(f"absent, not measured: {missing}")
    print(flush=True)

    rows: list[report.Row] = []
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name in found:
            if options.only and options.only.lower() not in name.lower():
                continue
            print(f"running {name} ...", file=sys.stderr, flush=True)
            try:
                rows += compare(name, folder, options.rays)
            except (RuntimeError, OSError, subprocess.TimeoutExpired) as error:
                print(f"{name} failed: {error}", file=sys.stderr)
                failed = True
    print(report.markdown(rows))
    sys.exit(failed)


if __name__ == "__main__":
    main()
