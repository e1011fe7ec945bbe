"""What a run of the lab found out."""

from __future__ import annotations

import enum
import json
import statistics
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from octray._core import __version__
from octray.lab import figures
from octray.lab.selection import YARDSTICK

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

#: The version of the JSON object; a name that goes or changes its meaning makes a new one.
FORMAT = 1


class Status(str, enum.Enum):
    """What became of a method."""

    DONE = "done"
    OUT_OF_MEMORY = "out of memory"
    OUT_OF_TIME = "out of time"
    FAILED = "failed"
    CUT_OFF = "cut off by the budget"
    INTERRUPTED = "interrupted"


@dataclass
class Combination:
    """One method, with all that was measured of it; what is absent was not measured."""

    #: The method's full name.
    method: str
    #: What became of it; of several things, the last.
    status: Status = Status.DONE
    #: Why it is not done, in words.
    message: str | None = None
    #: Seconds of each build.
    build_s: list[float] = field(default_factory=list)
    #: Seconds of each rendering.
    render_s: list[float] = field(default_factory=list)
    #: Memory that the process held before the build and after it, in bytes.
    loaded_bytes: int | None = None
    resident_bytes: int | None = None
    #: The picture of each repetition, by its hash.
    pictures: list[str] = field(default_factory=list)
    #: Whether all these are the reference picture, and how many pixels of the worst are not.
    same: bool | None = None
    different_pixels: int | None = None
    #: What ``Image.report`` says of the last rendering, and ``Scene.stats`` of what was built.
    report: dict[str, Any] | None = None
    stats: dict[str, Any] | None = None
    #: Median time as a multiple of that of the yardstick in the same group.
    relative: float | None = None

    @property
    def build(self) -> float | None:
        """Give the median of the times of building, in seconds."""
        return statistics.median(self.build_s) if self.build_s else None

    @property
    def render(self) -> float | None:
        """Give the median of the times of rendering, in seconds."""
        return statistics.median(self.render_s) if self.render_s else None

    @property
    def spread(self) -> float | None:
        """Give half the distance from the fastest to the slowest rendering, in seconds."""
        return (max(self.render_s) - min(self.render_s)) / 2 if self.render_s else None

    def to_dict(self) -> dict[str, Any]:
        """Give the entry of the JSON object; docs/lab-json.md says what everything is."""
        found = figures.of(self.report, self.stats)
        return {
            "method": self.method,
            "status": self.status.value,
            "message": self.message,
            "build": {"times_s": self.build_s, "median_s": self.build},
            "memory": {
                "structure_bytes": found.memory,
                "building_bytes": found.building,
                "parts": found.parts,
                "loaded_bytes": self.loaded_bytes,
                "resident_bytes": self.resident_bytes,
            },
            "nodes": found.nodes,
            "stopped": found.stopped,
            "depth_histogram": found.depths,
            "objects_per_leaf": found.per_leaf,
            "lvsi": found.lvsi,
            "marks": found.marks,
            "triangle_cube_steps": found.triangle_cube_steps,
            "membership": found.membership,
            "rays": found.rays,
            "per_ray": found.per_ray,
            "per_ray_by_kind": found.per_ray_by_kind,
            "render": {
                "times_s": self.render_s,
                "median_s": self.render,
                "spread_s": self.spread,
                "relative": self.relative,
            },
            "picture": {
                "sha256": self.pictures[0] if self.pictures else None,
                "same": self.same,
                "different_pixels": self.different_pixels,
            },
        }


@dataclass
class Group:
    """Methods whose processes lived at the same time, so that their times can be compared."""

    #: The methods' names.
    methods: list[str] = field(default_factory=list)
    #: Seconds of the yardstick's renderings among these.
    yardstick_s: list[float] = field(default_factory=list)


@dataclass
class Drawings:
    """What there is to draw; arrays are kept only where pictures were asked for."""

    #: The reference picture, a PNG.
    picture: bytes | None = None
    #: Cost of every pixel by method, (height, width, 3): steps, surfaces and triangles tested.
    cost: dict[str, npt.NDArray[np.float32]] = field(default_factory=dict)
    #: Points of the scene that the picture shows, (n, 3), and the method whose cells go with it.
    seen: npt.NDArray[np.float64] | None = None
    framed: str | None = None
    #: Cells by method: ``root`` (2, 3), ``bounds`` (n, 2, 3), ``depth`` (n), ``occupied`` (n).
    cells: dict[str, dict[str, npt.NDArray[Any]]] = field(default_factory=dict)


@dataclass
class Report:
    """All methods of a run."""

    #: The scene's file.
    path: str
    #: What ``Scene.describe`` says of it, with the camera that was used.
    scene: dict[str, Any]
    #: Options of the run as they were used.
    options: dict[str, Any]
    #: What it ran on.
    machine: dict[str, Any]
    #: All methods that were asked for, in order.
    combinations: list[Combination]
    #: Which methods ran beside each other.
    groups: list[Group] = field(default_factory=list)
    #: The method whose picture the others are compared with; none if there is no picture.
    reference: str | None = None
    #: What a reader has to know besides.
    notes: list[str] = field(default_factory=list)
    #: Whether the user stopped it.
    interrupted: bool = False
    #: For charts and pictures.
    drawings: Drawings = field(default_factory=Drawings)

    @property
    def missing(self) -> list[Combination]:
        """Give the methods that are not done."""
        return [c for c in self.combinations if c.status is not Status.DONE]

    @property
    def cut_off(self) -> list[Combination]:
        """Give the methods that the budget cut off."""
        return [c for c in self.combinations if c.status is Status.CUT_OFF]

    @property
    def different(self) -> list[Combination]:
        """Give the methods whose picture is not the reference's."""
        return [c for c in self.combinations if c.same is False]

    def in_vain(self, combination: Combination) -> int | None:
        """Count marks of solids beyond those of ``analytic`` by the same encoding and traversal.

        ``None`` where either has none. Cells are not the same for all tests, so it may be negative.
        """
        found = figures.of(combination.report, combination.stats).membership
        least = f"{combination.method.rpartition(':')[0]}:analytic"
        for other in self.combinations:
            known = figures.of(other.report, other.stats).membership
            if other.method == least and found and known:
                return int(found["marks"] - known["marks"])
        return None

    def _entry(self, combination: Combination) -> dict[str, Any]:
        entry = combination.to_dict()
        if entry["membership"] is not None:
            entry["membership"]["in_vain"] = self.in_vain(combination)
        return entry

    def to_dict(self) -> dict[str, Any]:
        """Give the JSON object that docs/lab-json.md describes."""
        return {
            "octray": __version__,
            "format": FORMAT,
            "machine": self.machine,
            "scene": {"path": self.path, **figures.of_scene(self.scene)},
            "options": self.options,
            "reference": self.reference,
            "yardstick": YARDSTICK,
            "groups": [
                {"methods": group.methods, "yardstick_s": group.yardstick_s}
                for group in self.groups
            ],
            "combinations": [self._entry(combination) for combination in self.combinations],
            "cut_off": [c.method for c in self.cut_off],
            "missing": [c.method for c in self.missing],
            "different": [c.method for c in self.different],
            "notes": self.notes,
            "interrupted": self.interrupted,
        }

    def to_json(self) -> str:
        """Give the same as text."""
        return json.dumps(self.to_dict(), indent=2, allow_nan=False)
