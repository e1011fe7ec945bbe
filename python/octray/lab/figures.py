"""The lab's figures, taken from what octray reports of a rendering and of a structure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

#: The kinds of ray, in the order in which they are shown.
KINDS = ("primary", "shadow", "reflected", "refracted")


@dataclass
class Figures:
    """Figures of one method; ``None`` is what was not measured, or what the method has not."""

    #: Bytes of all structures, and by part.
    memory: int | None = None
    parts: dict[str, int] | None = None
    #: Numbers of nodes by kind.
    nodes: dict[str, int] | None = None
    #: Why the builder did not divide further.
    stopped: dict[str, Any] | None = None
    #: Pairs of a depth and how many leaves have it, of a number of objects and how many leaves
    #: hold so many.
    depths: list[list[int]] | None = None
    per_leaf: list[list[int]] | None = None
    #: How often cells were marked, and how each step of the triangle-cube test decided.
    marks: dict[str, int] | None = None
    triangle_cube_steps: dict[str, int] | None = None
    #: Numbers of rays by kind.
    rays: dict[str, int] | None = None
    #: What a ray cost on average, of all and by kind of ray.
    per_ray: dict[str, float] | None = None
    per_ray_by_kind: dict[str, dict[str, float]] | None = None

    @property
    def cells(self) -> int | None:
        """Give the number of all nodes."""
        return None if self.nodes is None else sum(self.nodes.values())

    def each_ray(self, *names: str) -> float | None:
        """Sum these costs of a ray; ``None`` if none of them was counted."""
        counted = self.per_ray or {}
        known = [counted[name] for name in names if name in counted]
        return sum(known) if known else None


def _of_trees(figures: Figures, trees: dict[str, Any]) -> None:
    """Take numbers of nodes and of bytes from the trees of a rendering's report."""
    cells, wide = trees.get("cells"), trees.get("wide")
    nodes: dict[str, int] = {}
    parts: dict[str, int] = {}
    if cells is not None:
        nodes.update({kind: cells[kind] for kind in ("empty", "occupied", "divided")})
        parts["cells"] = cells["bytes"]
        figures.stopped = {
            why.removeprefix("stopped_by_"): value
            for why, value in cells.items()
            if why.startswith("stopped_by_")
        }
    if wide is not None:
        nodes["wide"] = wide["nodes"]
        parts["triangles"] = wide["bytes"]
    if nodes:
        figures.nodes = nodes
    figures.parts = parts
    figures.memory = sum(parts.values())


def of(report: dict[str, Any] | None, stats: dict[str, Any] | None) -> Figures:
    """Collect the figures of one method; nothing is invented where something is absent."""
    del stats
    figures = Figures()
    if report is not None:
        _of_trees(figures, report["trees"])
        figures.rays = dict(report["rays"])
        figures.per_ray = dict(report["tests_per_ray"])
        by_kind = report.get("tests_by_kind")
        if by_kind is not None:
            figures.per_ray_by_kind = {kind: dict(by_kind[kind]) for kind in KINDS}
    return figures


def primitives_of(scene: dict[str, Any]) -> int:
    """Count the primitives of a described scene; a mesh counts by its triangles."""
    solids = sum(
        count
        for entry in scene["objects"]
        for kind, count in entry["primitives"].items()
        if kind != "mesh"
    )
    return int(solids + scene["triangles"])


def of_scene(scene: dict[str, Any]) -> dict[str, Any]:
    """Give what figures of a method depend on."""
    return {
        "objects": len(scene["objects"]),
        "primitives": primitives_of(scene) - scene["triangles"],
        "triangles": scene["triangles"],
        "lights": len(scene["lights"]),
        "bounds": scene["bounds"],
        "units": scene["units"],
    }
