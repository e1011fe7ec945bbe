"""Runs the benchmark."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from octray._core import check_request, default_threads
from octray.bench import catalogue, programs
from octray.bench.process import supported
from octray.bench.result import Report
from octray.bench.session import Plan, Session
from octray.lab import machine

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from octray.bench.programs import Program


def run(
    scenes: Sequence[str] = (),
    *,
    everything: bool = False,
    only: Sequence[str] = (),
    threads: Sequence[int] = (),
    repeat: int = 3,
    timeout: float | None = 300.0,
    budget: float | None = None,
    folder: str | os.PathLike[str] | None = None,
    mitsuba: str | None = None,
    progress: Callable[[float], object] | None = None,
) -> Report:
    """Render scenes with octray and every other program that is installed, in turns.

    ``scenes`` are names (see ``octray.bench.catalogue``); without any, a set that takes about a
    minute, with ``everything`` the full set. ``only`` names programs beside octray, by default
    all. ``threads`` are numbers of threads, by default one for each processor. ``timeout`` and
    ``budget`` limit one command and the whole run, in seconds. The files and pictures are left in
    ``folder``, if it is given. ``mitsuba`` is a Python that has Mitsuba. ``progress`` is called
    with numbers from 0 to 1. An interruption from the keyboard ends the run; the report says so
    and has what is done.

    Raises ``ValueError`` for what cannot be asked, before anything runs, and ``OSError`` if the
    folder cannot be made.
    """
    names = list(scenes) or list(catalogue.ALL if everything else catalogue.USUAL)
    names = list(dict.fromkeys(names))
    for name in names:
        catalogue.check(name)
    counts = list(dict.fromkeys(threads)) or [default_threads()]
    for count in counts:
        check_request(threads=count)
    for what, value in (("repeat", repeat), ("timeout", timeout), ("budget", budget)):
        if value is not None and not value > 0:
            raise ValueError(f"{what} must be greater than 0, not {value}")
    if not supported():
        raise ValueError("this system does not tell what a process costs: there is no benchmark")
    chosen = _choose(only, mitsuba)
    report = Report(
        machine.describe() | {"load": _load()},
        options={
            "scenes": names,
            "threads": counts,
            "repeat": repeat,
            "timeout_s": timeout,
            "budget_s": budget,
        },
    )
    here = [program for program in chosen if _is_here(program, report)]
    with _folder(folder) as place:
        plan = Plan(names, counts, repeat, timeout, budget, place)
        if progress is not None:
            plan.progress = progress
        Session(plan, here, report).run()
    return report


def _choose(only: Sequence[str], mitsuba: str | None) -> list[Program]:
    every: list[Program] = programs.programs(mitsuba)
    if not only:
        return every
    known = {program.name.lower(): program for program in every}
    wanted = {name.lower() for name in only} | {programs.YARDSTICK}
    for name in sorted(wanted - set(known)):
        names = ", ".join(program.name for program in every)
        raise ValueError(f"there is no program {name!r}; there are {names}")
    return [program for name, program in known.items() if name in wanted]


def _is_here(program: Program, report: Report) -> bool:
    """Look for a program, and write down what was found."""
    try:
        report.programs[program.name] = program.find()
    except LookupError as error:
        report.absent[program.name] = str(error)
        return False
    return True


def _load() -> float | None:
    """Give how many processes wanted to run in the last minute, where the system tells."""
    try:
        return os.getloadavg()[0]
    except (AttributeError, OSError):
        return None


@contextlib.contextmanager
def _folder(given: str | os.PathLike[str] | None) -> Iterator[Path]:
    if given is None:
        with tempfile.TemporaryDirectory(prefix="octray-bench-") as made:
            yield Path(made)
    else:
        # Programs are started in it: what names it must not depend on where that is.
        place = Path(given).resolve()
        place.mkdir(parents=True, exist_ok=True)
        yield place


def describe_scenes() -> list[tuple[str, str]]:
    """Give what can be asked for: names and what they are."""
    rows: list[tuple[str, Any]] = [("sphere", catalogue.sphere().title)]
    rows += [(name, f"{2 * n * (n - 1):,} triangles") for name, n in catalogue.MESHES.items()]
    for family, (_, largest, what) in catalogue.FAMILIES.items():
        rows.append((f"{family}N", f"{what}, N up to {largest}"))
    return rows
