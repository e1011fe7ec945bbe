"""Runs the same scenes through octray and every peer that is installed; prints a table."""

from __future__ import annotations

import argparse
import platform
import sys
import tempfile
from pathlib import Path

import report

import octray


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
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name in found:
            if options.only and options.only.lower() not in name.lower():
                continue
            print(f"running {name} ...", file=sys.stderr, flush=True)
            if name == "raysect":
                import raysect_solids

                rows += raysect_solids.compare(options.rays)
            elif name == "POV-Ray":
                import povray_pictures

                rows += povray_pictures.compare(folder, options.rays)
            elif name == "OpenSCAD":
                import openscad_models

                rows += openscad_models.compare(folder)
            elif name == "Manifold":
                import manifold_models

                rows += manifold_models.compare()
            elif name in {"Embree (embreex)", "Open3D"}:
                import mesh_parity

                rows += mesh_parity.compare(name, options.rays)
    print(report.markdown(rows))


if __name__ == "__main__":
    main()
