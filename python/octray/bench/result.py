"""What a run of the benchmark found out."""

from __future__ import annotations

import enum
import json
import statistics
from dataclasses import dataclass, field
from typing import Any

from octray._core import __version__
from octray.bench.programs import YARDSTICK

#: The version of the JSON object; a name that goes or changes its meaning makes a new one.
FORMAT = 1


class Status(str, enum.Enum):
    """What became of a program on a scene."""

    DONE = "done"
    OUT_OF_TIME = "out of time"
    FAILED = "failed"
    CUT_OFF = "cut off by the budget"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class Run:
    """One rendering by one program; seconds and bytes."""

    #: The round: runs of one round stood beside each other and are compared.
    round: int
    #: Seconds of tracing, as the program says.
    trace_s: float
    #: From the start of the command to its end, and processor time of it.
    whole_s: float
    cpu_s: float
    peak_bytes: int
    #: Seconds of its other parts by name, as it says.
    parts: dict[str, float]
    #: Rays of all kinds, as it says.
    rays: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """Give the entry of the JSON object."""
        return dict(vars(self))


@dataclass
class Series:
    """All runs of one program on one scene with so many threads."""

    scene: str
    threads: int
    program: str
    status: Status = Status.DONE
    #: Why it is not done, in words.
    message: str | None = None
    runs: list[Run] = field(default_factory=list)

    def median(self, what: str) -> float | None:
        """Give the median of ``trace_s``, ``whole_s``, ``cpu_s`` or ``peak_bytes``."""
        values = [getattr(run, what) for run in self.runs]
        return statistics.median(values) if values else None

    def parts(self) -> dict[str, float]:
        """Give the medians of the parts."""
        names = self.runs[0].parts if self.runs else {}
        return {name: statistics.median(run.parts[name] for run in self.runs) for name in names}


@dataclass
class SceneFacts:
    """What is rendered."""

    title: str
    counts: dict[str, int]
    size: tuple[int, int]
    #: The name of the same view of nothing; its own name if it is that.
    empty: str
    #: Programs that do not render it, and why.
    unfit: dict[str, str] = field(default_factory=dict)


@dataclass
class Report:
    """All series of a run."""

    machine: dict[str, Any]
    options: dict[str, Any]
    #: Versions of the programs that are here, and why others are not.
    programs: dict[str, str] = field(default_factory=dict)
    absent: dict[str, str] = field(default_factory=dict)
    scenes: dict[str, SceneFacts] = field(default_factory=dict)
    series: list[Series] = field(default_factory=list)
    #: Whether the user ended the run.
    interrupted: bool = False

    def find(self, scene: str, threads: int, program: str) -> Series | None:
        """Look a series up."""
        for one in self.series:
            if (one.scene, one.threads, one.program) == (scene, threads, program):
                return one
        return None

    def ratio(self, series: Series, what: str) -> float | None:
        """Give how many times as long (or large) it is as octray: the median of the rounds."""
        ours = self.find(series.scene, series.threads, YARDSTICK)
        if ours is None:
            return None
        same = {run.round: getattr(run, what) for run in ours.runs}
        ratios = [
            getattr(run, what) / same[run.round] for run in series.runs if same.get(run.round)
        ]
        return statistics.median(ratios) if ratios else None

    def net(self, series: Series, what: str) -> float | None:
        """Give the median without what an empty picture of this size takes the program."""
        value = series.median(what)
        facts = self.scenes[series.scene]
        empty = self.find(facts.empty, series.threads, series.program)
        base = None if empty is None else empty.median(what)
        if value is None or base is None or facts.empty == series.scene:
            return None
        return value - base

    def ray_s(self, series: Series) -> float | None:
        """Give the seconds of tracing for each ray, if the program counts its rays."""
        told = [run.trace_s / run.rays for run in series.runs if run.rays]
        return statistics.median(told) if told else None

    def bytes_per_shape(self, series: Series) -> float | None:
        """Give the net peak memory for each shape of the scene."""
        net, shapes = self.net(series, "peak_bytes"), sum(self.scenes[series.scene].counts.values())
        return net / shapes if net is not None and shapes > 0 else None

    def speedup(self, series: Series) -> float | None:
        """Give how many times as fast it traces as on one thread: medians of both."""
        alone = self.find(series.scene, 1, series.program)
        one, many = (None if s is None else s.median("trace_s") for s in (alone, series))
        return one / many if one and many and series.threads > 1 else None

    @property
    def missing(self) -> list[Series]:
        """What was to be measured and was not, in whole or in part."""
        return [series for series in self.series if series.status is not Status.DONE]

    @property
    def not_begun(self) -> list[str]:
        """Scenes that the budget or the user left no time for."""
        return [name for name in self.options["scenes"] if name not in self.scenes]

    def to_json(self) -> str:
        """Give the JSON object; docs/performance.md says what everything is."""
        return json.dumps(
            {
                "octray": __version__,
                "format": FORMAT,
                "machine": self.machine,
                "options": self.options,
                "programs": self.programs,
                "absent": self.absent,
                "scenes": {name: vars(facts) for name, facts in self.scenes.items()},
                "series": [self._entry(series) for series in self.series],
                "not_begun": self.not_begun,
                "interrupted": self.interrupted,
            },
            indent=2,
        )

    def _entry(self, series: Series) -> dict[str, Any]:
        measured = ("trace_s", "whole_s", "cpu_s", "peak_bytes")
        return {
            "scene": series.scene,
            "threads": series.threads,
            "program": series.program,
            "status": series.status.value,
            "message": series.message,
            "runs": [run.to_dict() for run in series.runs],
            "median": {what: series.median(what) for what in measured} | {"parts": series.parts()},
            "net": {what: self.net(series, what) for what in measured},
            "ratio": {what: self.ratio(series, what) for what in measured},
            "ray_s": self.ray_s(series),
            "bytes_per_shape": self.bytes_per_shape(series),
            "speedup": self.speedup(series),
        }
