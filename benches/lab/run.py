"""The lab: every method on every scene, growth curves, and a page of conclusions from them.

``python benches/lab/run.py`` makes everything in ``docs/lab`` anew; ``--mode quick`` takes a
minute and writes to ``out/lab``; ``--page`` makes the page and the figures again from the results
that are there.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import octray
import results
from comparison import MissingError
from measure import measure
from octray.lab import machine
from plan import MODES, Job, Mode, jobs
from results import Results, Scene
from scenes import scan
from scenes.families import FAMILIES, generate

ROOT = Path(__file__).resolve().parents[2]
PICTURE = (240, 180)


def main(arguments: list[str] | None = None) -> int:
    """Run the lab; 0 if the page could be made of what was measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mode", choices=MODES, default="full")
    parser.add_argument("--output", type=Path, metavar="DIR", help="where everything is written")
    parser.add_argument("--budget", type=float, metavar="S", help="seconds for everything")
    parser.add_argument(
        "--page", action="store_true", help="measure nothing: make the page from results.json"
    )
    options = parser.parse_args(arguments)
    usual = ROOT / "docs" / "lab" if options.mode == "full" else ROOT / "out" / "lab"
    output: Path = options.output or usual
    output.mkdir(parents=True, exist_ok=True)
    if not options.page:
        mode = MODES[options.mode]
        found = run(mode, output, options.budget or mode.budget)
        found.save(output / "results.json")
    # What is shown is what the file says, so that both ways give the same page.
    found = results.load(output / "results.json")
    import figures
    import page

    figures.draw(found, output)
    try:
        text = page.fill(found)
    except MissingError as error:
        print(f"no page: {error}", file=sys.stderr)
        return 1
    (output / "README.md").write_text(text, encoding="utf-8")
    print(f"wrote {output / 'README.md'}", file=sys.stderr)
    return 0


def run(mode: Mode, output: Path, budget: float) -> Results:
    """Measure everything that the budget allows."""
    start = time.monotonic()
    found = Results(
        mode=mode.name,
        octray=octray.__version__,
        machine=_machine(),
        size=list(mode.size),
        small=list(mode.small),
        repeat=mode.repeat,
        budget_s=budget,
    )
    with tempfile.TemporaryDirectory(prefix="octray-lab-scenes-") as folder:
        scenes = Scenes(Path(folder))
        for name in mode.compared:
            found.scenes.append(scenes.describe(name, mode.middle, output))
        for job in jobs(mode):
            left = budget - (time.monotonic() - start)
            path, shapes = scenes.get(job.scene, job.shapes)
            if path is None:
                continue
            if left < 1:
                found.skipped.append(_name(job))
                continue
            print(f"{time.monotonic() - start:6.0f} s  {_name(job)}", file=sys.stderr, flush=True)
            found.add(measure(job, path, shapes, mode, left))
    found.seconds = time.monotonic() - start
    return found


class Scenes:
    """Scene files, made where they are first needed; one large one is kept at a time."""

    def __init__(self, folder: Path) -> None:
        """Keep the files in a folder."""
        self.folder = folder
        self._last: tuple[str, int, Path, int] | None = None

    def get(self, name: str, shapes: int) -> tuple[Path | None, int]:
        """The file of a scene with about so many shapes, and how many it has."""
        if name == "scan":
            found = scan.find()
            return (None, 0) if isinstance(found, str) else (found.path, found.triangles)
        if self._last is not None:
            kept_name, kept_shapes, path, size = self._last
            if (kept_name, kept_shapes) == (name, shapes):
                return path, size
            path.unlink()
        made = generate(name, shapes, self.folder)
        self._last = (name, shapes, made.path, made.shapes)
        return made.path, made.shapes

    def describe(self, name: str, shapes: int, output: Path) -> Scene:
        """Say what a scene is, and take its picture."""
        path, size = self.get(name, shapes)
        if name == "scan":
            found = scan.find()
            if isinstance(found, str):
                return Scene(name, "scan", "a scanned mesh", None, found)
            title, what = f"scan: {found.entry}", f"a scanned mesh, {found.source}"
        else:
            title, what = FAMILIES[name].TITLE, FAMILIES[name].WHAT
        assert path is not None  # noqa: S101 - only a scan can be absent
        octray.load(path).render(size=PICTURE).save(output / f"{name}.png")
        return Scene(name, title, what, size)


def _name(job: Job) -> str:
    words = [job.experiment, job.scene, f"{job.shapes:,}"]
    return " ".join([*words, job.label] if job.label else words)


def _machine() -> dict[str, object]:
    """What times depend on; nothing that changes from run to run."""
    known = machine.describe()
    return {
        name: known[name] for name in ("processor", "memory_bytes", "system") if name in known
    } | {"processors": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 0}


if __name__ == "__main__":
    sys.exit(main())
