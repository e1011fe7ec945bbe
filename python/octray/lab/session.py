"""Runs the methods: workers in groups that fit in memory, repetitions taken in turns."""

from __future__ import annotations

import statistics
import time
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from octray.lab.machine import available_bytes
from octray.lab.process import WorkerError, WorkerProcess
from octray.lab.projection import view
from octray.lab.result import Combination, Group, Report, Status
from octray.lab.selection import YARDSTICK

if TYPE_CHECKING:
    from pathlib import Path

    from octray.lab.plan import Plan

#: The share of the available memory that all workers together may take.
_SHARE = 0.8
#: How many workers read their scene at the same time; reading is not timed.
_STARTING = 4
#: How many workers live at the same time at most.
_ALIVE = 64
#: A build that took less is repeated with every rendering: short times are the noisy ones.
_SHORT_BUILD_S = 1.0


class OutOfBudgetError(Exception):
    """The time for the whole run is over."""


class Member:
    """A method with its living worker."""

    def __init__(self, combination: Combination, steps: int, *, extra: bool) -> None:
        """Start the worker; ``steps`` is how often it will be asked for something."""
        self.combination = combination
        self.steps = steps
        #: Whether this is the yardstick once more, for the times of one group.
        self.extra = extra
        self.worker = WorkerProcess()
        self.alive = True

    def fail(self, error: WorkerError) -> None:
        """Keep what became of the method, and end its process."""
        self.combination.status = Status(error.status)
        self.combination.message = str(error)
        self.close()

    def close(self) -> None:
        """End the process."""
        self.alive = False
        self.worker.close()


