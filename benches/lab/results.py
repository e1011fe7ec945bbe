"""What a run of the lab found out: kept as JSON, asked by experiment, scene, size and method."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FORMAT = 1


@dataclass(frozen=True)
class Row:
    """One method in one run; what was not measured is ``None``."""

    method: str
    #: ``done``, or what became of it in a few words, and why.
    status: str
    message: str | None = None
    #: Medians, in seconds; the second is that of a whole picture.
    build_s: float | None = None
    render_s: float | None = None
    #: Time of the picture as a multiple of that of ``auto`` beside it.
    relative: float | None = None
    #: Bytes of all structures, and of the cells alone without what is in them.
    bytes: int | None = None
    node_bytes: int | None = None
    nodes: dict[str, int] | None = None
    #: The deepest level that has leaves, in the octree over solids.
    depth: int | None = None
    #: The level of its occupied cells, on average.
    leaf_depth: float | None = None
    #: Objects in a leaf that has any, on average.
    objects_per_leaf: float | None = None
    marks: dict[str, int] | None = None
    #: The hash table: its size, rows in use, the longest chain of collisions.
    table: dict[str, float] | None = None
    rays: dict[str, int] | None = None
    per_ray: dict[str, float] | None = None
    per_ray_by_kind: dict[str, dict[str, float]] | None = None
    #: Whether the picture is the reference's, to the bit.
    same: bool | None = None

    @property
    def done(self) -> bool:
        """Whether everything was measured."""
        return self.status == "done"


@dataclass(frozen=True)
class Measured:
    """One scene by some methods, in turns."""

    experiment: str
    scene: str
    #: How many shapes were asked for, and are in it.
    asked: int
    shapes: int
    label: str
    rows: list[Row]
    #: The method whose picture the others are compared with.
    reference: str | None = None

    def row(self, method: str) -> Row | None:
        """What was measured of a method; ``None`` if it is not done."""
        return next((row for row in self.rows if row.method == method and row.done), None)


@dataclass(frozen=True)
class Scene:
    """A scene of the comparison."""

    name: str
    title: str
    what: str
    #: How many shapes the compared scene has; ``None`` if it is absent, and why it is.
    shapes: int | None
    absent: str | None = None


@dataclass
class Results:
    """All of a run."""

    mode: str
    octray: str
    machine: dict[str, Any]
    size: list[int]
    small: list[int]
    repeat: int
    budget_s: float
    seconds: float = 0.0
    scenes: list[Scene] = field(default_factory=list)
    measured: list[Measured] = field(default_factory=list)
    #: What the budget left no time for: experiment, scene, size and label.
    skipped: list[str] = field(default_factory=list)

    def of(self, experiment: str, scene: str | None = None) -> Iterator[Measured]:
        """The runs of an experiment, in order; of one scene, or of all."""
        for measured in self.measured:
            if measured.experiment == experiment and scene in (None, measured.scene):
                yield measured

    def add(self, measured: Measured) -> None:
        """Add a run. Brute force's rows join the growth curve of their scene.

        Its pictures are smaller, so of times only those relative to ``auto`` and those of a ray
        can be compared.
        """
        if measured.experiment == "brute":
            for index, run in enumerate(self.measured):
                same = (run.scene, run.asked) == (measured.scene, measured.asked)
                if run.experiment == "growth" and same:
                    # Without the yardstick its time cannot be compared.
                    brute = [
                        row
                        for row in measured.rows
                        if row.method == "brute" and (row.relative is not None or not row.done)
                    ]
                    self.measured[index] = replace(run, rows=[*brute, *run.rows])
                    return
            raise ValueError("brute force comes after the other methods of its scene")
        self.measured.append(measured)

    def scene(self, name: str) -> Scene:
        """The scene of this name."""
        return next(scene for scene in self.scenes if scene.name == name)

    def save(self, path: Path) -> None:
        """Write the run as JSON, one line for each method."""
        found = asdict(self)
        measured = found.pop("measured")
        head = json.dumps({"format": FORMAT, **_short(found)}, indent=1)
        blocks = []
        for run in measured:
            rows = [json.dumps(_short(row), allow_nan=False) for row in run.pop("rows")]
            begin = json.dumps(_short(run), allow_nan=False)[:-1]
            blocks.append(begin + ', "rows": [\n  ' + ",\n  ".join(rows) + "\n ]}")
        text = head[:-2] + ',\n "measured": [\n' + ",\n".join(blocks) + "\n ]\n}\n"
        path.write_text(text, encoding="utf-8")


def load(path: Path) -> Results:
    """Read what ``Results.save`` wrote."""
    found = json.loads(path.read_text(encoding="utf-8"))
    if found.pop("format") != FORMAT:
        raise ValueError(f"{path} was written by another version of the lab")
    measured = [
        Measured(**{**run, "rows": [Row(**row) for row in run["rows"]]})
        for run in found.pop("measured")
    ]
    scenes = [Scene(**scene) for scene in found.pop("scenes")]
    return Results(**found, scenes=scenes, measured=measured)


def _short(value: Any) -> Any:
    """Leave out what is not there, and the digits that mean nothing."""
    if isinstance(value, dict):
        return {key: _short(v) for key, v in value.items() if v is not None and v != {}}
    if isinstance(value, list):
        return [_short(v) for v in value]
    if isinstance(value, float) and value != 0 and math.isfinite(value):
        return float(f"{value:.5g}")
    return value
