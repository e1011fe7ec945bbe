"""Writes the scenes of ``octray bench`` for octray and for every peer, to run them by hand."""

from __future__ import annotations

import argparse
from pathlib import Path

from octray.bench import catalogue
from octray.bench.programs import programs


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the files go")
    parser.add_argument("scenes", nargs="*", help="names (octray bench --list); by default all")
    options = parser.parse_args()
    names = options.scenes or catalogue.ALL
    try:
        for name in names:
            catalogue.check(name)
    except ValueError as error:
        parser.error(str(error))
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        scene = catalogue.make(name)
        for program in programs():
            if not scene.without.get(program.name) and not program.objection(scene):
                program.write(scene, folder)
        print(f"{name}: {scene.title}")


if __name__ == "__main__":
    main()