class Session:
    """One run. It may be interrupted anywhere; the report then has what is done."""

    def __init__(self, plan: Plan, report: Report, folder: Path) -> None:
        """Prepare to run ``plan`` into ``report``; ``folder`` takes pictures meanwhile."""
        self.plan = plan
        self.report = report
        self.folder = folder
        self.members: list[Member] = []
        self.deadline = None if plan.budget is None else time.monotonic() + plan.budget
        self.room = available_bytes()
        self.done = 0
        #: Reading, building, the repetitions, the pictures.
        self.steps_each = 2 + plan.repeat + (1 if plan.drawings else 0)
        self.steps = self.steps_each * len(report.combinations)

    def run(self) -> None:
        """Run everything, or until the budget is spent."""
        waiting = deque(self.report.combinations)
        try:
            while waiting:
                self._run_group(waiting)
        except OutOfBudgetError:
            self._mark_unfinished(Status.CUT_OFF)
        except KeyboardInterrupt:
            self.report.interrupted = True
            self._mark_unfinished(Status.INTERRUPTED)
        finally:
            self._close_group()

    def _run_group(self, waiting: deque[Combination]) -> None:
        """Take from ``waiting`` as many as fit in memory together, and run these."""
        group = Group()
        self.report.groups.append(group)
        if len(self.report.groups) > 1:
            names = [combination.method for combination in self.report.combinations]
            if YARDSTICK in names:
                self._admit([Member(Combination(YARDSTICK), self.steps_each, extra=True)])
        self._assemble(waiting)
        for turn in range(self.plan.repeat):
            for member in self.members:
                if member.alive:
                    self.repeat(member, build_again=turn > 0)
            if self.plan.drawings and turn == 0:
                # Early, so that a run that is cut off has something to show of every method.
                for member in self.members:
                    if member.alive and not member.extra:
                        self._collect(member)
        self._close_group()

    def _close_group(self) -> None:
        """End all workers; take the group's times together."""
        if not self.members:
            return
        for member in self.members:
            member.close()
        group = self.report.groups[-1]
        group.methods = [m.combination.method for m in self.members if not m.extra]
        for member in self.members:
            if member.combination.method == YARDSTICK:
                group.yardstick_s = member.combination.render_s
        if group.yardstick_s:
            unit = statistics.median(group.yardstick_s)
            for member in self.members:
                median = member.combination.render
                if median is not None and unit > 0:
                    member.combination.relative = median / unit
        self.members = []

    # Starting.

    def _assemble(self, waiting: deque[Combination]) -> None:
        """Start, load and build members while there is room; at least one."""
        while waiting:
            batch: list[Member] = []
            while waiting and len(batch) < _STARTING and self._has_room(len(batch)):
                batch.append(Member(waiting.popleft(), self.steps_each, extra=False))
            if not batch:
                return
            self._admit(batch)

    def _has_room(self, starting: int) -> bool:
        """Whether one more worker fits beside the living ones and those being started."""
        own = [m for m in self.members if not m.extra]
        if not own and not starting:
            return True
        living = [m.combination.resident_bytes or 0 for m in self.members if m.alive]
        if len(living) + starting >= _ALIVE:
            return False
        # Nobody knows what one more will need: as much as the largest so far.
        known = [c.resident_bytes for c in self.report.combinations if c.resident_bytes is not None]
        if self.room is None:
            return True
        if not known:
            return starting == 0
        return sum(living) + (starting + 1) * max(known) < self.room * _SHARE

    def _admit(self, batch: list[Member]) -> None:
        """Read the scene in all these processes at once; then build one after the other."""
        self.members += batch
        plan = self.plan
        for member in batch:
            member.worker.send(
                "load",
                path=plan.path,
                accel=member.combination.method,
                threads=plan.threads,
                facets=plan.facets,
                viewall=plan.viewall,
                memory=plan.memory,
            )
        for member in batch:
            answer = self.receive(member, limited=False)
            if answer is not None:
                member.combination.loaded_bytes = answer["resident_bytes"]
                member.combination.resident_bytes = answer["resident_bytes"]
                if plan.memory is not None and not answer["limited"]:
                    self._note("this system does not limit the memory of a process: --memory")
        for member in batch:
            if member.alive:
                self._build(member)

    def _note(self, text: str) -> None:
        if text not in self.report.notes:
            self.report.notes.append(text)

    # Steps.

    def _build(self, member: Member) -> bool:
        member.worker.send("build", threads=self.plan.threads, tree=self.plan.tree)
        answer = self.receive(member)
        if answer is None:
            return False
        combination = member.combination
        combination.build_s.append(answer["build_s"])
        combination.stats = answer["stats"]
        if len(combination.build_s) == 1:
            combination.resident_bytes = answer["resident_bytes"]
        return True

    def repeat(self, member: Member, *, build_again: bool) -> None:
        """Render once, after another build if that is quick."""
        combination = member.combination
        if build_again and combination.build_s[0] < _SHORT_BUILD_S:
            self.steps += 1
            member.steps += 1
            if not self._build(member):
                return
        member.worker.send(
            "render",
            options=self.plan.render,
            folder=str(self.folder),
            png=self.plan.drawings,
        )
        answer = self.receive(member)
        if answer is not None:
            combination.render_s.append(answer["render_s"])
            combination.pictures.append(answer["picture"])
            combination.report = answer["report"]

    def _wait(self, member: Member, *, limited: bool = True) -> dict[str, Any]:
        """Wait for a worker's answer as long as the limits allow."""
        left = None if self.deadline is None else self.deadline - time.monotonic()
        if left is not None and left <= 0:
            raise OutOfBudgetError
        timeout, late = (self.plan.timeout if limited else None), Status.OUT_OF_TIME
        if left is not None and (timeout is None or left < timeout):
            timeout, late = left, Status.CUT_OFF
        try:
            return member.worker.receive(timeout, late.value)
        except WorkerError as error:
            if error.status == Status.CUT_OFF.value:
                raise OutOfBudgetError from None
            raise

    def receive(self, member: Member, *, limited: bool = True) -> dict[str, Any] | None:
        """Wait for an answer; ``None`` if there is none, which is then in the report."""
        try:
            answer = self._wait(member, limited=limited)
        except WorkerError as error:
            member.fail(error)
            self._advance(member, member.steps)
            return None
        self._advance(member, 1)
        return answer

    def _advance(self, member: Member, steps: int) -> None:
        member.steps -= steps
        if not member.extra:
            self.done += steps
        self.plan.progress(min(self.done / max(self.steps, 1), 1.0))

    def _collect(self, member: Member) -> None:
        """Ask for the cost of every pixel and for the cells. A method may have neither."""
        name, drawings = member.combination.method, self.report.drawings
        cost, cells = self.folder / "cost.npy", self.folder / "cells.npz"
        try:
            member.worker.send("cost", options=self.plan.render, file=str(cost))
            self._wait(member)
            drawings.cost[name] = np.load(cost)
            member.worker.send("cells", file=str(cells))
            if self._wait(member)["cells"]:
                with np.load(cells) as arrays:
                    drawings.cells[name] = dict(arrays)
                self._look(member)
        except WorkerError as error:
            self._note(f"{name} has no picture of its costs: {error}")
        self._advance(member, 1)

    def _look(self, member: Member) -> None:
        """Ask once, of the first octree, which points of the scene the picture shows."""
        name, camera, drawings = (
            member.combination.method,
            self.report.scene["camera"],
            self.report.drawings,
        )
        if drawings.framed is not None or name.startswith("grid") or camera is None:
            return
        options = self.report.options
        projection, shape = view(camera, options["size"], options["crop"])
        rays, seen = self.folder / "rays.npy", self.folder / "seen.npy"
        np.save(rays, projection.rays(shape))
        member.worker.send("seen", rays=str(rays), file=str(seen))
        self._wait(member)
        drawings.seen, drawings.framed = np.load(seen), name

    def _mark_unfinished(self, status: Status) -> None:
        """Say of every method that is not done why."""
        wanted = self.plan.repeat
        for combination in self.report.combinations:
            done = len(combination.render_s)
            if combination.status is not Status.DONE or done == wanted:
                continue
            combination.status = status
            if done and self.plan.drawings and combination.method not in self.report.drawings.cost:
                self._note(f"no time was left for a picture of the costs of {combination.method}")
            if done:
                combination.message = f"{done} of {wanted} repetitions were done"
            else:
                combination.message = "not rendered" if combination.build_s else "not built"
