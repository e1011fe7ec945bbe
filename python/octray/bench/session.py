"""Takes the programs in turns over the scenes."""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from octray.bench import catalogue
from octray.bench.process import RunError, measure
from octray.bench.programs.files import SUFFIXES
from octray.bench.result import Report, Run, SceneFacts, Series, Status

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from octray.bench.programs import Program
    from octray.bench.scene import Scene


def _silent(_fraction: float) -> None:
    pass


@dataclass
class Plan:
    """What is run, checked already."""

    scenes: list[str]
    threads: list[int]
    repeat: int
    #: Seconds for one command, and for the whole run.
    timeout: float | None
    budget: float | None
    #: The scenes' files and the pictures stay here.
    folder: Path
    #: Is told how much is done, from 0 to 1.
    progress: Callable[[float], object] = field(default=_silent)


class Session:
    """One run: fills a report."""

    def __init__(self, plan: Plan, programs: list[Program], report: Report) -> None:
        """Take the programs that are here."""
        self.plan = plan
        self.programs = programs
        self.report = report
        self._start = time.monotonic()

    def run(self) -> None:
        """Run everything; Ctrl-C ends it, and what is done stays."""
        try:
            for number, name in enumerate(self.plan.scenes):
                if self._left() <= 0:
                    break
                scene = catalogue.make(name)
                todo = [scene]
                if scene.emptied().name not in self.report.scenes:
                    todo.insert(0, scene.emptied())
                for place, one in enumerate(todo):
                    self._scene(one, number + place / len(todo), 1 / len(todo))
        except KeyboardInterrupt:
            self.report.interrupted = True
            for series in self.report.series:
                if series.status is Status.DONE and len(series.runs) < self.plan.repeat:
                    series.status, series.message = Status.INTERRUPTED, self._count(series)

    def _left(self) -> float:
        """Give what the budget leaves, in seconds."""
        if self.plan.budget is None:
            return float("inf")
        return self.plan.budget - (time.monotonic() - self._start)

    def _count(self, series: Series) -> str:
        return f"{len(series.runs)} of {self.plan.repeat} runs were done"

    def _scene(self, scene: Scene, begin: float, share: float) -> None:
        """Run one scene; ``begin`` and ``share`` are counted in scenes, for the progress."""
        facts = SceneFacts(scene.title, scene.counts, scene.size, scene.emptied().name)
        self.report.scenes[scene.name] = facts
        fit: list[Program] = []
        for program in self.programs:
            objection = scene.without.get(program.name) or program.objection(scene)
            if objection is None:
                fit.append(program)
            else:
                facts.unfit[program.name] = objection
        for threads, program in itertools.product(self.plan.threads, fit):
            self.report.series.append(Series(scene.name, threads, program.name))
        for suffix in SUFFIXES:  # of another version, perhaps
            (self.plan.folder / f"{scene.name}{suffix}").unlink(missing_ok=True)
        for program in fit:
            program.write(scene, self.plan.folder)
        # Whoever runs after a heavy neighbour meets a warm machine: take turns at that, too.
        turns = [
            (threads, program, turn)
            for threads in self.plan.threads
            for turn in range(self.plan.repeat)
            for program in (fit if turn % 2 == 0 else fit[::-1])
        ]
        for place, (threads, program, turn) in enumerate(turns):
            series = self.report.find(scene.name, threads, program.name)
            assert series is not None  # noqa: S101 - made above
            if series.status is Status.DONE:
                try:
                    series.runs.append(self._run(scene, threads, program, turn, series))
                except RunError as error:
                    series.status, series.message = Status(error.status), str(error)
            done = begin + share * (place + 1) / len(turns)
            self.plan.progress(done / len(self.plan.scenes))

    def _run(self, scene: Scene, threads: int, program: Program, turn: int, series: Series) -> Run:
        folder, left = self.plan.folder, self._left()
        if left <= (series.median("whole_s") or 0):
            raise RunError(Status.CUT_OFF.value, self._count(series))
        limits = [limit for limit in (self.plan.timeout, left) if limit not in {None, math.inf}]
        command = program.command(scene, threads)
        try:
            cost = measure(command, folder, min(limits, default=None), program.environment(folder))
        except RunError as error:
            if error.status == Status.OUT_OF_TIME.value and self._left() <= 0:
                raise RunError(Status.CUT_OFF.value, self._count(series)) from None
            raise
        figures = program.read(cost)
        return Run(
            round=turn,
            trace_s=figures.trace_s,
            whole_s=cost.wall_s - figures.extra_s,
            cpu_s=cost.cpu_s,
            peak_bytes=cost.peak_bytes,
            parts=figures.parts,
            rays=figures.rays,
        )
